"""Instruments that show something else than the machine: a catalogue of what is sick, weighed against what is right.

A row says what the machine has to make then, y' of the readings y, and how probable the rest is. So the odds are

    log PRIOR + log p(rest) + log p(y') − log p(y),    p with the sizes integrated out

- still: a set-up shows one value, anywhere, and a flicker s below its noise. The rest are all its readings, normal with
  covariance s² + w² 11ᵀ, each s as probable. Zeros alone are such readings.
- shifted: each value belongs to the place behind or before, as if a line was missed. The one that is left is anywhere
  among the others.
- unit: values, not all alike, are f times too small, p(rest) = f^m. Where the noise is nearer to what was written it is
  none.
- noise: P(θ < log 0.1 | y), θ its logarithm over what is stated, against as much before any reading.

Sizes as stated and others tell first whether anything is to be weighed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.agreement import INCH, NAMED, PRIOR, Explained, Tried, numbers_of_one, tail_of
from axiscal.estimation.promise.jumps import ways_of
from axiscal.estimation.promise.mistaken import as_stated_or_not, gains_of_columns, log_odds_of
from axiscal.estimation.promise.stuck import log_density_of
from axiscal.numerics import Array
from axiscal_core.draws import Weighed, sized
from axiscal_core.from_scipy import normal_share
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given
from axiscal_core.unknowns import space_of

_FEWEST = 4
"""Readings of a set-up: three are still, or in another order, by chance."""
_FLICKERS = 1e-3, 1e-2, 0.1, 0.25, 0.6
"""Noises: a last digit that flickers moves a display by less than what is stated of all that moves it."""
_ANYWHERE = 1e3
"""Noises: where a display may stand, as wide as zeros are as a rule."""
_SMALLER = 1000.0, INCH
"""By definition: mm for um, and inches for mm."""
_QUIET = math.log(0.1)
"""Of a stated noise, its logarithm: nobody states one ten times too large, and another unit is farther off."""


def sick(problem: Problem, found: Weighed[Given]) -> Iterator[Tried]:
    """Yield what is sick.  found : draws for the readings if nothing is"""
    each = as_stated_or_not(problem, found.drawn.stated)
    for setup in np.unique(problem.setup).tolist():
        mine = problem.setup == setup
        if len(np.unique(problem.reading[mine])) >= _FEWEST:
            one = _Mounted(problem, found, each, mine)
            yield from (*one.still(), *one.shifted(), *one.other_unit(), *one.quiet())


@dataclass(frozen=True, eq=False)
class _Mounted:
    """A set-up among readings.  each : everything at some sizes; mine : (m,) its numbers"""

    problem: Problem
    found: Weighed[Given]
    each: Sequence[Given]
    mine: NDArray[np.bool_]

    @property
    def setups(self) -> tuple[int, ...]:
        return (int(self.problem.setup[self.mine][0]),)

    def still(self) -> Iterator[Tried]:
        """Yield that it shows the same everywhere."""
        problem, mine, p = self.problem, self.mine, 1.0
        gain = flickering(problem.values[mine], ways_of(problem, mine)[:, mine])
        constant = 0.5 * int(mine.sum()) * math.log(2 * math.pi)
        if gain - constant < log_density_of(self.found.drawn.stated, mine):
            return
        gain -= self.found.log_evidence
        if len((rest := problem.only(~mine)).values):
            others = sized(space_of(rest))
            gain, p = gain + others.log_evidence, tail_of(rest, others)
        yield Tried(Explained("still", math.log(PRIOR) + gain, self.setups), p)

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
        problem, mine, none = self.problem, self.mine, np.zeros((0, len(self.mine)))
        for factor in _SMALLER if np.ptp(problem.values[mine]) else ():
            odds = math.log(PRIOR) + int(mine.sum()) * math.log(factor)
            wrong = Explained("unit", odds, self.setups, factor=1 / factor)
            yield from self._weighed(wrong, np.where(mine, factor * problem.values, problem.values), none)

    def _weighed(self, wrong: Explained, values: Array, free: Array) -> Iterator[Tried]:
        """Yield a mistake, what values were without it, and columns of what is left: where sizes as stated allow it."""
        before = wrong.log_odds
        gains = [
            (given.misfit - float(values @ given.judged(values[:, None])[:, 0])) / 2
            + (gains_of_columns(given, free[None], values, [1.0])[0, 0] if len(free) else 0.0)
            for given in self.each
        ]
        if before + log_odds_of(self.each, np.array(gains)) < -math.log(NAMED):
            return
        other = replace(self.problem, values=values)
        beside = sized(space_of(other.wider(free) if len(free) else other))
        quieter = math.exp(float(np.max(self._noises(beside), initial=-np.inf)) * 2)
        if wrong.mistake == "unit" and quieter < wrong.factor:
            return
        odds = before + beside.log_evidence - self.found.log_evidence
        yield Tried(wrong._replace(log_odds=odds), tail_of(other, beside))

    def _noises(self, found: Weighed[Given]) -> Array:
        """Return the means of the logarithms of its noises over what is stated; none where these stay."""
        varied = np.unique(self.problem.groups[self.mine])
        return np.asarray(found.weights @ found.thetas[:, varied[varied >= 0]])

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


def flickering(values: Array, ways: Array) -> float:
    """Return log p of values if they are one and a flicker, up to (2π)^(−m/2).

    values : (m,) over the noise; ways : (k, m) what one of each adds
    """
    own, pulled, logs = ways @ ways.T, ways @ values, list[float]()
    for size in _FLICKERS:
        within = own + (size / _ANYWHERE) ** 2 * np.eye(len(ways))
        square = (values @ values - pulled @ np.linalg.solve(within, pulled)) / size**2
        spread = np.linalg.slogdet((_ANYWHERE / size) ** 2 * within)[1] + 2 * len(values) * math.log(size)
        logs.append(-0.5 * float(square + spread))
    return float(np.logaddexp.reduce(logs) - math.log(len(logs)))
