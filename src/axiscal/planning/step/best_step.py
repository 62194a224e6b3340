"""The next measurement: over all set-ups, all axes that may move, and both directions of approach (B&H eq. 37).

Every point of a fine lattice is a start where errors simply add up. Elsewhere the starts are the best candidates of a
given lattice, after a sweep over a few positions in each interval. Newton steps climb the gain ΔJ = gᵀCWCg / (σ² +
gᵀCg) from the best starts, and looks along each joint lead on, until neither improves it. The highest is then moved
along one joint after another, exactly on every interval between knots (B&H eq. 27; over all joints B&H eq. 37), until
no joint improves it. In a plane whose errors depend on both axes, boxes enclose what any place may gain.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.estimation.accuracy.criterion import Root
from axiscal.estimation.knowledge import Knowledge
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.reading import Places, Reading
from axiscal.numerics import Array
from axiscal.numerics.bernstein import largest_ratio, patches
from axiscal.numerics.threads import one_thread
from axiscal.numerics.ties import TIE, first_best
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.gains.gain import Scorer, joint_gains
from axiscal.planning.step.climb import Climb
from axiscal.planning.step.ground import Region, regions, sides
from axiscal.planning.step.starts_stacked import adds_up, dense_starts, starts

_APART = 0.12
_STARTS = 32
_LOOKED_AT = 400


class _Sieve(NamedTuple):
    """Limits to go on: the most readings, their least share of the best gain, and the number of Newton's steps."""

    most: int
    share: float
    steps: int


_STACKED = (_Sieve(100, 0.6, 1), _Sieve(60, 0.9, 2), _Sieve(12, 0.99, 6), _Sieve(2, 0.9999, 0))
_FEW_AXES = (_Sieve(240, 0.5, 1), _Sieve(120, 0.7, 2), _Sieve(40, 0.8, 40), _Sieve(4, 0.9999, 0))
_SCATTERED = (_Sieve(32, 0.7, 3), _Sieve(8, 0.9, 6), _Sieve(2, 0.97, 0))
"""How hard to look, so that no narrow ridge is missed: those that pass the last sieve are climbed to the top."""


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
    scorer = Covariance.from_factor(knowledge.observation, knowledge.belief.factor, root).scorer()
    found = best_of(scorer, lattice)
    for setup in np.unique(lattice.setups).tolist():
        if knowledge.observation.errors.planes and _alone(scorer.observation, setup, 2):
            found = _beyond(scorer, setup, found)
    return found


def _alone(observation: Observation, setup: int, axes: int) -> bool:
    """Return whether a set-up reads one number while so many axes move, without a raster, wherever it stands."""
    mounted = observation.setups[setup]
    plain = mounted.chart is None and mounted.station is None
    continuous = len(mounted.moves) == axes and not any(mounted.raster[axis] > 0 for axis in mounted.moves)
    return plain and continuous and len(directions_of(mounted)) == 1


def _beyond(scorer: Scorer, setup: int, found: Step) -> Step:
    """Return the step, or a better one where boxes over the plane of both axes show that there is one."""
    certified = certified_gain(scorer, setup, found.gain)
    if certified.lower <= found.gain:
        return found
    climb = Climb.begun(scorer, setup, certified.pose[None], certified.approach[None])
    climb.uphill()
    climb.finish()
    return _step(climb)


def best_of(scorer: Scorer, lattice: Places) -> Step:
    """Return the reading with the largest gain of a scorer."""
    setups = [int(setup) for setup in np.unique(lattice.setups)]
    climbs = _finalists([_begun(scorer, setup, lattice) for setup in setups])
    for climb in climbs:
        if _sieves(scorer.observation, climb.setup):
            climb.uphill()
    highest = climbs[first_best(np.array([climb.gains.max() for climb in climbs]), TIE)].best(1, 0.0, 1.0)
    if _sieves(scorer.observation, highest.setup):
        highest.finish()
    return _step(highest)


def _sieves(observation: Observation, setup: int) -> tuple[_Sieve, ...]:
    """Return what starts of a set-up have to pass; tables and dense lattices are for readings of one number.

    Along one axis there is one start, and nothing that it has to pass.
    """
    if _alone(observation, setup, 1):
        return ()
    mounted, alone = observation.setups[setup], len(directions_of(observation.setups[setup])) == 1
    if mounted.chart is not None or not alone:
        return _SCATTERED
    if adds_up(observation, setup):
        return _STACKED
    return _FEW_AXES if len(mounted.moves) <= 3 else _SCATTERED


