"""A mistake in readings: what they were without it, and how probable that is beside none.

A mistake turns y into y' = T y, adds columns B, takes numbers away, or makes another problem of them. It has the odds

    log PRIOR − log places + log |det T| + log p(y') − log p(y),    p with the sizes integrated out

Sizes that are learnt swallow what is wrong, and each p costs an estimate. So a few sizes come first: those stated, a
tenth, a third, three times these. They tell the likeliest place of each mistake, and whether it is worth weighing:

    y' for y           ½ (yᵀK⁻¹y − y'ᵀK⁻¹y')
    columns B          ½ gᵀ(F + s⁻²)⁻¹g − ½ log |1 + s² F|,    g = BᵀK⁻¹y, F = BᵀK⁻¹B, s their standard deviation
    parts d of y' − y  −Σ gᵢ − ½ Σ Fᵢⱼ,    gᵢ = dᵢᵀK⁻¹y, Fᵢⱼ = dᵢᵀK⁻¹dⱼ

Sums that grow from part to part give the gain of all stretches at once. Of many places these are sought coarse to fine.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal_core.draws import Weighed, as_stated, sized
from axiscal_core.from_scipy import chi_square_tail
from axiscal_core.left_out import BAD_SHARE, OFF
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given, sums_of
from axiscal_core.theta import Kind
from axiscal_core.unknowns import space_of

CONTRADICTS = 0.001
"""Probability below which readings contradict."""
NAMED = 20.0
"""Odds from which a mistake is named, and beside the likeliest one left unnamed."""
LOG_NAMED = math.log(NAMED)
PRIOR = 0.01
"""Assumption: one campaign in a hundred has such a mistake."""
SEVERAL = 3
"""One or two bad readings are bad readings, of however few."""
LOG_BAD = math.log(BAD_SHARE / OFF)
"""Of log odds: what a bad reading costs."""
INCH = 25.4
"""mm, by definition."""
_LARGEST = 600.0
"""Logarithm of the largest odds that are said: beyond it floats end."""
_OFF = tuple(np.log([0.1, 1 / 3, 3.0]).tolist())
"""Of θ: factors that stated sizes are off by. Far larger ones than the machine's swallow what is wrong."""
_AT_ONCE = 1000
"""Places that are looked at in one go: more take time and memory, and between them lie few readings."""
_WEIGHED = 3
"""Suspects that are weighed: each costs as much as an estimate."""

Mistake = Literal[
    "jump", "sign", "unit", "swapped", "shifted", "stuck", "frame", "direction", "place", "sides", "mirrored", "still",
    "noise",
]  # fmt: skip
ASKED = ("jump", "stuck", "sign", "sides", "mirrored", "shifted", "still")
"""Mistakes that a person is asked about where the readings agree."""
DESCRIBED = ("direction", "place", "still", "noise")
"""Mistakes of a file, not of readings."""


class Explained(NamedTuple):
    """A mistake that explains readings that contradict.

    log_odds : beside no mistake; setups : whose readings
    reading : index of the first that is wrong, −1 for all; last : of the last one, −1 for all later ones
    factor : by which values are too large or too small, for a unit; axes : that count the other way
    backlash, detail : explain a jump as well: it is where the axis turned, or over a plane
    """

    mistake: Mistake
    log_odds: float
    setups: tuple[int, ...]
    reading: int = -1
    factor: float = 1.0
    axes: tuple[str, ...] = ()
    backlash: bool = False
    last: int = -1
    detail: bool = False

    @property
    def least(self) -> float:
        """Logarithm of the odds from which it is named."""
        return 0.0 if self.detail else -LOG_NAMED if self.backlash else LOG_NAMED

    @property
    def odds(self) -> float:
        """Beside no mistake."""
        return float(np.exp(min(self.log_odds, _LARGEST)))


class Tried(NamedTuple):
    """A mistake, with the probability of readings that agree no better with it."""

    mistake: Explained
    p: float


