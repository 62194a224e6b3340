"""Climbing to the best reading: along each coordinate by looks and exactly, along all at once by Newton's step.

A coordinate is an axis that moves, or one of a chart (`ground`).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.numerics.line import largest_along
from axiscal.numerics.ties import TIE, first_best_each, ranked, scattered, surely_more
from axiscal.planning.gains.gain import Scorer
from axiscal.planning.step.ground import Ground, ground_of, places_along

_ROUNDS = 60
"""Rounds end where none rises; this only ends what would go round."""
_IMPROVED = 1e-10
"""Rounding of a gain, with room."""
_NEWTON = 40
"""Newton's step ends where it gains nothing; this only ends what would go round."""
_SETTLED = 1e-9
"""Newton's step converges quadratically: what is left after a rise of this share is below rounding."""
_SHORTER = np.array([0.5, 0.25, 0.1, 0.03, 0.01, 0.001])
"""Shorter steps that are tried where the whole one does not rise; any shrinking row will do."""
_APART = 1e-5
"""Share of the travel: climbs that end nearer are one."""
_STEP = 3e-5
"""A share of the travel: second differences keep six digits, of rounding (1e-16/h²) and of bending (h²)."""


@dataclass(eq=False, slots=True)
class Climb:
    """Several readings of one set-up on their way up.

    places, sides : (n, size) u and from where they are come to, gains : (n,), all changed in place
    """

    scorer: Scorer
    setup: int
    ground: Ground
    places: Array
    sides: Array
    gains: Array

    @classmethod
    def begun(cls, scorer: Scorer, setup: int, poses: Array, approaches: Array, gains: Array | None = None) -> Climb:
        """Return the climb from readings.  poses, approaches : (n, q); gains : (n,) where they are known"""
        ground = ground_of(scorer.observation, setup)
        climb = cls(scorer, setup, ground, *ground.as_places(poses, approaches), np.zeros(len(poses)))
        climb.gains = climb._gains(climb.places, climb.sides) if gains is None else gains
        return climb

    @property
    def readings(self) -> tuple[Array, Array]:
        """Poses and approaches, (n, q) each."""
        return self.ground.as_poses(self.places, self.sides)

    def keep(self, chosen: NDArray[np.bool_] | NDArray[np.intp]) -> Climb:
        """Return the climb of the chosen ones."""
        parts = self.places[chosen], self.sides[chosen], self.gains[chosen]
        return Climb(self.scorer, self.setup, self.ground, *parts)

    def best(self, count: int, share: float, than: float) -> Climb:
        """Return the best `count` that gain at least a share of `than`."""
        order = ranked(self.gains, TIE, count)
        return self.keep(order[self.gains[order] >= share * than - TIE * abs(than)])

    def scattered(self, count: int, apart: float) -> Climb:
        """Return the best, no two of them closer than a share of every travel.  apart : share"""
        return self.keep(np.sort(scattered(self._shares, ranked(self.gains, TIE), count, apart)))

    def distinct(self) -> Climb:
        """Return the climb without those that stand where a better one stands."""
        order = ranked(self.gains, TIE)
        poses, sides = self._shares[order], self.sides[order][:, self.ground.sided]
        near = np.all(np.abs(poses[:, None] - poses) <= _APART, axis=2) & np.all(sides[:, None] == sides, axis=2)
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

    @property
    def _shares(self) -> Array:
        """Positions of the axes in lengths of their travel, (n, q)."""
        spans = np.array([axis.length for axis in self.scorer.observation.machine.axes])
        shares: Array = self.readings[0] / spans
        return shares

    def _gains(self, places: Array, sides: Array) -> Array:
        """Return the gains at places, (m,); −∞ where no reading can be taken."""
        taken = self.ground.approachable(places, sides)
        if taken is None:
            return self.scorer.gains_at(self.setup, *self.ground.as_poses(places, sides))
        gains = np.full(len(places), -np.inf)
        if taken.any():
            gains[taken] = self.scorer.gains_at(self.setup, *self.ground.as_poses(places[taken], sides[taken]))
        return gains

    def _gains_at(self, numbers: list[int], values: Array, going: NDArray[np.intp]) -> Array:
        """Return gains (g, p) where some coordinates have other values.  values : (g, p, numbers)"""
        count, tries, _ = values.shape
        owner = np.repeat(going, tries)
        places = self.places[owner]
        places[:, numbers] = values.reshape(count * tries, len(numbers))
        return self._gains(places, self.sides[owner]).reshape(count, tries)

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

    def finish(self) -> None:
        """Climb on from where neither steps nor looks lead higher, until no coordinate does, alone and exactly."""
        for _ in range(_ROUNDS):
            before = self.gains.copy()
            self.exactly()
            if np.all(self.gains <= before * (1 + _SETTLED)):
                return
            self.uphill()

    def exactly(self) -> None:
        """Move each reading along one continuous coordinate after another to the best on its line (B&H eq. 27, 37)."""
        for i, number in itertools.product(range(len(self.places)), self.ground.continuous):
            place, side = self.places[i].copy(), self.sides[i]

            def forms(
                values: Array, place: Array = place, side: Array = side, number: int = number
            ) -> tuple[Array, Array]:
                places = places_along(place, number, values.ravel())
                poses = self.ground.as_poses(places, np.tile(side, (len(places), 1)))
                return self.scorer.gain_forms(self.setup, *poses)

            pieces = self.ground.pieces(number, place, side)
            if len(pieces):
                there, gain = largest_along(forms, pieces, self.ground.nodes(number), float(self.gains[i]))
                if gain > self.gains[i]:
                    self.places[i, number], self.gains[i] = there, gain

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
        gains = self._gains(np.repeat(self.places, len(sided), axis=0), turned.reshape(-1, size)).reshape(count, -1)
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
