"""An instrument that shows again what it showed before: it is stuck, or a probe repeats its last height.

Of n readings of a set-up s show the same value as the one before. If the machine made these values, they have the
density p(yₛ | others), each over a step q of the display; if the instrument is stuck they are certain. So the odds are

    log PRIOR − log places − log p(y) + log p(y without these) − Σ log q,    p with the sizes integrated out

One run of equal values has n²/2 places, equal values anywhere (n + 1) binomial(n, s). Values that are no multiples of
their smallest difference show the step by their last digits; so does the one of a display that never showed two, at
most √(2π) σ of its noise. Sizes as stated tell first whether anything is to be weighed.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.agreement import NAMED, PRIOR, SEVERAL, Explained, Tried, tail_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal_core.draws import Weighed, sized
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given
from axiscal_core.unknowns import space_of

_ALIKE = 1e-5
"""Steps by which a multiple may be off: beyond the rounding of a float, and seldom met by another value."""
_OF_NOISE = math.sqrt(2 * math.pi)
"""Noises: the step at which equal values of a machine without errors would be certain."""
_FINEST = 0.01
"""Noises: what differs by less differs by the arithmetic of a program."""


class Repeats(NamedTuple):
    """Readings that show what the one before in their set-up shows.

    setups : whose; readings : (s,) their indices; log_places : logarithm of the number of patterns as likely as theirs
    steps : of what the instrument of a set-up shows, m or rad
    """

    setups: tuple[int, ...]
    readings: NDArray[np.intp]
    log_places: float
    steps: Mapping[int, float]


def repeats(setups: Sequence[Setup], readings: Sequence[Reading]) -> Iterator[Repeats]:
    """Yield what may be stuck: the longest run of each set-up, all that each repeats, and all that all repeat."""
    numbers, mine = {setup.name: number for number, setup in enumerate(setups)}, defaultdict[int, list[int]](list)
    for index, reading in enumerate(readings):
        mine[numbers[reading.setup]].append(index)
    again = dict[int, NDArray[np.intp]]()
    for number, every in mine.items():
        same = [i for last, i in pairwise(every) if readings[i].values == readings[last].values]
        if shown_again := [i for i in same if not readings[i].accepted]:  # what nobody vouches for
            again[number] = np.array(shown_again)
    steps = _steps(setups, readings, again) if again else {}
    for number, each in again.items():
        count, at = len(mine[number]), np.searchsorted(mine[number], each)
        run = max(np.split(each, np.flatnonzero(np.diff(at) > 1) + 1), key=len)
        of_run, of_all = math.log(count**2 / 2), _log_patterns(count - 1, len(each))
        if len(run) < len(each):
            yield Repeats((number,), run, of_run, steps)
        yield Repeats((number,), each, of_all if len(run) < len(each) else min(of_run, of_all), steps)
    if len(again) > 1:
        whole, possible = np.concatenate([*again.values()]), sum(len(mine[number]) - 1 for number in again)
        yield Repeats((*again,), whole, _log_patterns(possible, len(whole)), steps)


def _log_patterns(count: int, some: int) -> float:
    """Return log of (n + 1) binomial(n, s): any share of readings may repeat."""
    return math.log((count + 1) * math.comb(count, some))


def _steps(setups: Sequence[Setup], readings: Sequence[Reading], some: Iterable[int]) -> dict[int, float]:
    """Return the steps of some set-ups."""
    shown = defaultdict[str, set[float]](set)
    instruments = {setup.name: setup.instrument for setup in setups}
    for reading in readings:
        shown[instruments[reading.setup]].update(reading.values)
    values = {number: np.sort([*shown[setups[number].instrument]]) for number in some}
    return {number: _step(each, _OF_NOISE * setups[number].noise) for number, each in values.items()}


def _step(values: NDArray[np.float64], most: float) -> float:
    """Return the step of a display, by the values (v,) that it showed, ascending.  most : where it showed one value

    The smallest difference, if the others are multiples of it but for their last digits; else that of these digits.
    """
    decimals = (digit * 10.0**-place for place in range(3, 12) for digit in (5, 2, 1))
    digits = next((each for each in decimals if _multiples(values, each, _ALIKE)), 0.0)
    if len(values) == 1:
        return min(digits, most)
    apart = np.diff(values)
    smallest = float(apart.min())
    return smallest if _multiples(apart, smallest, 2 * digits / smallest + _ALIKE) else digits


def _multiples(values: NDArray[np.float64], step: float, off: float) -> bool:
    return bool(np.all(np.abs(values / step - np.round(values / step)) < off))


def stuck(problem: Problem, found: Weighed[Given], repeated: Iterable[Repeats]) -> Iterator[Tried]:
    """Yield the readings that an instrument was stuck at, where sizes as stated and as learnt both say so."""
    for each in repeated:
        again = np.isin(problem.reading, each.readings)
        if len(each.readings) < SEVERAL - 1 or not again.any() or again.all():
            continue
        pairs = zip(problem.setup[again].tolist(), problem.noise[again].tolist(), strict=True)
        steps = (each.steps[setup] / noise for setup, noise in pairs)
        prior = math.log(PRIOR) - each.log_places - sum(math.log(max(step, _FINEST)) for step in steps)
        if prior - log_density_of(found.drawn.stated, again) <= math.log(NAMED):
            continue
        rest = problem.only(~again)
        others = sized(space_of(rest))
        density = found.log_evidence - others.log_evidence - 0.5 * int(again.sum()) * math.log(2 * math.pi)
        first = int(each.readings.min())
        yield Tried(Explained("stuck", prior - density, each.setups, first), tail_of(rest, others))


def log_density_of(given: Given, some: NDArray[np.bool_]) -> float:
    """Return log p(yₛ | others) of some numbers (m,): Λ = (K⁻¹)ₛₛ is their precision, given the others."""
    alone = np.eye(len(some))[:, some]
    weighted = given.judged(np.column_stack([alone, given.problem.values]))[some]
    precision, pulled = weighted[:, :-1], weighted[:, -1]
    square = float(pulled @ np.linalg.solve(precision, pulled))
    return 0.5 * float(np.linalg.slogdet(precision / (2 * np.pi))[1] - square)