class Suspect(NamedTuple):
    """A mistake that readings may tell.

    mistake : with the log odds that a few sizes tell; prior : those before any reading, with log |det T|
    make : returns the readings without it; rival : as probable a machine as it is, that may show them
    """

    mistake: Explained
    prior: float
    make: Callable[[], Problem]
    rival: Callable[[], Problem] | None = None

    def weighed(self, right: float) -> Tried:
        """Return it with the sizes integrated out.  right : log p of the readings if nothing is wrong"""
        other = self.make()
        if not len(other.values):
            return Tried(self.mistake._replace(log_odds=self.prior - right), 1.0)
        found = sized(other)
        if self.rival is not None:
            groups = np.unique(other.groups[np.isin(other.setup, self.mistake.setups)])
            noise = np.exp(np.max(found.weights @ found.thetas[:, groups[groups >= 0]], initial=-np.inf))
            nearer = noise**2 < self.mistake.factor  # to what was written
            right = np.inf if nearer else np.logaddexp(right, self.prior + sized(self.rival()).log_evidence)
        return Tried(
            self.mistake._replace(log_odds=float(self.prior + found.log_evidence - right)), tail_of(other, found)
        )


def likeliest(suspects: Iterable[Suspect], least: float = -LOG_NAMED) -> list[Suspect]:
    """Return the suspects that are worth weighing.  least : log odds that a few sizes have to tell"""
    some = [one for one in suspects if one.mistake.log_odds > least]
    return sorted(some, key=lambda one: -one.mistake.log_odds)[:_WEIGHED]


def weigh(suspects: Iterable[Suspect], right: float, least: float = -LOG_NAMED) -> list[Tried]:
    """Return the likeliest ones with the sizes integrated out.  right : log p of the readings if nothing is wrong"""
    return [one.weighed(right) for one in likeliest(suspects, least)]


def explained(tried: Iterable[Tried]) -> list[Explained]:
    """Return the mistakes with which readings agree, at odds to be named and within 20 : 1 of the best."""
    each = sorted(tried, key=lambda one: -one.mistake.log_odds)
    near = each[0].mistake.log_odds - LOG_NAMED if each else 0.0
    likely = [
        one.mistake for one in each if one.mistake.log_odds > max(one.mistake.least, near) and 2 * one.p >= CONTRADICTS
    ]
    first = {(one.mistake, one.setups): one for one in reversed(likely)}
    return [one for one in likely if first[one.mistake, one.setups] is one]


def tail_of(problem: Problem, found: Weighed) -> float:
    """Return how probable readings are that agree no better, Σ w P(χ²_m ≥ Q_θ)."""
    tails = [chi_square_tail(len(problem.values), given.misfit) for given in found.given]
    return float(found.weights @ np.array(tails))


def numbers_of_one(reading: NDArray[np.intp]) -> int:
    """Return how many numbers a reading of a set-up has."""
    return int(np.sum(reading == reading[0]))


def of_kinds(problem: Problem, *kinds: Kind) -> NDArray[np.bool_]:
    """Return which columns have a size of these kinds, (p,)."""
    return np.isin(problem.size_at, [i for i, size in enumerate(problem.sizes.of) if size.kind in kinds])


