"""The attack table: as many machines in every cell; outcomes are kept, so that it goes on where it was stopped."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy import stats

from benchmarks.trust.attacks import ATTACKS, Attack, Outcome, outcome
from benchmarks.trust.benches import PLACES, PRIORS
from benchmarks.trust.kept import KEPT, Found, Keeping

FIRST = 20_261_200
"""The seed of the first machine: nobody has looked at these before they were shown."""
_SURE = 0.95
_GOAL = 0.02


class Trial(NamedTuple):
    """One machine of one cell.  attack : its number"""

    attack: int
    places: str
    scales: str
    seed: int


CELLS = tuple(product(PLACES, PRIORS))
Outcomes = dict[Trial, Outcome]


EVERY = tuple(range(len(ATTACKS)))


def beginning_with(words: Sequence[str]) -> tuple[int, ...]:
    """Return the numbers of the attacks that begin with one of some words."""
    return tuple(number for number in EVERY if ATTACKS[number].words.startswith(tuple(words)))


def attacked(machines: int, processes: int, seconds: float, which: Sequence[int] = EVERY) -> tuple[Outcomes, int]:
    """Try the machines that are missing, one of every cell after the other; return the outcomes of this version.

    seconds : after which no more are begun; what is done is kept, and the next run goes on from there
    which : numbers of the attacks
    Returns with them how many machines every cell has now. Raises StudyError where one could not be tried.
    """
    wanted = [
        Trial(number, places, scales, FIRST + index)
        for index, number, (places, scales) in product(range(machines), which, CELLS)
    ]
    beside = [Path(__file__).with_name(name) for name in ("attacks.py", "benches.py")]
    found = Keeping("attacks", beside, processes, seconds, KEPT).found(tried, wanted)
    outcomes = {Trial(*key): _outcome(result) for key, result in found.items()}
    return outcomes, _complete(outcomes, machines, which)


def tried(trial: Trial) -> dict[str, Any]:
    """Return the outcome of one machine, what is not a number as none."""
    found = asdict(outcome(ATTACKS[trial.attack], trial.places, trial.scales, trial.seed))
    return {name: None if value != value else value for name, value in found.items()}


def _outcome(result: Found) -> Outcome:
    names = ("ratio", "inside", "rare")
    ratio, inside, rare = (math.nan if result[name] is None else float(result[name]) for name in names)
    return Outcome(ratio, inside, str(result["word"]), rare)


def _complete(kept: Outcomes, machines: int, which: Sequence[int]) -> int:
    """Return how many of the first machines are there in every cell."""
    for index in range(machines):
        cells = product(which, CELLS)
        if any(Trial(number, *cell, FIRST + index) not in kept for number, cell in cells):
            return index
    return machines


def attack_rows(kept: Outcomes, machines: int, which: Sequence[int] = EVERY) -> Iterator[str]:
    """Yield the lines of the table: one for each attack, a cell for each of places and priors."""
    for number in which:
        cells = [_cell(_outcomes(kept, number, cell, machines)) for cell in CELLS]
        yield f"| {ATTACKS[number].words} | {' | '.join(cells)} |"


def _outcomes(kept: Outcomes, attack: int, cell: tuple[str, str], machines: int) -> list[Outcome]:
    return [kept[Trial(attack, *cell, FIRST + index)] for index in range(machines)]


def _cell(found: Sequence[Outcome]) -> str:
    told = [each for each in found if each.word != "refused"]
    if not told:
        return "refused"
    ratio = float(np.exp(np.mean(np.log([each.ratio for each in told]))))
    inside, holds = (float(np.mean(part)) for part in zip(*((o.inside, o.word == "holds") for o in told), strict=True))
    low, high = limits(sum(each.silent for each in found), len(found))
    silent, broken = (np.mean(part) for part in zip(*((each.silent, each.broken) for each in found), strict=True))
    beyond = "" if broken == silent else f", {broken:.0%} beyond"
    return f"{ratio:.1f}, {inside:.0%}, {holds:.0%}, **{silent:.0%}** ({low:.0%}–{high:.0%}){beyond}"


def limits(count: int, of: int) -> tuple[float, float]:
    """Return the limits of a share that hold with 95 % (Clopper and Pearson 1934)."""
    found = stats.binomtest(count, of).proportion_ci(_SURE, method="exact")
    return float(found.low), float(found.high)


def goal_lines(kept: Outcomes, machines: int) -> Iterator[str]:
    """Yield in words how many cells reach the goal, and which surely do not."""
    cells = [
        (attack, cell, sum(each.silent for each in _outcomes(kept, number, cell, machines)))
        for number, attack in enumerate(ATTACKS)
        for cell in CELLS
        if "sign" not in attack.words
    ]
    reached = sum(each <= _GOAL * machines for _, _, each in cells)
    yield ""
    yield f"Of {len(cells)} cells beside a turned sign, {reached} have at most {_GOAL:.0%} of silent machines."
    silent, tried = sum(each for _, _, each in cells), len(cells) * machines
    low, high = limits(silent, tried)
    yield f"Over all of them {silent} of {tried} machines are silent, {silent / tried:.1%} ({low:.1%}–{high:.1%})."
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
