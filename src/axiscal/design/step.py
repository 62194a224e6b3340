"""The next measurement, exactly: over all set-ups, all axes that may move, and both directions of approach.

Where errors simply add up, every point of a fine lattice is a start; elsewhere the best candidates of a given lattice
are, after a sweep over a few positions in each interval. From the best ones the gain ΔJ = gᵀCWCg / (σ² + gᵀCg) is
climbed by Newton steps and maximised exactly along one joint after another, on every interval between knots (B&H
eq. 27; over all joints B&H eq. 37), until no joint improves it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.belief import Belief
from axiscal.design.climb import Climb
from axiscal.design.lattice import Lattice
from axiscal.design.scorer import Scorer
from axiscal.design.stacked import adds_up, starts
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array

_LATTICE_STARTS = 16
_MORE_STARTS = 48
_FEW_AXES = 3
_LOOKED_AT = 600
_APART = 0.12
_PEAKS = 32
_STACKED_PEAKS = 16
_SHARE = 0.92
_HOPEFUL = 0.97
_STACKED_EXACT = 1
_LATTICE_EXACT = 6
_FIRST_STEPS = 3


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


def best_step(observation: Observation, belief: Belief, weight: Array, lattice: Lattice) -> Step:
    """Return the reading with the largest fall of J = tr(VᵀV C).

    weight : V (w, n) over the leading unknowns; lattice : candidates to start from, at least one per set-up
    """
    return best_of(Scorer.of(observation, belief, weight), lattice)


def best_of(scorer: Scorer, lattice: Lattice) -> Step:
    """Return the reading with the largest gain of a scorer."""
    setups = [int(s) for s in np.unique(lattice.setups)]
    simple = [s for s in setups if adds_up(scorer.observation, s)]
    climbs = [_stacked(scorer, setup) for setup in simple]
    if len(simple) < len(setups):
        climbs += _from_lattice(scorer, lattice.within(np.isin(lattice.setups, simple, invert=True)))
    finalists = _finalists(climbs, [_STACKED_EXACT] * len(simple) + [_LATTICE_EXACT] * (len(climbs) - len(simple)))
    for climb in finalists:
        if len(climb.moves) > 1:
            climb.finish()
    return max((_step(climb) for climb in finalists), key=lambda step: step.gain)


def _stacked(scorer: Scorer, setup: int) -> Climb:
    """Return the peaks of a set-up that adds up; where one axis moves, its exact line needs no start."""
    if len(scorer.observation.setups[setup].moves) == 1:
        return _parked(scorer, setup)
    found = starts(scorer, setup)
    climb = Climb(scorer, setup, found.poses, found.approaches, found.gains)
    return climb.best(_STACKED_PEAKS, _SHARE, found.gains.max())


def _parked(scorer: Scorer, setup: int) -> Climb:
    mounted = scorer.observation.setups[setup]
    signs = np.array({"both": [1.0, -1.0], "+": [1.0], "-": [-1.0]}[mounted.approach])
    poses = np.tile(np.array(mounted.park), (len(signs), 1))
    approaches = np.zeros_like(poses)
    approaches[:, list(mounted.moves)] = signs[:, None]
    climb = Climb(scorer, setup, poses, approaches, np.zeros(len(signs)))
    climb.finish()
    return climb


def _from_lattice(scorer: Scorer, lattice: Lattice) -> list[Climb]:
    """Return the best candidates, each set-up with at least one, after a sweep."""
    gains = scorer.gains(lattice)
    chosen = _scattered(scorer.observation, lattice, gains)
    climbs = []
    for setup in np.unique(lattice.setups[chosen]):
        mine = chosen[lattice.setups[chosen] == setup]
        climb = Climb(scorer, int(setup), lattice.poses[mine], lattice.approaches[mine], gains[mine])
        for _ in range(2 if len(climb.moves) <= _FEW_AXES else 1):
            climb.sweep_lattice()
        climbs.append(climb)
    return climbs


def _scattered(observation: Observation, lattice: Lattice, gains: Array) -> NDArray[np.intp]:
    """Return good candidates that do not stand close together, and the best of every set-up."""
    spans = np.array([axis.length for axis in observation.errors.machine.axes])
    order = np.argsort(-gains, kind="stable")
    _, firsts = np.unique(lattice.setups[order], return_index=True)
    chosen = list(order[firsts])
    few = max(len(s.moves) for s in observation.setups) <= _FEW_AXES
    wanted = (_MORE_STARTS if few else _LATTICE_STARTS) + len(firsts)
    for i in order[:_LOOKED_AT]:
        same = [k for k in chosen if lattice.setups[k] == lattice.setups[i]]
        apart = np.abs(lattice.poses[same] - lattice.poses[i]) / spans
        if len(chosen) < wanted and np.all(apart.max(axis=1, initial=0.0) > _APART):
            chosen.append(i)
    return np.array(chosen, dtype=np.intp)


def _finalists(climbs: list[Climb], counts: list[int]) -> list[Climb]:
    """Return the distinct best after Newton's steps, few enough for exact lines."""
    best = max(climb.gains.max() for climb in climbs)
    kept = [(climb.distinct().best(_PEAKS, _SHARE, best), count) for climb, count in zip(climbs, counts, strict=True)]
    kept = [(climb, count) for climb, count in kept if len(climb.gains)]
    for climb, _ in kept:
        if len(climb.moves) > 1:
            climb.newton(_FIRST_STEPS)
    best = max(climb.gains.max() for climb, _ in kept)
    final = [climb.distinct().best(count, _HOPEFUL, best) for climb, count in kept]
    return [climb for climb in final if len(climb.gains)]


def _step(climb: Climb) -> Step:
    best = int(climb.gains.argmax())
    pose, approach = climb.poses[best], climb.approaches[best]
    seen = climb.scorer.observation.rows(climb.setup, pose[None], approach[None])
    above, below = climb.scorer.forms(climb.setup, pose[None], approach[None])
    return Step(climb.setup, pose, approach, float(above[0] / below[0]), float(seen.variances[0]), seen.rows[0])
