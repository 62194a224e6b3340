"""Whether the readings agree with each other, and which mistake explains it where they do not.

Each reading is left out and expected from the others: z² per number has mean 1, c² is its mean. With Q = yᵀK⁻¹y the
probability of readings that agree no better is p = Σ w P(χ²_m ≥ Q_θ), and Bonferroni's for the largest |z|; twice the
smaller of both is printed. Below 0.001 the readings contradict. A mistake turns y into y' = T y (values with the wrong
sign or in another unit, two set-ups swapped, places shifted by one), or adds a column b of standard deviation s:

    gain = ½ (yᵀK⁻¹y − y'ᵀK⁻¹y') + log |det T|     or     ½ (bᵀK⁻¹y)²/(bᵀK⁻¹b + s⁻²) − ½ log(1 + s² bᵀK⁻¹b)

One whose odds, its prior of 1 % among so many places included, are above 20 : 1 is named, unless another one is 20
times as likely.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.numerics.from_scipy import chi_square_tail
from axiscal.promise.draws import Weighed
from axiscal.promise.problem import Problem

CONTRADICTS = 0.001
"""Probability below which readings contradict."""
NAMED = 20.0
"""Odds from which a mistake is named, and beside the likeliest one left unnamed."""
AGREES = 3.0
"""Standard deviations within which a reading agrees with the others."""
_PRIOR = 0.01
"""Assumption: one campaign in a hundred has such a mistake."""
_JUMP = 30.0
"""Noises: standard deviation of a jump of a zero."""
_LARGEST = 600.0
"""Logarithm of the largest odds that are said: beyond it floats end."""
_INCH = 25.4
"""mm, by definition."""
_FACTORS = (1000.0, 1 / 1000.0, _INCH, 1 / _INCH)
"""By definition: mm for um, and inches for mm."""

Mistake = Literal["jump", "sign", "unit", "swapped", "shifted"]


class Explained(NamedTuple):
    """A mistake that explains readings that contradict.

    log_odds : beside no mistake; setups : whose readings; reading : index of the first that is wrong, for a jump
    factor : by which values are too large or too small, for a unit
    """

    mistake: Mistake
    log_odds: float
    setups: tuple[int, ...]
    reading: int = -1
    factor: float = 1.0

    @property
    def odds(self) -> float:
        """Beside no mistake."""
        return float(np.exp(min(self.log_odds, _LARGEST)))


@dataclass(frozen=True)
class Agreement:
    """count : readings that were compared; agreeing : those within three standard deviations of what others say

    c2 : c²; p : probability of readings that agree no better; explained : mistakes that are named, likeliest first
    """

    count: int
    agreeing: int
    c2: float
    p: float
    explained: tuple[Explained, ...] = ()

    @property
    def contradicts(self) -> bool:
        """Whether the readings contradict each other."""
        return self.p < CONTRADICTS

    @property
    def withheld(self) -> bool:
        """Whether no uncertainty may be printed: the readings contradict and no mistake explains it."""
        return self.contradicts and not self.explained

    @property
    def inflation(self) -> float:
        """c² where it is larger than chance allows, by which all variances grow; else 1."""
        return self.c2 if self.count and self.c2 > 1 + 2 / np.sqrt(2 * self.count) else 1.0


NOTHING_READ = Agreement(0, 0, 1.0, 1.0)
"""Before the first reading nothing disagrees."""


def agreement(problem: Problem, found: Weighed, z: Array) -> Agreement:
    """Return how readings agree.

    problem : of the readings that count; z : (r,) of each of them, left out
    """
    count = len(z)
    if not count:
        return NOTHING_READ
    tails = [chi_square_tail(len(problem.values), given.square) for given in found.given]
    numbers = len(problem.values) / count
    largest = count * chi_square_tail(numbers, float(np.max(z**2)) * numbers)
    p = min(1.0, 2 * min(float(found.weights @ np.array(tails)), largest))
    explained = tuple(_explained(problem, found)) if p < CONTRADICTS else ()
    return Agreement(count, int(np.sum(z <= AGREES)), float(np.mean(z**2)), p, explained)


def _explained(problem: Problem, found: Weighed) -> list[Explained]:
    """Return the mistakes whose odds are above 20 : 1, but those beside which another one is 20 times as likely."""
    each = sorted([*_jumps(problem, found), *_turned(problem, found)], key=lambda one: -one.log_odds)
    least = max(np.log(NAMED), each[0].log_odds - np.log(NAMED))
    return [one for one in each if one.log_odds > least]


def _log_odds(found: Weighed, gains: Array) -> Array:
    """Return log odds of mistakes, 1 % before any reading, the sizes integrated out, (c,).  gains : (draws, c)"""
    most = np.max(gains, axis=0)
    result: Array = np.log(_PRIOR * (found.weights @ np.exp(gains - most))) + most
    return result


def _jumps(problem: Problem, found: Weighed) -> Iterator[Explained]:
    """Yield the likeliest jump of the zero of each set-up."""
    for setup in np.unique(problem.setup).tolist():
        mine = problem.setup == setup
        readings = np.unique(problem.reading[mine])[1:]
        if not len(readings):
            continue
        columns = (mine[:, None] & (problem.reading[:, None] >= readings)) / problem.noise[:, None]
        columns = columns * float(np.median(problem.noise[mine]))
        gains = np.empty((len(found.given), len(readings)))
        for draw, given in enumerate(found.given):
            weighted = given.precision(columns)
            fisher = np.sum(columns * weighted, axis=0)
            gains[draw] = 0.5 * (weighted.T @ problem.values) ** 2 / (fisher + _JUMP**-2)
            gains[draw] -= 0.5 * np.log1p(_JUMP**2 * fisher)
        odds = _log_odds(found, gains)
        best = int(np.argmax(odds))
        yield Explained("jump", float(odds[best] - np.log(len(readings))), (int(setup),), int(readings[best]))


def _turned(problem: Problem, found: Weighed) -> Iterator[Explained]:
    """Yield the mistakes that change the values themselves."""
    for mistake, setups, values, factor, log_det in _other_values(problem):
        gains = np.empty((len(found.given), 1))
        for draw, given in enumerate(found.given):
            both = np.column_stack([problem.values, values])
            weighted = given.precision(both)
            gains[draw] = (
                0.5 * float(np.sum(both[:, 0] * weighted[:, 0]) - np.sum(both[:, 1] * weighted[:, 1])) + log_det
            )
        yield Explained(mistake, float(_log_odds(found, gains)[0]), setups, factor=factor)


_Other = tuple[Mistake, tuple[int, ...], Array, float, float]


def _other_values(problem: Problem) -> Iterator[_Other]:
    """Yield what the values were without each mistake, with the factor and log |det T|."""
    setups = np.unique(problem.setup).tolist()
    values = problem.values * problem.noise
    for setup in setups:
        mine = problem.setup == setup
        yield "sign", (setup,), np.where(mine, -values, values) / problem.noise, -1.0, 0.0
        for factor in _FACTORS:
            log_det = -float(mine.sum() * np.log(factor))
            yield "unit", (setup,), np.where(mine, values / factor, values) / problem.noise, factor, log_det
        for step in (1, -1):
            moved = values.copy()
            moved[mine] = np.roll(values[mine], step * _numbers(problem.reading[mine]))
            yield "shifted", (setup,), moved / problem.noise, float(step), 0.0
    for first in range(len(setups)):
        for second in range(first + 1, len(setups)):
            one, other = (np.flatnonzero(problem.setup == setups[i]) for i in (first, second))
            if len(one) == len(other):
                swapped = values.copy()
                swapped[one], swapped[other] = values[other], values[one]
                yield "swapped", (setups[first], setups[second]), swapped / problem.noise, 1.0, 0.0


def _numbers(reading: NDArray[np.intp]) -> int:
    """Return how many numbers a reading has."""
    return int(np.sum(reading == reading[0]))
