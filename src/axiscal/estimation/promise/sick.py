"""Instruments that show something else than the machine: a catalogue of what is sick, weighed against what is right.

A row says what the machine has to make then, y' of the readings y, and how probable the rest is. So the odds are

    log PRIOR + log p(rest) + log p(y') − log p(y),    p with the sizes integrated out

- still: a set-up shows one digit, anywhere within w, or d neighbouring ones, each as likely. The rest are all its n
  readings, over the step q of the display: d^−n q^(1−n)/w. Zeros alone are such readings.
- shifted: each value belongs to the place behind or before, as if a line was missed. The one that is left is anywhere
  among the others. A reading that seems bad may be one of these, so it counts.
- unit: values, not all alike, are f times too small, p(rest) = f^m. As probable as any mistake is a noise f times below
  what is stated, which must not explain them as well.
- noise: P(θ < log 0.1 | y), θ its logarithm over what is stated, against as much before any reading.

Sizes as stated and others tell first whether anything is to be weighed.

Stuck is what shows again what it showed before, as a probe that repeats its last height.
Of n readings of a set-up s show the same value as the one before. If the machine made these values, they have the
density p(yₛ | others), each over a step q of the display; if the instrument is stuck they are certain. So the odds are

    log PRIOR − log places − log p(y) + log p(y without these) − Σ log q,    p with the sizes integrated out

One run of equal values has n²/2 places, equal values anywhere (n + 1) binomial(n, s). Values that are no multiples of
their smallest difference show the step by their last digits; so does the one of a display that never showed two, at
most √(2π) σ of its noise.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.agreement import INCH, NAMED, PRIOR, SEVERAL, Explained, Tried, numbers_of_one, tail_of
from axiscal.estimation.promise.jumps import LOG_BAD
from axiscal.estimation.promise.mistaken import as_stated_or_not, gains_of_columns, log_odds_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal_core.draws import Weighed, sized
from axiscal_core.from_scipy import normal_share
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given
from axiscal_core.unknowns import space_of

_FEWEST = 4
"""Readings of a set-up: three are still, or in another order, by chance."""
_ANYWHERE = 1e3
"""Noises: where a display may stand, as wide as zeros are as a rule."""
_DIGITS = 3.5
"""A last digit that flickers shows its neighbours, and nothing else."""
_SMALLER = 1000.0, INCH
"""By definition: mm for um, and inches for mm."""
_QUIET = math.log(0.1)
"""Of a stated noise, its logarithm: nobody states one ten times too large, and another unit is farther off."""


def sick(problem: Problem, found: Weighed, whole: Problem) -> Iterator[Tried]:
    """Yield what is sick.  found : draws for the readings if nothing is; whole : with those that seem bad"""
    right, each = found.log_evidence, as_stated_or_not(problem, found.drawn.stated)
    for setup in np.unique(problem.setup).tolist():
        mine = problem.setup == setup
        if (count := len(np.unique(problem.reading[mine]))) < _FEWEST:
            continue
        one = _Mounted(problem, found, each, mine, right)
        yield from (*one.still(), *one.other_unit(), *one.quiet())
        among = whole.only((whole.setup == setup) | np.isin(whole.reading, problem.reading))
        if bad := len(np.unique(among.reading[among.setup == setup])) - count:
            one = _Mounted(among, found, as_stated_or_not(among), among.setup == setup, right + bad * LOG_BAD)
        yield from one.shifted()


@dataclass(frozen=True, eq=False)
class _Mounted:
    """A set-up among readings.  each : everything at some sizes; mine : (m,) its numbers; right : log p if not sick"""

    problem: Problem
    found: Weighed
    each: Sequence[Given]
    mine: NDArray[np.bool_]
    right: float

    @property
    def setups(self) -> tuple[int, ...]:
        return (int(self.problem.setup[self.mine][0]),)

    def still(self) -> Iterator[Tried]:
        """Yield that it shows the same everywhere."""
        problem, mine = self.problem, self.mine
        gain, rest = flickering(problem.values[mine], numbers_of_one(problem.reading[mine])), problem.only(~mine)
        if gain < log_density_of(self.found.drawn.stated, rest):
            return
        odds = math.log(PRIOR) + gain - self.right
        wrong = Explained("still", odds, self.setups)
        yield Tried.of(wrong, odds, rest) if len(rest.values) else Tried(wrong, 1.0)

    def shifted(self) -> Iterator[Tried]:
        """Yield that each value belongs to the place behind, or to that before."""
        problem, mine = self.problem, self.mine
        values, count = problem.values * problem.noise, numbers_of_one(problem.reading[mine])
        wide = max(1.0, float(np.std(problem.values[mine])))
        for step, left in ((1, np.flatnonzero(mine)[:count]), (-1, np.flatnonzero(mine)[-count:])):
            moved = values.copy()
            moved[mine] = np.roll(values[mine], step * count)
            free = wide * (left[:, None] == np.arange(len(values)))
            wrong = Explained("shifted", math.log(PRIOR), self.setups, factor=float(step))
            yield from self._weighed(wrong, moved / problem.noise, free)

    def other_unit(self) -> Iterator[Tried]:
        """Yield that all values are as much too small as another unit makes them."""
        problem, mine, none = self.problem, self.mine, np.zeros((1, len(self.mine)))
        for factor in _SMALLER if np.ptp(problem.values[mine]) > _ALIKE else ():
            rest, scale = int(mine.sum()) * math.log(factor), np.where(mine, factor, 1.0)
            wrong = Explained("unit", math.log(PRIOR) + rest, self.setups, factor=1 / factor)
            for each in self._weighed(wrong, scale * problem.values, none):
                rows, type_b = scale[:, None] * problem.rows, scale[:, None] * problem.type_b
                quiet = replace(problem, values=scale * problem.values, rows=rows, type_b=type_b)
                gain = math.log(PRIOR) + rest + sized(quiet).log_evidence - self.right
                odds = each.mistake.log_odds - float(np.logaddexp(0.0, gain))
                yield each._replace(mistake=each.mistake._replace(log_odds=odds))

    def _weighed(self, wrong: Explained, values: Array, free: Array) -> Iterator[Tried]:
        """Yield a mistake, what values were without it, and columns of what is left: where sizes as stated allow it."""
        before = wrong.log_odds
        gains = [
            (given.misfit - given.misfit_of(values)) / 2 + gains_of_columns(given, free[None], values, [1.0])[0, 0]
            for given in self.each
        ]
        if before + log_odds_of(self.each, np.array(gains)) < -math.log(NAMED):
            return
        other = replace(self.problem, values=values)
        beside = sized(other.wider(free))
        varied = np.unique(self.problem.groups[self.mine])
        louder = np.max(beside.weights @ beside.thetas[:, varied[varied >= 0]], initial=-np.inf)
        if wrong.mistake == "unit" and math.exp(2 * float(louder)) < wrong.factor:
            return  # its noise is nearer to what was written
        odds = before + beside.log_evidence - self.right
        yield Tried(wrong._replace(log_odds=odds), tail_of(other, beside))

    def quiet(self) -> Iterator[Tried]:
        """Yield that its noise is below a tenth of what is stated."""
        found, sizes = self.found, self.problem.sizes
        for group in np.unique(self.problem.groups[self.mine & (self.problem.groups >= 0)]).tolist():
            below = float(normal_share(np.array(_QUIET / (sizes.share * sizes.of[group].spread))))
            share = float(found.weights @ (found.thetas[:, group] < _QUIET))
            # draws tell no probability that is less than that of half of one
            odds = share / max(1 - share, 0.5 / len(found.every)) * (1 - below) / below
            if share > 0:
                factor = math.exp(float(found.weights @ found.thetas[:, group]))
                yield Tried(Explained("noise", math.log(PRIOR * odds), self.setups, factor=factor), 1.0)


def flickering(values: Array, count: int = 1) -> float:
    """Return log p of values if a display shows neighbouring digits alone, up to (2π)^(−m/2); −∞ for many.

    values : (m,) over the noise; count : numbers of a reading
    """
    total = 0.0
    for each in values.reshape(-1, count).T:
        shown = _ALIKE * np.unique(np.round(each / _ALIKE))
        step = float(np.diff(shown).min()) if len(shown) > 1 else _FINEST
        if (digits := 1 + float(np.ptp(shown)) / step) > _DIGITS:
            return -math.inf
        total += (len(each) - 1) * math.log(_OF_NOISE / step) - len(each) * math.log(digits) - math.log(_ANYWHERE)
    return total


_ALIKE = 1e-5
"""Steps by which a multiple may be off: beyond the rounding of a float, and seldom met by another value."""
_OF_NOISE = math.sqrt(2 * math.pi)
"""Noises: the step at which equal values of a machine without errors would be certain."""
_FINEST = 0.01
"""Noises: what differs by less differs by the arithmetic of a program."""


class Repeats(NamedTuple):
    """Readings that show what the one before in their set-up shows.

    setups : whose; readings : (s,) their indices; log_places : logarithm of the number of patterns as likely as theirs
    steps : of what a set-up shows, m or rad
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
    for reading in readings:
        shown[reading.setup].update(reading.values)
    values = {number: np.sort([*shown[setups[number].name]]) for number in some}
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


