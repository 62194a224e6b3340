"""The next measurement, exactly: over all set-ups, all axes that may move, and both directions of approach.

Where errors simply add up, every point of a fine lattice is a start; elsewhere the best candidates of a given lattice
are, after a sweep over a few positions in each interval. From the best ones the gain ΔJ = gᵀCWCg / (σ² + gᵀCg) is
climbed by Newton steps and maximised exactly along one joint after another, on every interval between knots (B&H
eq. 27; over all joints B&H eq. 37), until no joint improves it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.accuracy.criterion import Root
from axiscal.design.gains.gain import Scorer
from axiscal.design.step.certified_plane import certifiable, certified_gain
from axiscal.design.step.chart_climb import ROUNDS, ChartClimb
from axiscal.design.step.climb import Climb
from axiscal.design.step.starts_stacked import adds_up, starts
from axiscal.design.step.starts_with_levers import dense_starts
from axiscal.estimation.knowledge import Knowledge
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.exact_step import gain_forms
from axiscal.numerics.threads import one_thread
from axiscal.numerics.ties import TIE, first_best, ranked

_APART = 0.12
_STARTS = 16
_LOOKED_AT = 400
_CHARTED = 4


class _Sieve(NamedTuple):
    """At most so many readings, each with at least this share of the best gain, go on by so many of Newton's steps."""

    most: int
    share: float
    steps: int


_STACKED = (_Sieve(100, 0.6, 1), _Sieve(60, 0.9, 2), _Sieve(12, 0.99, 6), _Sieve(2, 0.9999, 0))
_FEW_AXES = (_Sieve(240, 0.5, 1), _Sieve(120, 0.7, 2), _Sieve(40, 0.8, 40), _Sieve(4, 0.9999, 0))
_MANY_AXES = (_Sieve(32, 0.92, 3), _Sieve(6, 0.97, 0))
_THREE_VALUES = (_Sieve(32, 0.92, 3), _Sieve(8, 0.97, 6), _Sieve(1, 1.0, 0))
"""How hard to look, so that no narrow ridge is missed: those that pass the last sieve go on to exact lines."""


@dataclass(frozen=True, eq=False, slots=True)
class Step:
    """The reading that gains most.

    setup : index; pose, approach : (q,); gain : fall of J; variance : of the reading's noise and fresh rests
    row : (size,) or, of a reading of several numbers, (k, size) what it sees; then variance : (k,) or a number
    """

    setup: int
    pose: Array
    approach: Array
    gain: float
    variance: float | Array
    row: Array

    @property
    def place(self) -> Places:
        """Where it is taken."""
        return Places.one(self.setup, self.pose, self.approach)

    def reading(self, observation: Observation, *values: float) -> Reading:
        """Return the reading that is taken there; how well it makes the machine known does not depend on its values."""
        setup = observation.setups[self.setup]
        first, *others = values or (0.0,) * len(directions_of(setup))
        pose, approach = tuple(map(float, self.pose)), tuple(map(int, self.approach))
        return Reading(setup.name, pose, approach, first, others=tuple(others))


@one_thread()
def best_step(knowledge: Knowledge, root: Root, lattice: Places) -> Step:
    """Return the reading with the largest fall of J = tr(VᵀV C) (B&H eq. 37).

    root : V of the criterion, as `criterion` makes it; lattice : candidates to start from, at least one per set-up
    """
    scorer = Scorer.of(knowledge.observation, knowledge.belief, root)
    found = best_of(scorer, lattice)
    for setup in np.unique(lattice.setups).tolist():
        if knowledge.observation.errors.planes and certifiable(scorer.observation, setup):
            found = _beyond(scorer, setup, found)
    return found


def _beyond(scorer: Scorer, setup: int, found: Step) -> Step:
    """Return the step, or a better one where boxes over the plane of both axes show that there is one."""
    certified = certified_gain(scorer, setup, found.gain)
    if certified.lower <= found.gain:
        return found
    climb = Climb(scorer, setup, certified.pose[None], certified.approach[None], np.array([certified.lower]))
    climb.finish()
    return _step(climb)


def best_of(scorer: Scorer, lattice: Places) -> Step:
    """Return the reading with the largest gain of a scorer."""
    setups = [int(setup) for setup in np.unique(lattice.setups)]
    charted = [setup for setup in setups if scorer.observation.setups[setup].chart is not None]
    setups = [setup for setup in setups if setup not in charted]
    many = [setup for setup in setups if _sieves(scorer.observation, setup) in (_MANY_AXES, _THREE_VALUES)]
    climbs = [_prepared(scorer, setup) for setup in setups if setup not in many]
    others = np.isin(lattice.setups, many)
    if others.any():
        climbs += _from_lattice(scorer, lattice.within(others))
    finalists = _finalists(climbs) if climbs else []
    finalists += [_best_on_chart(scorer, setup, lattice) for setup in charted]
    for climb in finalists:
        if len(climb.moves) > 1 and climb.setup not in charted:
            climb.finish()
    steps = [_step(climb) for climb in finalists]
    return steps[first_best(np.array([step.gain for step in steps]), TIE)]