@dataclass(frozen=True, eq=False)
class Sought:
    """Readings among which mistakes are sought.  each : everything at a few sizes, those as stated first"""

    problem: Problem
    each: Sequence[Given]

    @classmethod
    def of(cls, problem: Problem, stated: Given | None = None) -> Sought:
        """Return the readings of a problem.  stated : everything at the sizes as stated, where it is known already"""
        space = space_of(problem)
        kept = np.array([size.kind in ("length", "noise") for size in problem.sizes.of], dtype=bool)
        others = [space.given(np.where(kept, 0.0, off)) for off in _OFF]
        return cls(problem, [stated or as_stated(space), *(other for other in others if other is not None)])

    def of_setups(self) -> Iterator[tuple[int, NDArray[np.bool_]]]:
        """Yield the index of each set-up that was read, and which numbers are its own, (m,)."""
        yield from ((setup, self.problem.setup == setup) for setup in np.unique(self.problem.setup).tolist())

    def log_odds(self, gains: Array) -> Array:
        """Return log odds over the sizes.  gains : of each of the sizes first"""
        densities = np.array([given.density for given in self.each])
        beside = densities.reshape(-1, *[1] * (gains.ndim - 1))
        return np.asarray(np.logaddexp.reduce(gains + beside) - np.logaddexp.reduce(densities))

    def log_odds_of_columns(self, columns: Array) -> float:
        """Return log odds of columns (k, m) of standard deviation one."""
        gains = [_gain_of_columns(given, columns, self.problem.values) for given in self.each]
        return float(self.log_odds(np.array(gains)))

    def with_values(self, wrong: Explained, log_det: float, values: Array, free: Array | None = None) -> Suspect:
        """Return a mistake that turned values (m,) over the noise into what was read.

        log_det : log |det T|, less that of places; free : (k, m) columns of values that are any
        """
        prior, gains = math.log(PRIOR) + log_det, []
        for given in self.each:
            more = 0.0 if free is None else _gain_of_columns(given, free, values)
            gains.append((given.misfit - given.misfit_of(values)) / 2 + more)
        other = replace(self.problem, values=values)
        told = wrong._replace(log_odds=prior + float(self.log_odds(np.array(gains))))
        return Suspect(told, prior, partial(other.wider, np.zeros((0, len(values))) if free is None else free))

    def without(self, wrong: Explained, log_rest: float, mine: NDArray[np.bool_]) -> Suspect:
        """Return a mistake that left numbers (m,) without what the machine makes.  log_rest : log p of these"""
        rest, prior = self.problem.only(~mine), math.log(PRIOR) + log_rest
        told = -math.inf if log_rest == -math.inf else prior - _log_density_beside(self.each[0], rest)
        return Suspect(wrong._replace(log_odds=told), prior, lambda: rest)

    def as_another(self, wrong: Explained, other: Problem) -> Suspect:
        """Return a mistake without which the same readings are another problem."""
        here, there = (np.logaddexp.reduce([given.density for given in one.each]) for one in (self, Sought.of(other)))
        prior = math.log(PRIOR)
        return Suspect(wrong._replace(log_odds=prior + float(there - here)), prior, lambda: other)


def _log_density_beside(given: Given, others: Problem) -> float:
    """Return log p(yₛ | others) of the numbers that others lack, up to (2π)^(−s/2)."""
    without = space_of(others).given(given.theta)
    assert without is not None, "a covariance with noise is positive definite"
    return given.density - without.density


def _gain_of_columns(given: Given, columns: Array, values: Array) -> float:
    weighted = given.judged(columns.T)
    return float(_gains((columns @ weighted)[None], (values @ weighted)[None], [1.0])[0, 0])


def gains_of_steps(each: Sequence[Given], ways: Array, starts: NDArray[np.intp], stds: Sequence[float]) -> Array:
    """Return the gain of columns of each standard deviation that begin at each of some numbers, (n, s, r).

    Sums that grow take their place: m p + r p² operations and r p numbers, and not r m p and r m.
    each : of n sizes with the same noise; ways : (k, m) each from the first number on; starts : (r,) ascending
    """
    return np.array([_gains(*sums.to_the_end(), stds) for sums in sums_of(each, ways, starts)])


def _gains(fisher: Array, pulled: Array, stds: Sequence[float]) -> Array:
    """Return the gain of columns of each standard deviation, (s, r).  fisher : F (r, k, k); pulled : g (r, k)"""
    alone, gains = np.eye(pulled.shape[1]), np.empty((len(stds), len(pulled)))
    for k, size in enumerate(stds):
        solved = np.linalg.solve(fisher + size**-2 * alone, pulled[:, :, None])[:, :, 0]
        gains[k] = 0.5 * (np.sum(pulled * solved, axis=1) - np.linalg.slogdet(alone + size**2 * fisher)[1])
    return gains


def some_of(count: int, near: int | None = None) -> NDArray[np.intp]:
    """Return which of some places are looked at, coarse to fine: each of few, evenly many, or all about the best."""
    apart = -(-count // _AT_ONCE)
    return np.arange(0, count, apart) if near is None else np.arange(max(near - apart, 0), min(near + apart + 1, count))
