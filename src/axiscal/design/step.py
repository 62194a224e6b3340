"""The next measurement, exactly: over all set-ups, all axes that may move, and both directions of approach.

A lattice of candidates is scored; from the best distinct ones the gain ΔJ = gᵀCWCg / (σ² + gᵀCg) is maximised exactly
along one joint after another, on every interval between knots (B&H eq. 27; over all joints B&H eq. 37), until no
joint improves it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.belief import Belief
from axiscal.design.lattice import Lattice, raster_range
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array
from axiscal.numerics.chebyshev import node_count
from axiscal.numerics.exact_step import gain_forms, maximise_along

_STARTS = 4
_HOPEFUL = 0.97
_SWEEPS = 40
_IMPROVED = 1e-10


@dataclass(frozen=True, eq=False, slots=True)
class Step:
    """The reading that gains most.

    setup : index; pose, approach : (q,); gain : fall of J; variance : of the reading's noise and fresh rests
    row : (size,) what the reading sees
    """

    setup: int
    pose: Array
    approach: Array
    gain: float
    variance: float
    row: Array


@dataclass(frozen=True, eq=False, slots=True)
class Scorer:
    """Gains under one belief.  factor : F with C = F Fᵀ; weighted : V F."""

    observation: Observation
    factor: Array
    weighted: Array

    @classmethod
    def of(cls, observation: Observation, belief: Belief, weight: Array) -> Scorer:
        """Return the scorer of a belief.  weight : V (w, n) over the leading n unknowns."""
        factor = belief.factor
        return cls(observation, factor, weight @ factor[: weight.shape[1]])

    def forms(self, setup: int, poses: Array, approaches: Array) -> tuple[Array, Array]:
        """Return numerator and denominator of the gain.  poses, approaches : (m, q)."""
        seen = self.observation.rows(setup, poses, approaches)
        return gain_forms(seen.rows, self.factor, self.weighted, seen.variances)

    def gains(self, lattice: Lattice) -> Array:
        """Return the gain of every candidate, (m,)."""
        result = np.empty(len(lattice))
        for setup in np.unique(lattice.setups):
            above, below = self.forms(int(setup), *lattice.of(int(setup)))
            result[lattice.setups == setup] = above / below
        return result


def best_step(observation: Observation, belief: Belief, weight: Array, lattice: Lattice) -> Step:
    """Return the reading with the largest fall of J = tr(VᵀV C).

    weight : V (w, n) over the leading unknowns; lattice : candidates to start from, at least one per set-up
    """
    scorer = Scorer.of(observation, belief, weight)
    gains = scorer.gains(lattice)
    climbs = [_Climb.begin(scorer, lattice, picks, gains[picks]) for picks in _starts(lattice, gains)]
    best = max(climb.gains.max() for climb in climbs)
    hopeful = [climb for climb in climbs if climb.drop_below(_HOPEFUL * best)]
    return max((climb.finish() for climb in hopeful), key=lambda step: step.gain)


def _starts(lattice: Lattice, gains: Array) -> list[NDArray[np.intp]]:
    """Return the best candidates, grouped by set-up; each set-up has at least one."""
    order = np.argsort(-gains, kind="stable")
    _, firsts = np.unique(lattice.setups[order], return_index=True)
    chosen = np.unique(np.concatenate([order[firsts], order[:_STARTS]]))
    return [chosen[lattice.setups[chosen] == setup] for setup in np.unique(lattice.setups[chosen])]


@dataclass(eq=False, slots=True)
class _Climb:
    """Coordinate ascent of several starts of one set-up at once; one sweep is done at the beginning."""

    scorer: Scorer
    setup: int
    poses: Array
    approaches: Array
    gains: Array

    @classmethod
    def begin(cls, scorer: Scorer, lattice: Lattice, picks: NDArray[np.intp], gains: Array) -> _Climb:
        setup = int(lattice.setups[picks[0]])
        climb = cls(scorer, setup, lattice.poses[picks], lattice.approaches[picks], gains)
        climb.sweep()
        return climb

    @property
    def moves(self) -> tuple[int, ...]:
        return self.scorer.observation.setups[self.setup].moves

    def sweep(self) -> None:
        for axis in self.moves:
            self.gains = _along(self.scorer, self.setup, axis, self.poses, self.approaches, self.gains)
            self.gains = _turned(self.scorer, self.setup, axis, self.poses, self.approaches, self.gains)

    def drop_below(self, gain: float) -> bool:
        """Keep the starts that gain as much; return whether any is left."""
        keep = self.gains >= gain
        self.poses, self.approaches, self.gains = self.poses[keep], self.approaches[keep], self.gains[keep]
        return bool(keep.any())

    def finish(self) -> Step:
        """Sweep until no joint improves, and return the best."""
        for _ in range(_SWEEPS if len(self.moves) > 1 else 0):
            before = self.gains
            self.sweep()
            if np.all(self.gains <= before * (1 + _IMPROVED)):
                break
        best = int(self.gains.argmax())
        pose, approach = self.poses[best], self.approaches[best]
        seen = self.scorer.observation.rows(self.setup, pose[None], approach[None])
        return Step(self.setup, pose, approach, float(self.gains[best]), float(seen.variances[0]), seen.rows[0])


def _turned(scorer: Scorer, setup: int, axis: int, poses: Array, approaches: Array, gains: Array) -> Array:
    """Approach from the other side where that gains more; poses and approaches are changed in place."""
    if scorer.observation.setups[setup].approach != "both":
        return gains
    other = approaches.copy()
    other[:, axis] *= -1
    above, below = scorer.forms(setup, poses, other)
    better = above / below > gains
    approaches[better, axis] *= -1
    return np.where(better, above / below, gains)


def _along(scorer: Scorer, setup: int, axis: int, poses: Array, approaches: Array, gains: Array) -> Array:
    """Move every pose to the best coordinate of one axis; poses are changed in place."""
    if scorer.observation.setups[setup].raster[axis] > 0:
        found, value = _on_raster(scorer, setup, axis, poses, approaches)
    else:
        found, value = _continuous(scorer, setup, axis, poses, approaches)
    better = value > gains
    poses[better, axis] = found[better]
    return np.where(better, value, gains)


def _continuous(scorer: Scorer, setup: int, axis: int, poses: Array, approaches: Array) -> tuple[Array, Array]:
    breaks = scorer.observation.breaks(axis)
    lines, count = len(poses), len(breaks) - 1
    line = np.repeat(np.arange(lines), count)

    def forms(position: Array, interval: NDArray[np.intp]) -> tuple[Array, Array]:
        base = np.repeat(line[interval], position.shape[1])
        at = poses[base]
        at[:, axis] = position.ravel()
        above, below = scorer.forms(setup, at, approaches[base])
        return above.reshape(position.shape), below.reshape(position.shape)

    nodes = node_count(*scorer.observation.smoothness(axis))
    left, right = np.tile(breaks[:-1], lines), np.tile(breaks[1:], lines)
    position, value = maximise_along(forms, left, right, nodes, line)
    best = np.arange(lines) * count + value.reshape(lines, count).argmax(axis=1)
    return position[best], value[best]


def _on_raster(scorer: Scorer, setup: int, axis: int, poses: Array, approaches: Array) -> tuple[Array, Array]:
    first, last = raster_range(scorer.observation.errors.machine, scorer.observation.setups[setup], axis)
    steps = np.arange(first, last + 1) * scorer.observation.setups[setup].raster[axis]
    at = np.repeat(poses, len(steps), axis=0)
    at[:, axis] = np.tile(steps, len(poses))
    above, below = scorer.forms(setup, at, np.repeat(approaches, len(steps), axis=0))
    gain = (above / below).reshape(len(poses), len(steps))
    best = gain.argmax(axis=1)
    return steps[best], gain[np.arange(len(poses)), best]
