"""Climbing to the best reading: along each coordinate by looks, along all at once by Newton's step.

A coordinate is an axis that moves, or whatever else a place has.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from axiscal_core.refusals import Array
from axiscal_core.ties import TIE, first_best_each, ranked, surely_more

_ROUNDS = 60  # rounds end where none rises; this only ends what would go round
_IMPROVED = 1e-10  # rounding of a gain, with room
_NEWTON = 40  # Newton's step ends where it gains nothing; this only ends what would go round
_SETTLED = 1e-9  # Newton's step converges quadratically: what is left after a rise of this share is below rounding
_SHORTER = np.array([0.5, 0.25, 0.1, 0.03, 0.01, 0.001])
"""Shorter steps that are tried where the whole one does not rise; any shrinking row will do."""
_APART = 1e-5  # share of the travel: climbs that end nearer are one
_STEP = 3e-5  # a share of the travel: second differences keep six digits, of rounding (1e-16/h²) and of bending (h²)


class Ground(Protocol):
    """What may change between readings: coordinates u, and from which side each is come to, +1 or −1."""

    @property
    def ends(self) -> Array:
        """From where to where each coordinate goes, (size, 2)."""

    @property
    def spans(self) -> Array:
        """The travel of every axis of the machine, (q,)."""

    @property
    def continuous(self) -> list[int]:
        """The coordinates without steps."""

    @property
    def sided(self) -> NDArray[np.intp]:
        """The coordinates that may be come to from either side, where it shows in what is read from which."""

    def as_poses(self, places: Array, sides: Array) -> tuple[Array, Array]:
        """Return poses and approaches, (m, q) each.  places, sides : (m, size)"""

    def looks(self, number: int) -> Array:
        """Return a few values all along a coordinate, or all that it has, (p,)."""


Gained = Callable[[Array, Array], Array]
"""Places and sides (m, size) -> gains (m,), −∞ where no reading can be taken."""


@dataclass(eq=False, slots=True)
class Climb:
    """Several readings on their way up.

    places, sides : (n, size) u and from where they are come to, gains : (n,), all changed in place
    """

    ground: Ground
    gained: Gained
    places: Array
    sides: Array
    gains: Array

    @classmethod
    def begun(cls, ground: Ground, gained: Gained, places: Array, sides: Array) -> Climb:
        """Return the climb from readings.  places, sides : (n, size)"""
        return cls(ground, gained, places, sides, gained(places, sides))

    @property
    def readings(self) -> tuple[Array, Array]:
        """Poses and approaches, (n, q) each."""
        return self.ground.as_poses(self.places, self.sides)

    def keep(self, chosen: NDArray[np.bool_] | NDArray[np.intp]) -> Climb:
        """Return the climb of the chosen ones."""
        return Climb(self.ground, self.gained, self.places[chosen], self.sides[chosen], self.gains[chosen])

    def best(self, count: int, share: float, than: float) -> Climb:
        """Return the best `count` that gain at least a share of `than`."""
        order = ranked(self.gains, TIE, count)
        return self.keep(order[self.gains[order] >= share * than - TIE * abs(than)])

    def distinct(self) -> Climb:
        """Return the climb without those that stand where a better one stands."""
        order = ranked(self.gains, TIE)
        shares, sides = self.readings[0][order] / self.ground.spans, self.sides[order][:, self.ground.sided]
        near = np.all(np.abs(shares[:, None] - shares) <= _APART, axis=2) & np.all(sides[:, None] == sides, axis=2)
        return self.keep(order[~np.any(np.tril(near, -1), axis=1)])

    def newton(self, steps: int) -> None:
        """Move all continuous coordinates at once, by damped Newton steps with differences for derivatives."""
        numbers, ends = self.ground.continuous, self.ground.ends
        going = np.arange(len(self.places))
        for _ in range(steps if numbers else 0):
            if not len(going):
                return
            gained = self._newton_step(numbers, ends[numbers], going)
            going = going[gained > _SETTLED * self.gains[going]]

    def _gains_at(self, numbers: list[int], values: Array, going: NDArray[np.intp]) -> Array:
        """Return gains (g, p) where some coordinates have other values.  values : (g, p, numbers)"""
        count, tries, _ = values.shape
        owner = np.repeat(going, tries)
        places = self.places[owner]
        places[:, numbers] = values.reshape(count * tries, len(numbers))
        return self.gained(places, self.sides[owner]).reshape(count, tries)

    def _newton_step(self, numbers: list[int], ends: Array, going: NDArray[np.intp]) -> Array:
        """Return by how much the gains of those on the way have risen; those beside what cannot be taken stay."""
        here, spans, rise = self.places[going][:, numbers], np.diff(ends).ravel(), np.zeros(len(going))
        values = self._gains_at(numbers, here[:, None] + stencil(len(numbers)) * spans, going)
        free = np.flatnonzero(np.all(np.isfinite(values), axis=1))
        here, going, values = here[free], going[free], values[free]
        slope, bend = derivatives(values, len(numbers))
        steps = ascent(slope, bend, (here - ends[:, 0]) / spans)
        promised, steps = np.einsum("nk,nk->n", slope, steps), steps * spans
        risen = self._try(numbers, np.clip(here + steps, *ends.T)[:, None], going)
        short = np.flatnonzero((risen <= 0) & (promised > _SETTLED * self.gains[going]))
        if len(short):
            tries = np.clip(here[short, None] + _SHORTER[:, None] * steps[short, None], *ends.T)
            risen[short] = self._try(numbers, tries, going[short])
        rise[free] = risen
        return rise

    def _try(self, numbers: list[int], tries: Array, going: NDArray[np.intp]) -> Array:
        """Go to the best of several values (g, p, numbers) each where it gains more; return by how much it does."""
        gains = self._gains_at(numbers, tries, going)
        best = first_best_each(gains, TIE)
        found, gain = tries[np.arange(len(going)), best], gains[np.arange(len(going)), best]
        rise: Array = gain - self.gains[going]
        better = rise > 0
        self.places[going[better][:, None], numbers] = found[better]
        self.gains[going[better]] = gain[better]
        return rise

    def uphill(self) -> None:
        """Climb by Newton's steps, and by looks along every coordinate, until neither leads higher."""
        for _ in range(_ROUNDS):
            self.newton(_NEWTON)
            before = self.gains.copy()
            self._move([self._looked(number) for number in range(len(self.ground.ends))])
            self._turn()
            if np.all(self.gains <= before * (1 + _IMPROVED)):
                return

    def _looked(self, number: int) -> tuple[int, Array, Array]:
        """Return a coordinate, the best of a few of its values for each reading, and the gain there."""
        values, every = self.ground.looks(number), np.arange(len(self.places))
        gains = self._gains_at([number], np.broadcast_to(values[:, None], (len(every), len(values), 1)), every)
        best = first_best_each(gains, TIE)
        return number, values[best], gains[every, best]

    def _move(self, found: list[tuple[int, Array, Array]]) -> None:
        """Move of each reading the one coordinate that gains most.  found : coordinates, values (n,), gains (n,)"""
        best = np.full(len(self.gains), -np.inf)
        which, there = np.zeros(len(best), dtype=np.intp), np.zeros(len(best))
        for number, values, gains in found:
            better = surely_more(gains, best, TIE)
            which[better], there[better], best[better] = number, values[better], gains[better]
        better = best > self.gains
        self.places[better, which[better]] = there[better]
        self.gains = np.where(better, best, self.gains)

    def _turn(self) -> None:
        """Come to one coordinate from the other side where that gains more."""
        count, size, sided = *self.places.shape, self.ground.sided
        if not len(sided):
            return
        turned = np.tile(self.sides[:, None], (1, len(sided), 1))
        turned[:, np.arange(len(sided)), sided] *= -1
        gains = self.gained(np.repeat(self.places, len(sided), axis=0), turned.reshape(-1, size)).reshape(count, -1)
        every, best = np.arange(count), first_best_each(gains, TIE)
        better = surely_more(gains[every, best], self.gains, TIE)
        self.sides[better], self.gains[better] = turned[every, best][better], gains[every, best][better]