def _best_on_chart(scorer: Scorer, setup: int, lattice: Places) -> Climb:
    """Return the best reading of a set-up that is read on a chart, from its best candidates that stand apart."""
    poses, approaches = lattice.of(setup)
    begun = Climb(scorer, setup, poses, approaches, scorer.at(setup, poses, approaches))
    return climbed_on_chart(begun.scattered(_CHARTED, _APART))


def climbed_on_chart(begun: Climb, rounds: int = ROUNDS) -> Climb:
    """Return the best that readings on a chart climb to, along its coordinates; after so many rounds, if they are said.

    Where every coordinate has steps the candidates are all there is.
    """
    chart = begun.scorer.observation.setups[begun.setup].chart
    if chart is None or all(chart.bounds(number).step > 0 for number in range(chart.size)):
        return begun.best(1, 0.0, 1.0)
    climbs = (
        ChartClimb.begun(begun.scorer, begun.setup, *way) for way in zip(begun.poses, begun.approaches, strict=True)
    )
    ended = [climb.finished(rounds) for climb in climbs if climb is not None]
    best = ended[first_best(np.array([climb.gain for climb in ended]), TIE)]
    if not best.gain > begun.gains.max():
        return begun.best(1, 0.0, 1.0)
    return Climb(begun.scorer, begun.setup, best.pose[None], best.approach[None], np.array([best.gain]))


def _sieves(observation: Observation, setup: int) -> tuple[_Sieve, ...]:
    """Return what starts of a set-up have to pass; tables and dense lattices are for readings of one number."""
    moves, alone = observation.setups[setup].moves, len(directions_of(observation.setups[setup])) == 1
    if len(moves) == 1 or (alone and adds_up(observation, setup)):
        return _STACKED
    if not alone:
        return _THREE_VALUES
    return _FEW_AXES if len(moves) <= 3 else _MANY_AXES


def _prepared(scorer: Scorer, setup: int) -> Climb:
    """Return the peaks of a fine lattice; where one axis moves, its exact line needs no start."""
    if len(scorer.observation.setups[setup].moves) == 1:
        return _parked(scorer, setup)
    stacked = _sieves(scorer.observation, setup) is _STACKED
    found = starts(scorer, setup) if stacked else dense_starts(scorer, setup)
    return Climb(scorer, setup, found.poses, found.approaches, found.gains)


def _parked(scorer: Scorer, setup: int) -> Climb:
    """Return the best reading along the one axis that moves, from every side."""
    mounted = scorer.observation.setups[setup]
    poses = np.tile(np.array(mounted.park), (len(mounted.sides), 1))
    approaches = np.zeros_like(poses)
    approaches[:, list(mounted.moves)] = np.array(mounted.sides, dtype=float)[:, None]
    climb = Climb(scorer, setup, poses, approaches, np.zeros(len(poses)))
    climb.finish()
    return climb


def _from_lattice(scorer: Scorer, lattice: Places) -> list[Climb]:
    """Return good readings that stand apart, the best of every set-up among them, after sweeps over lattice lines."""
    gains = scorer.gains(lattice)
    order = ranked(gains, TIE)
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
    for stage in range(max(len(sieves) for sieves in (_STACKED, _FEW_AXES, _MANY_AXES, _THREE_VALUES))):
        best = max(climb.gains.max() for climb in climbs)
        climbs = [passed for climb in climbs if len((passed := _sifted(climb, stage, best)).gains)]
    return climbs


def _sifted(climb: Climb, stage: int, best: float) -> Climb:
    """Return those that pass a sieve of their set-up, moved on by its Newton steps."""
    sieves = _sieves(climb.scorer.observation, climb.setup)
    if stage >= len(sieves) or len(climb.moves) == 1:
        return climb
    passed = climb.best(sieves[stage].most, sieves[stage].share, best)
    passed.newton(sieves[stage].steps)
    return passed.distinct()


def _step(climb: Climb) -> Step:
    best = first_best(climb.gains, TIE)
    pose, approach = climb.poses[best], climb.approaches[best]
    scorer = climb.scorer
    rows, covariances = (part[0] for part in scorer.observation.numbers(climb.setup, pose[None], approach[None]))
    if len(rows) == 1:
        above, below = gain_forms(rows, scorer.factor, scorer.weighted, covariances[0])
        return Step(climb.setup, pose, approach, float(above[0] / below[0]), float(covariances[0, 0]), rows[0])
    gain = float(scorer.at(climb.setup, pose[None], approach[None])[0])
    return Step(climb.setup, pose, approach, gain, np.diagonal(covariances).copy(), rows)
