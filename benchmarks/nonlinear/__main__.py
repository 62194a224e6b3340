"""`python -m benchmarks.nonlinear`: the tables of docs/evidence/nonlinear.md, measured."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from axiscal.numerics import Array
from axiscal_core.threads import one_thread
from benchmarks.nonlinear.remainders import KINDS, remainders
from benchmarks.nonlinear.rounds import case_of, rounds
from benchmarks.nonlinear.stations import bars, compared, tracers
from benchmarks.nonlinear.two_step import compared_evaluations

PAGE = Path(__file__).parents[2] / "docs" / "evidence" / "nonlinear.md"
_MACHINES = 20
_MICRO = 1e6


def left_out() -> Iterator[str]:
    """Yield the table of what first order leaves out."""
    yield "| machine | RMS, um | largest, um |"
    yield "|---|---|---|"
    for kind in KINDS:
        rms, largest = remainders(kind)
        yield f"| {kind.words} | {rms * _MICRO:.2g} | {largest * _MICRO:.2g} |"


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


def station_by_station() -> Iterator[str]:
    """Yield the table of stations that are off."""
    yield (
        "| stations off by | linear once, um | held | sigma points, um | held | Gauss–Newton 3, um | worst | held "
        "| damped, um | worst | held | NEES | cost/closed form |"
    )
    yield "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
    for what, std, zero in (
        ("ball bar ×3", "2 mm", "1 mm"),
        ("tracer ×4", "5 mm", "10 mm"),
        ("tracer ×4", "100 mm", "100 mm"),
        ("tracer ×4", "300 mm", "100 mm"),
    ):
        case = (bars if "bar" in what else tracers)(std, zero)
        rows = [compared(case, seed) for seed in range(_MACHINES)]
        once, found = np.array([row.linear for row in rows]), np.array([row.damped for row in rows])
        points, rounds_ = np.array([row.by_points for row in rows]), np.array([row.by_rounds for row in rows])
        costs = [row.cost for row in rows]
        figures_of = [f"{_median(once)} | {_held(once)}", f"{_median(points)} | {_held(points)}"]
        figures_of += [f"{_median(each)} | {_worst(each)} | {_held(each)}" for each in (rounds_, found)]
        figures_of += [f"{found[:, 3].mean():.2f}", f"{min(costs):.6f} to {max(costs):.6f}"]
        yield f"| {what}, {std} | {' | '.join(figures_of)} |"


def _median(found: Array) -> str:
    return f"{np.median(found[:, 0]) * _MICRO:.3g}"


def _worst(found: Array) -> str:
    return f"{found[:, 0].max() * _MICRO:.3g}"


def _held(found: Array) -> str:
    return f"{found[:, 1].mean():.1%}"


def evaluation_by_evaluation() -> Iterator[str]:
    """Yield the table of both evaluations of the same distances."""
    yield "| points, each from all four stations | readings | all together, um | in two steps, um |"
    yield "|---|---|---|---|"
    case = tracers("5 mm", "10 mm")
    for points in (8, 12, 15, 25, 40):
        rows = np.array([compared_evaluations(case, points, seed) for seed in range(_MACHINES)])
        together, stepwise = np.median(rows, axis=0) * _MICRO
        yield f"| {points} | {4 * points} | {together:.2f} | {stepwise:.2f} |"


TABLES: dict[str, Callable[[], Iterator[str]]] = {
    "left out": left_out,
    "rounds": round_by_round,
    "stations": station_by_station,
    "evaluations": evaluation_by_evaluation,
}


def filled(page: str, wanted: Sequence[str]) -> str:
    """Return the page with the tables between their marks made anew."""
    for name in wanted:
        begin, end = f"<!-- table: {name} -->\n", f"<!-- end: {name} -->"
        before, rest = page.split(begin)
        page = before + begin + "\n".join(TABLES[name]()) + "\n" + end + rest.split(end, 1)[1]
    return page


if __name__ == "__main__":
    with one_thread():
        for wanted in sys.argv[1:] or TABLES:
            PAGE.write_text(filled(PAGE.read_text(), [wanted]))