def stencil(size: int) -> Array:
    """Return the offsets at which the second-order Taylor polynomial is read off, in shares of the travel, (p, size).

    0, ±e_i, ±(e_i + e_j), times a small step.
    """
    unit = np.eye(size)
    pairs = [unit[i] + unit[j] for i, j in itertools.combinations(range(size), 2)]
    return _STEP * np.array([np.zeros(size), *unit, *-unit, *pairs, *(-p for p in pairs)])


def derivatives(values: Array, size: int) -> tuple[Array, Array]:
    """Return gradient (n, size) and Hessian (n, size, size) from the values (n, p) on the stencil."""
    middle, up, down = values[:, 0], values[:, 1 : size + 1], values[:, size + 1 : 2 * size + 1]
    pairs = values[:, 2 * size + 1 :]
    half = pairs.shape[1] // 2
    bend = np.zeros((len(values), size, size))
    bend[:, np.arange(size), np.arange(size)] = up + down - 2 * middle[:, None]
    for p, (i, j) in enumerate(itertools.combinations(range(size), 2)):
        single = up[:, i] + down[:, i] + up[:, j] + down[:, j]
        mixed = (pairs[:, p] + pairs[:, half + p] - single + 2 * middle) / 2
        bend[:, i, j] = bend[:, j, i] = mixed
    return (up - down) / (2 * _STEP), bend / _STEP**2


def ascent(slope: Array, bend: Array, share: Array) -> Array:
    """Return Newton's steps (n, size) towards a maximum; an axis at its end that would leave is held.

    share : (n, size) of the travel, 0 and 1 at its ends. Directions that bend upwards are followed uphill all the same.
    """
    held = ((share <= 0) & (slope < 0)) | ((share >= 1) & (slope > 0))
    free = ~held
    bend = np.where(free[:, :, None] & free[:, None, :], bend, 0.0)
    slope = np.where(free, slope, 0.0)
    values, vectors = np.linalg.eigh(bend)
    turned = np.einsum("nij,ni->nj", vectors, slope)
    along = turned / np.maximum(np.abs(values), 1e-12 * np.abs(values).max(axis=1, keepdims=True) + 1e-300)
    steps: Array = np.einsum("nij,nj->ni", vectors, along)
    return np.clip(steps, -0.2, 0.2)
