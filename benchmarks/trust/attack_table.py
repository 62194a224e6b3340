"""The attack table: as many machines in every cell; outcomes are kept, so that it goes on where it was stopped."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy import stats

from benchmarks.trust.attacks import ATTACKS, Outcome, outcome
from benchmarks.trust.benches import PLACES
from benchmarks.trust.kept import KEPT, Found, Keeping

FIRST = 20_262_000
"""The seed of the first machine: nobody has looked at these before they were shown."""
FAR = 1.5
"""Of true to promised RMS: a machine beyond is far worse than promised."""
_SCALES = "estimate"
_SURE = 0.95
_GOAL = 0.02


class Trial(NamedTuple):
    """One machine of one cell.  attack : its number"""

    attack: int
    places: str
    seed: int


Outcomes = dict[Trial, Outcome]


KNOWN = tuple(range(len(ATTACKS)))
"""Numbers of all attacks."""


def beginning_with(words: Sequence[str]) -> tuple[int, ...]:
    """Return the numbers of the attacks that begin with one of some words."""
    return tuple(number for number in KNOWN if ATTACKS[number].words.startswith(tuple(words)))


def attacked(machines: int, processes: int, seconds: float, which: Sequence[int] = KNOWN) -> tuple[Outcomes, int]:
    """Try the machines that are missing, one of every cell after the other; return the outcomes of this version.

    seconds : after which no more are begun; what is done is kept, and the next run goes on from there
    which : numbers of the attacks
    Returns with them how many machines every cell has.
    """
    wanted = [Trial(number, where, FIRST + index) for index, number, where in product(range(machines), which, PLACES)]
    beside = [Path(__file__).with_name(name) for name in ("attacks.py", "benches.py")]
    found = Keeping("attacks", beside, processes, seconds, KEPT).found(tried, wanted)
    outcomes = {Trial(*key): _outcome(result) for key, result in found.items()}
    return outcomes, _complete(outcomes, machines, which)


def tried(trial: Trial) -> dict[str, Any]:
    """Return the outcome of one machine, what is not a number as none."""
    found = asdict(outcome(ATTACKS[trial.attack], trial.places, _SCALES, trial.seed))
    return {name: None if value != value else value for name, value in found.items()}


def _outcome(result: Found) -> Outcome:
    ratio, inside = (math.nan if result[name] is None else float(result[name]) for name in ("ratio", "inside"))
    return Outcome(ratio, inside, bool(result["withheld"]))


def _complete(kept: Outcomes, machines: int, which: Sequence[int]) -> int:
    """Return how many of the first machines are there in every cell."""
    for index in range(machines):
        if any(Trial(number, where, FIRST + index) not in kept for number, where in product(which, PLACES)):
            return index
    return machines


def attack_rows(kept: Outcomes, machines: int, which: Sequence[int] = KNOWN) -> Iterator[str]:
    """Yield the lines of the table: one for each attack, a cell for each choice of places."""
    for number in which:
        cells = [_cell(_outcomes(kept, number, where, machines)) for where in PLACES]
        yield f"| {ATTACKS[number].words} | {' | '.join(cells)} |"


def _outcomes(kept: Outcomes, attack: int, places: str, machines: int) -> list[Outcome]:
    return [kept[Trial(attack, places, FIRST + index)] for index in range(machines)]


def _cell(found: Sequence[Outcome]) -> str:
    """Return share inside, ratio and share far off where U is printed, and the share withheld, if any is."""
    told = [each for each in found if not each.withheld]
    withheld = f"{1 - len(told) / len(found):.0%}"
    if not told:
        return f"–, –, –, {withheld}"
    inside, ratios = np.mean([each.inside for each in told]), np.array([each.ratio for each in told])
    shown = f"{inside:.0%}, {np.exp(np.mean(np.log(ratios))):.2f}, {np.mean(ratios > FAR):.0%}"
    return f"{shown}, {withheld}" if len(told) < len(found) else shown


def limits(count: int, of: int) -> tuple[float, float]:
    """Return the limits of a share that hold with 95 % (Clopper and Pearson 1934)."""
    found = stats.binomtest(count, of).proportion_ci(_SURE, method="exact")
    return float(found.low), float(found.high)


def goal_lines(kept: Outcomes, machines: int) -> Iterator[str]:
    """Yield how many cells have few machines far off."""
    cells = [
        sum(_far(each) for each in _outcomes(kept, number, places, machines))
        for number, attack in enumerate(ATTACKS)
        for places in PLACES
        if "sign" not in attack.words
    ]
    reached = sum(each <= _GOAL * machines for each in cells)
    far, tried = sum(cells), len(cells) * machines
    low, high = limits(far, tried)
    yield ""
    yield f"Of {len(cells)} cells beside a turned sign, {reached} have at most {_GOAL:.0%} of machines above {FAR}."
    yield f"Over all of them {far} of {tried} machines are, {far / tried:.1%} ({low:.1%}–{high:.1%})."
    yield f"Where none of {machines} is, the share may still be up to {limits(0, machines)[1]:.0%}."


def _far(found: Outcome) -> bool:
    """Return whether U is printed of a machine that is far worse than promised."""
    return not found.withheld and found.ratio > FAR