def _begun(scorer: Scorer, setup: int, lattice: Places) -> Climb:
    """Return where to begin: along one axis at the best place, else at peaks of a fine lattice, or good candidates."""
    sieves = _sieves(scorer.observation, setup)
    if not sieves:
        return _on_the_line(scorer, setup)
    if sieves in (_STACKED, _FEW_AXES):
        found = starts(scorer, setup) if sieves is _STACKED else dense_starts(scorer, setup)
        return Climb.begun(scorer, setup, found.poses, found.approaches, found.gains)
    climb = Climb.begun(scorer, setup, *lattice.in_setup(setup)).best(_LOOKED_AT, 0.0, 1.0)
    return climb.scattered(_STARTS, _APART)


def _on_the_line(scorer: Scorer, setup: int) -> Climb:
    """Return the best reading along the only axis that moves, from each side that differs in what is seen."""
    approaches = np.array(sides(scorer.observation, setup))
    poses = np.tile(np.array(scorer.observation.setups[setup].park), (len(approaches), 1))
    climb = Climb.begun(scorer, setup, poses, approaches, np.zeros(len(poses)))
    climb.exactly()
    return climb


def _finalists(climbs: list[Climb]) -> list[Climb]:
    """Return the distinct best after Newton's steps, few enough to be climbed to the top."""
    sieves = {climb.setup: _sieves(climb.scorer.observation, climb.setup) for climb in climbs}
    for stage in range(len(_FEW_AXES)):  # no set-up has more sieves
        best = max(climb.gains.max() for climb in climbs)
        sifted = [_sifted(climb, sieves[climb.setup][stage : stage + 1], best) for climb in climbs]
        climbs = [climb for climb in sifted if len(climb.gains)]
    return climbs


def _sifted(climb: Climb, sieves: tuple[_Sieve, ...], best: float) -> Climb:
    """Return those that pass a sieve, moved on by its Newton steps; all of them where there is none."""
    if not sieves:
        return climb
    (sieve,) = sieves
    passed = climb.best(sieve.most, sieve.share, best)
    passed.newton(sieve.steps)
    return passed.distinct()


def _step(climb: Climb) -> Step:
    best = first_best(climb.gains, TIE)
    pose, approach = (part[best] for part in climb.readings)
    seen = climb.scorer.observation.numbers(climb.setup, pose[None], approach[None])
    gain = float(joint_gains(*climb.scorer.split_all(seen))[0])
    rows, variances = seen.rows[0], np.diagonal(seen.covariances[0]).copy()
    if len(rows) == 1:
        return Step(climb.setup, pose, approach, gain, float(variances[0]), rows[0])
    return Step(climb.setup, pose, approach, gain, variances, rows)


class CertifiedGain(NamedTuple):
    """The largest gain lies between lower, that at the pose (q,) from its side (q,), and upper.  boxes : looked at"""

    lower: float
    upper: float
    pose: Array
    approach: Array
    boxes: int


def certified_gain(scorer: Scorer, setup: int, known: float = 0.0) -> CertifiedGain:
    """Enclose the largest gain of one reading of one number of a set-up, wherever it is taken.

    N = gᵀCWCg and D = σ² + gᵀCg are polynomials between knots and edges of visited cells. Their degree is 6 along a
    linear axis, and 8 where lever arms grow with it (method of B&H eq. 27, in several coordinates at once).
    known : a gain that some place reaches; raises PlanError where readings cannot be cut into boxes
    """
    found = []
    for region in regions(scorer.observation, setup):

        def forms(places: Array, region: Region = region) -> tuple[Array, Array]:
            return scorer.gain_forms(setup, *region.as_poses(places))

        each = largest_ratio(patches(forms, region.low, region.high, region.degree), known)
        pose, approach = (part[0] for part in region.as_poses(each.place[None]))
        found.append(CertifiedGain(each.lower, each.upper, pose, approach, each.boxes))
    best, upper = max(found, key=lambda each: each.lower), max(each.upper for each in found)
    return best._replace(upper=upper, boxes=sum(each.boxes for each in found))
