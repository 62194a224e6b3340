"""The next measurement, exactly: over all set-ups, all axes that may move, and both directions of approach.

Where errors simply add up, every point of a fine lattice is a start; elsewhere the best candidates of a given lattice
are, after a sweep over a few positions in each interval. From the best ones the gain ΔJ = gᵀCWCg / (σ² + gᵀCg) is
climbed by Newton steps and maximised exactly along one joint after another, on every interval between knots (B&H
eq. 27; over all joints B&H eq. 37), until no joint improves it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.belief import Belief
from axiscal.design.climb import Climb
from axiscal.design.dense import dense_starts
from axiscal.design.lattice import Lattice
from axiscal.design.scorer import Scorer
from axiscal.design.stacked import adds_up, starts
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array
from axiscal.numerics.exact_step import gain_forms

_APART = 0.12
_STARTS = 16
_LOOKED_AT = 400
_FIRST_STEPS = 3


@dataclass(frozen=True, slots=True)
class _Effort:
    """How hard to look, so that no narrow ridge is missed.

    peaks, share : so many go on to Newton's steps, if they gain at least this share of the best
    exact, hopeful : so many of these go on to exact lines, if they gain at least this share of the best
    """

    peaks: int
    share: float
    exact: int
    hopeful: float


_STACKED = _Effort(24, 0.92, 8, 1 - 1e-5)
_FEW_AXES = _Effort(240, 0.5, 40, 0.75)
_MANY_AXES = _Effort(32, 0.92, 6, 0.97)


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
    """Return the reading with the largest fall of J = tr(VᵀV C) (B&H eq. 37).

    weight : V (w, n) over the leading unknowns; lattice : candidates to start from, at least one per set-up
    """
    return best_of(Scorer.of(observation, belief, weight), lattice)


def best_of(scorer: Scorer, lattice: Lattice) -> Step:
    """Return the reading with the largest gain of a scorer."""
    efforts = {int(s): _effort(scorer.observation, int(s)) for s in np.unique(lattice.setups)}
    climbs = [_prepared(scorer, setup, effort) for setup, effort in efforts.items() if effort is not _MANY_AXES]
    others = np.isin(lattice.setups, [setup for setup, effort in efforts.items() if effort is _MANY_AXES])
    if others.any():
        climbs += _from_lattice(scorer, lattice.within(others))
    finalists = _finalists(climbs)
    for climb in finalists:
        if len(climb.moves) > 1:
            climb.finish()
    return max((_step(climb) for climb in finalists), key=lambda step: step.gain)


def _effort(observation: Observation, setup: int) -> _Effort:
    if adds_up(observation, setup):
        return _STACKED
    return _FEW_AXES if len(observation.setups[setup].moves) <= 3 else _MANY_AXES


def _prepared(scorer: Scorer, setup: int, effort: _Effort) -> Climb:
    """Return the peaks of a fine lattice; where one axis moves, its exact line needs no start."""
    if len(scorer.observation.setups[setup].moves) == 1:
        return _parked(scorer, setup)
    found = starts(scorer, setup) if effort is _STACKED else dense_starts(scorer, setup)
    climb = Climb(scorer, setup, found.poses, found.approaches, found.gains)
    return climb.best(effort.peaks, effort.share, found.gains.max())


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
    """Return good readings that stand apart, the best of every set-up among them, after sweeps over lattice lines."""
    gains = scorer.gains(lattice)
    order = np.argsort(-gains, kind="stable")
    _, firsts = np.unique(lattice.setups[order], return_index=True)
    chosen = np.unique(np.concatenate([order[firsts], order[:_LOOKED_AT]]))
    climbs = []
    for setup in np.unique(lattice.setups):
        mine = chosen[lattice.setups[chosen] == setup]
        climb = Climb(scorer, int(setup), lattice.poses[mine], lattice.approaches[mine], gains[mine])
        climbs.append(climb.scattered(_STARTS, _APART))
        climbs[-1].sweep_lattice()
    return climbs


def _finalists(climbs: list[Climb]) -> list[Climb]:
    """Return the distinct best after Newton's steps, few enough for exact lines."""
    best = max(climb.gains.max() for climb in climbs)
    efforts = [_effort(climb.scorer.observation, climb.setup) for climb in climbs]
    pairs = [(c.distinct().best(e.peaks, e.share, best), e) for c, e in zip(climbs, efforts, strict=True)]
    pairs = [(climb, effort) for climb, effort in pairs if len(climb.gains)]
    for climb, _ in pairs:
        if len(climb.moves) > 1:
            climb.newton(_FIRST_STEPS)
    best = max(climb.gains.max() for climb, _ in pairs)
    final = [climb.distinct().best(effort.exact, effort.hopeful, best) for climb, effort in pairs]
    return [climb for climb in final if len(climb.gains)]


def _step(climb: Climb) -> Step:
    best = int(climb.gains.argmax())
    pose, approach = climb.poses[best], climb.approaches[best]
    scorer = climb.scorer
    seen = scorer.observation.rows(climb.setup, pose[None], approach[None])
    above, below = gain_forms(seen.rows, scorer.factor, scorer.weighted, seen.variances)
    return Step(climb.setup, pose, approach, float(above[0] / below[0]), float(seen.variances[0]), seen.rows[0])
