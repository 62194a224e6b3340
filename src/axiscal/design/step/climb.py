"""Climbing to the best reading: along one axis exactly, along all of them at once by Newton's step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.gain import Scorer
from axiscal.design.step.line_bundle import LineBundle
from axiscal.design.step.lines import Lines, SampledLines, lines_along
from axiscal.design.step.newton_step import ascent, derivatives, stencil
from axiscal.measurement.breaks import breaks_along, smoothness_along
from axiscal.measurement.candidates import knot_lattice, raster_positions
from axiscal.numerics import Array
from axiscal.numerics.chebyshev import node_count
from axiscal.numerics.exact_step import maximise_along
from axiscal.numerics.ties import TIE, first_best_each, ranked, surely_more

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
_INNER = 4
"""Points an interval where a climb begins along an axis; the best of them is then made exact."""


@dataclass(eq=False, slots=True)
class Climb:
    """Several readings of one set-up on their way up.

    poses, approaches : (n, q), changed in place; gains : (n,)
    """

    scorer: Scorer
    setup: int
    poses: Array
    approaches: Array
    gains: Array

    @property
    def moves(self) -> tuple[int, ...]:
        """The axes that may move."""
        return self.scorer.observation.setups[self.setup].moves

    def keep(self, chosen: NDArray[np.bool_] | NDArray[np.intp]) -> Climb:
        """Return the climb of the chosen ones."""
        return Climb(self.scorer, self.setup, self.poses[chosen], self.approaches[chosen], self.gains[chosen])

    def best(self, count: int, share: float, than: float) -> Climb:
        """Return the best `count` that gain at least a share of `than`."""
        order = ranked(self.gains, TIE, count)
        return self.keep(order[self.gains[order] >= share * than - TIE * abs(than)])

    def scattered(self, count: int, apart: float) -> Climb:
        """Return the best, no two of them closer than a share of every travel.  apart : share"""
        spans = np.array([axis.length for axis in self.scorer.observation.machine.axes])
        order = ranked(self.gains, TIE)
        chosen = np.zeros(len(order), dtype=bool)
        for i in order:
            if chosen.sum() < count and not _near(self.poses[chosen], self.poses[i], apart * spans):
                chosen[i] = True
        return self.keep(chosen)

    def distinct(self) -> Climb:
        """Return the climb without those that stand where a better one stands."""
        spans = np.array([axis.length for axis in self.scorer.observation.machine.axes])
        order = ranked(self.gains, TIE)
        poses, approaches = self.poses[order] / spans, self.approaches[order]
        near = np.all(np.abs(poses[:, None] - poses) <= _APART, axis=2) & np.all(
            approaches[:, None] == approaches, axis=2
        )
        return self.keep(order[~np.any(np.tril(near, -1), axis=1)])

    def sweep_lattice(self) -> None:
        """Move every axis once to the best of a few positions in each interval."""
        for axis in self.moves:
            positions = self._positions(axis)
            above, below = self._lines(axis).on(positions)
            ratio = above / below
            best = first_best_each(ratio, TIE)
            self._move(axis, positions[best], ratio[np.arange(len(best)), best])
            self._turn(axis)

    def sweep(self) -> None:
        """Move every axis once to the exact best on its line (B&H eq. 27): a narrow ridge is not missed."""
        for axis in self.moves:
            found = self._on_raster(axis) if self._raster(axis) else self._exactly([axis])[0][1:]
            self._move(axis, *found)
            self._turn(axis)

    def finish(self) -> None:
        """Climb until no axis improves any of them, alone and exactly (B&H eq. 27)."""
        for _ in range(_ROUNDS):
            if len(self.moves) > 1:
                self.newton(_NEWTON)
            before = self.gains.copy()
            self._move_best_axis()
            if len(self.moves) == 1 or np.all(self.gains <= before * (1 + _IMPROVED)):
                return

    def newton(self, steps: int) -> None:
        """Move all continuous axes at once, by damped Newton steps with differences for derivatives."""
        axes = [k for k in self.moves if not self.scorer.observation.setups[self.setup].raster[k] > 0]
        if not axes or not len(self.poses):
            return
        observation = self.scorer.observation
        mounted, machine = observation.setups[self.setup], observation.machine
        ends = np.array([mounted.span(machine.axes[k], k) for k in axes])
        going = np.arange(len(self.poses))
        for _ in range(steps):
            if not len(going):
                return
            gained = self._newton_step(axes, ends, going)
            going = going[gained > _SETTLED * self.gains[going]]

    def _newton_step(self, axes: list[int], ends: Array, going: NDArray[np.intp]) -> Array:
        """Return by how much the gains of those on the way have risen."""
        here, spans = self.poses[going][:, axes], np.diff(ends).ravel()
        offsets = stencil(len(axes))
        values = self._gains_at(axes, here[:, None] + offsets * spans, going)
        slope, bend = derivatives(values, len(axes))
        steps = ascent(slope, bend, (here - ends[:, 0]) / spans)
        promised, steps = np.einsum("nk,nk->n", slope, steps), steps * spans
        rise = self._try(axes, np.clip(here + steps, *ends.T)[:, None], going)
        short = np.flatnonzero((rise <= 0) & (promised > _SETTLED * self.gains[going]))
        if len(short):
            tries = np.clip(here[short, None] + _SHORTER[:, None] * steps[short, None], *ends.T)
            rise[short] = self._try(axes, tries, going[short])
        return rise

    def _try(self, axes: list[int], tries: Array, going: NDArray[np.intp]) -> Array:
        """Go to the best of several positions (n, p, axes) each where it gains more; return by how much it does."""
        gains = self._gains_at(axes, tries, going)
        best = first_best_each(gains, TIE)
        found, gain = tries[np.arange(len(going)), best], gains[np.arange(len(going)), best]
        rise: Array = gain - self.gains[going]
        better = rise > 0
        self.poses[going[better][:, None], axes] = found[better]
        self.gains[going[better]] = gain[better]
        return rise

    def _gains_at(self, axes: list[int], positions: Array, going: NDArray[np.intp]) -> Array:
        """Return gains (n, p) where some axes stand elsewhere.  positions : (n, p, axes)."""
        count, tries, _ = positions.shape
        poses = np.repeat(self.poses[going], tries, axis=0)
        poses[:, axes] = positions.reshape(count * tries, -1)
        approaches = np.repeat(self.approaches[going], tries, axis=0)
        return self.scorer.at(self.setup, poses, approaches).reshape(count, tries)

    def _move(self, axis: int, positions: Array, gains: Array) -> None:
        better = gains > self.gains
        self.poses[better, axis] = positions[better]
        self.gains = np.where(better, gains, self.gains)

    def _turn(self, axis: int) -> None:
        """Approach from the other side where that gains more."""
        observation = self.scorer.observation
        if len(observation.setups[self.setup].sides) == 1 or axis not in observation.errors.reversing:
            return
        other = self.approaches.copy()
        other[:, axis] *= -1
        gains = self.scorer.at(self.setup, self.poses, other)
        better = surely_more(gains, self.gains, TIE)
        self.approaches[better, axis] *= -1
        self.gains = np.where(better, gains, self.gains)

    def _lines(self, axis: int) -> Lines | SampledLines:
        return lines_along(self.scorer, self.setup, axis, self.poses, self.approaches)

    def _positions(self, axis: int) -> Array:
        observation = self.scorer.observation
        mounted, machine = observation.setups[self.setup], observation.machine
        if mounted.raster[axis] > 0:
            return raster_positions(machine, mounted, axis)
        return knot_lattice(observation, self.setup, axis, _INNER)

    def _move_best_axis(self) -> None:
        """Look along every axis exactly, and move the one that gains most."""
        poses, gains, there = self.poses, np.full(len(self.poses), -np.inf), np.zeros(len(self.poses))
        which = np.zeros(len(self.poses), dtype=np.intp)
        continuous = [k for k in self.moves if not self._raster(k)]
        found = [(k, *self._on_raster(k)) for k in self.moves if self._raster(k)]
        if continuous:
            found += self._exactly(continuous)
        for axis, position, gain in found:
            better = surely_more(gain, gains, TIE)
            which[better], there[better], gains[better] = axis, position[better], gain[better]
        better = gains > self.gains
        poses[better, which[better]] = there[better]
        self.gains = np.where(better, gains, self.gains)
        for axis in self.moves:
            self._turn(axis)

    def _raster(self, axis: int) -> bool:
        return self.scorer.observation.setups[self.setup].raster[axis] > 0

    def _on_raster(self, axis: int) -> tuple[Array, Array]:
        positions = self._positions(axis)
        above, below = self._lines(axis).on(positions)
        ratio = above / below
        best = first_best_each(ratio, TIE)
        return positions[best], ratio[np.arange(len(best)), best]

    def _exactly(self, axes: list[int]) -> list[tuple[int, Array, Array]]:
        """Return the best position on the line through every pose along each axis, and the gain there.

        All lines are one search. An axis on which nothing better can be found for a pose may come out a little low.
        """
        observation, count = self.scorer.observation, len(self.poses)
        breaks = [breaks_along(observation, k, self.setup) for k in axes]
        bundle = LineBundle([self._lines(k) for k in axes], breaks, count)
        degree = max(node_count(*smoothness_along(observation, k, self.setup)) for k in axes)
        position, value = maximise_along(bundle.forms, bundle.left, bundle.right, degree, bundle.pose)
        return [(axis, *bundle.best(i, position, value)) for i, axis in enumerate(axes)]


def _near(poses: Array, pose: Array, reach: Array) -> bool:
    return bool(np.any(np.all(np.abs(poses - pose) <= reach, axis=1)))
