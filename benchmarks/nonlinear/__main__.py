"""`python -m benchmarks.nonlinear`: the tables of docs/nonlinear.md, measured."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from axiscal.numerics.threads import one_thread
from benchmarks.nonlinear.remainders import KINDS, remainders
from benchmarks.nonlinear.rounds import case_of, rounds

PAGE = Path(__file__).parents[2] / "docs" / "nonlinear.md"
_MACHINES = 20
_MICRO = 1e6


def left_out() -> Iterator[str]:
    """Yield the table of what first order leaves out."""
    yield "| machine | RMS, um | largest, um | largest share of the bound |"
    yield "|---|---|---|---|"
    for kind in KINDS:
        rms, largest, share = remainders(kind)
        of_bound = "–" if kind.wrong else f"{share:.2f}"
        yield f"| {kind.words} | {rms * _MICRO:.2g} | {largest * _MICRO:.2g} | {of_bound} |"


def round_by_round() -> Iterator[str]:
    """Yield the table of what the rounds bring."""
    yield "| location errors | linear | one | two | rows moved | band | NEES: linear | one | two | rows moved |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for sizes in (("15 um", "30 urad", "30 urad"), ("1 mm", "1 mrad", "30 urad"), ("3 mm", "3 mrad", "9 mrad")):
        case = case_of(*sizes)
        every = np.array([rounds(case, seed) for seed in range(_MACHINES)])
        missed, band = np.sqrt(np.mean(every[:, :, :2] ** 2, axis=0)).T * _MICRO
        nees = every[:, :, 2].mean(axis=0)
        figures = [*(f"{each:.2f}" for each in (*missed, band[-1])), *(f"{each:.3g}" for each in nees)]
        yield f"| {', '.join(sizes)} | {' | '.join(figures)} |"


TABLES: dict[str, Callable[[], Iterator[str]]] = {"left out": left_out, "rounds": round_by_round}


def filled(page: str, wanted: Sequence[str]) -> str:
    """Return the page with the tables between their marks made anew."""
    for name in wanted:
        begin, end = f"<!-- table: {name} -->\n", f"<!-- end: {name} -->"
        before, rest = page.split(begin)
        page = before + begin + "\n".join(TABLES[name]()) + "\n" + end + rest.split(end, 1)[1]
    return page


if __name__ == "__main__":
    with one_thread():
        PAGE.write_text(filled(PAGE.read_text(), sys.argv[1:] or list(TABLES)))
