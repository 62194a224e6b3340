"""The attack table: as many machines in every cell; outcomes are kept, so that it goes on where it was stopped."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict
from itertools import product
from multiprocessing import Pool
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import stats

from benchmarks.trust.attacks import ATTACKS, Attack, Outcome, outcome
from benchmarks.trust.benches import PLACES, PRIORS
from benchmarks.trust.sources import ROOT, version

FIRST = 20_261_200
"""The seed of the first machine: nobody has looked at these before they were shown."""
_KEPT = ROOT / "build" / "attacks"
_SURE = 0.95
_GOAL = 0.02


class Trial(NamedTuple):
    """One machine of one cell.  attack : its number"""

    attack: int
    places: str
    scales: str
    seed: int


CELLS = tuple(product(PLACES, PRIORS))


class Kept:
    """Outcomes of this version, one line of a file for each."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.outcomes: dict[Trial, Outcome] = {}
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        self._torn = bool(text) and not text.endswith("\n")
        for line in text.splitlines():
            with suppress(ValueError, KeyError, TypeError):  # the last line may be half written
                row = json.loads(line)
                self.outcomes[Trial(*row["trial"])] = Outcome(**row["outcome"])

    def keep(self, trial: Trial, found: Outcome) -> None:
        """Add an outcome."""
        self.outcomes[trial] = found
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._path.open("a", encoding="utf-8") as file:
            file.write("\n" * self._torn + json.dumps({"trial": trial, "outcome": asdict(found)}) + "\n")
            self._torn = False


def kept_outcomes() -> Kept:
    """Return the outcomes of this version that are there already."""
    beside = [Path(__file__).with_name(name) for name in ("attacks.py", "benches.py")]
    return Kept(_KEPT / f"{version(beside)}.jsonl")


def attacked(kept: Kept, machines: int, processes: int, seconds: float) -> int:
    """Try the machines that are missing, one of every cell after the other, and return how many every cell has now.

    seconds : after which to stop; what is done is kept, and the next run goes on from there
    """
    wanted = [
        Trial(number, places, scales, FIRST + index)
        for index, number, (places, scales) in product(range(machines), range(len(ATTACKS)), CELLS)
    ]
    missing, until = [trial for trial in wanted if trial not in kept.outcomes], time.monotonic() + seconds
    with Pool(processes) as pool:
        for trial, found in pool.imap_unordered(_tried, missing):
            kept.keep(trial, found)
            if time.monotonic() > until:
                pool.terminate()
                break
    return _complete(kept, machines)


def _tried(trial: Trial) -> tuple[Trial, Outcome]:
    return trial, outcome(ATTACKS[trial.attack], trial.places, trial.scales, trial.seed)


def _complete(kept: Kept, machines: int) -> int:
    """Return how many of the first machines are there in every cell."""
    for index in range(machines):
        cells = product(range(len(ATTACKS)), CELLS)
        if any(Trial(number, *cell, FIRST + index) not in kept.outcomes for number, cell in cells):
            return index
    return machines


def attack_rows(kept: Kept, machines: int) -> Iterator[str]:
    """Yield the lines of the table: one for each attack, a cell for each of places and priors."""
    for number, attack in enumerate(ATTACKS):
        cells = [_cell(_outcomes(kept, number, cell, machines)) for cell in CELLS]
        yield f"| {attack.words} | {' | '.join(cells)} |"


def _outcomes(kept: Kept, attack: int, cell: tuple[str, str], machines: int) -> list[Outcome]:
    return [kept.outcomes[Trial(attack, *cell, FIRST + index)] for index in range(machines)]


def _cell(found: Sequence[Outcome]) -> str:
    told = [each for each in found if each.word != "refused"]
    if not told:
        return "refused"
    ratio = float(np.exp(np.mean(np.log([each.ratio for each in told]))))
    inside, holds = (float(np.mean(part)) for part in zip(*((o.inside, o.word == "holds") for o in told), strict=True))
    low, high = limits(sum(each.silent for each in found), len(found))
    silent = np.mean([each.silent for each in found])
    return f"{ratio:.1f}, {inside:.0%}, {holds:.0%}, **{silent:.0%}** ({low:.0%}–{high:.0%})"


def limits(count: int, of: int) -> tuple[float, float]:
    """Return the limits of a share that hold with 95 % (Clopper and Pearson 1934)."""
    found = stats.binomtest(count, of).proportion_ci(_SURE, method="exact")
    return float(found.low), float(found.high)


def goal_lines(kept: Kept, machines: int) -> Iterator[str]:
    """Yield in words how many cells reach the goal, and which surely do not."""
    cells = [
        (attack, cell, sum(each.silent for each in _outcomes(kept, number, cell, machines)))
        for number, attack in enumerate(ATTACKS)
        for cell in CELLS
        if "sign" not in attack.words
    ]
    reached = sum(silent <= _GOAL * machines for _, _, silent in cells)
    yield ""
    yield f"Of {len(cells)} cells beside a turned sign, {reached} have at most {_GOAL:.0%} of silent machines."
    yield f"Where none of {machines} is, the share may still be up to {limits(0, machines)[1]:.0%}."
    yield from _missed(cells, machines)


def _missed(cells: Iterable[tuple[Attack, tuple[str, str], int]], machines: int) -> Iterator[str]:
    surely = [(a, c, silent) for a, c, silent in cells if limits(silent, machines)[0] > _GOAL]
    if surely:
        named = "; ".join(
            f"{a.words} ({places}, {_PRIOR[scales]}) {s / machines:.0%}" for a, (places, scales), s in surely
        )
        yield f"More than that, by the lower limit of their share: {named}."


_PRIOR = {"stated": "stated", "estimate": "learnt"}


def processes_here() -> int:
    """Return how many may work at once."""
    return os.cpu_count() or 1