def stuck(problem: Problem, found: Weighed, repeated: Iterable[Repeats]) -> Iterator[Tried]:
    """Yield the readings that an instrument was stuck at, where sizes as stated and as learnt both say so."""
    for each in repeated:
        again = np.isin(problem.reading, each.readings)
        if len(each.readings) < SEVERAL - 1 or not again.any() or again.all():
            continue
        pairs = zip(problem.setup[again].tolist(), problem.noise[again].tolist(), strict=True)
        steps = (each.steps[setup] / noise for setup, noise in pairs)
        prior = math.log(PRIOR) - each.log_places - sum(math.log(max(step, _FINEST)) for step in steps)
        prior += 0.5 * int(again.sum()) * math.log(2 * math.pi)
        rest = problem.only(~again)
        if prior - log_density_of(found.drawn.stated, rest) > math.log(NAMED):
            wrong = Explained("stuck", 0.0, each.setups, int(each.readings.min()))
            yield Tried.of(wrong, prior - found.log_evidence, rest)


def log_density_of(given: Given, others: Problem) -> float:
    """Return log p(yₛ | others) of the numbers that others lack, up to (2π)^(−s/2)."""
    without = space_of(others).given(given.theta)
    assert without is not None, "a covariance with noise is positive definite"
    return given.density - without.density
