"""A lower bound that holds for readings anywhere, not only on a lattice: where errors simply add up, and on charts.

The matrix Z of `dual` bounds every plan once Σ |Z b|² over its readings is bounded. Three enclosures give the largest
|Z b(t)|² over all poses:
- Without lever arms Z b(t) is a sum of polynomial curves, one per axis (`steepest`).
- Over two linear axes that act together, or through lever arms, it is a polynomial of both (`largest_on_plane`).
- On a chart of one or two coordinates it is a sum of waves times splines (`chart_boxes`).
The poses found on the way join the weighted plan, until no place is worth more than those that have weight. The rests
of cells are taken as known: that can only lower the bound. In floating point, with a margin for rounding, without
intervals.

Errors of two axes, and lever arms that both lengthen, make Z b(x, y) a polynomial of both coordinates between knots.
|Z b|² is then one of degree 6 in each, 8 with lever arms, and boxes with its Bernstein coefficients enclose it.

Without lever arms and turning, the errors of a machine simply add up. Between knots a row is then a polynomial of one
axis plus one of the next (B&H eq. 28-30). Poses all over the travels test whether it is one (`row_sums`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.exceptions import PlanError
from axiscal.language.spoken import listed, said
from axiscal.measurement.breaks import breaks_along
from axiscal.measurement.free_plane import EXACT, on_free_plane, plane_pieces, plane_poses
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.place import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.bernstein import (
    BezierCurve,
    PlaneForms,
    along,
    bernstein,
    largest_ratio,
    misfit,
    steepest,
    uphill,
)
from axiscal.numerics.chebyshev import nodes
from axiscal.numerics.spread import even_points
from axiscal.numerics.stages import stage
from axiscal.numerics.threads import one_thread
from axiscal.planning.bound.certificate import Dual
from axiscal.planning.bound.chart_boxes import Largest, apart, largest_on_chart, refuse_unless_boxed
from axiscal.planning.bound.lower_bound import Bound, most_numbers, settling
from axiscal.planning.bound.relaxation import Relaxation
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.step.ground import sides

GAP = 1e-2
_ROUNDS = 40
"""Any round proves a bound, and rounds end where the gap is closed; this only ends what would go on."""
_BOXES = 400_000
"""Boxes that are cut before the search gives up: memory. The bound holds wherever it ends."""
_CUTS = 60_000
"""The same on a chart, where each costs as much as six readings."""
_PATIENCE, _CLOSED = 4, 0.9
"""The search ends where so many rounds leave more than this share of the gap open: more would not close it."""
_GONE = 1e-5
"""A weight of this share is none; it can enter again."""


@dataclass(frozen=True, eq=False, slots=True)
class Proof:
    """A bound on J for readings anywhere in the travels, and the share of it at which closing the gap stopped."""

    bound: Bound
    gap: float


@one_thread()
@stage("the proof")
def prove(
    state: Covariance,
    lattice: Places,
    places: Places,
    gap: float = GAP,
) -> Proof:
    """Return the bound for as many readings as a plan has of all set-ups of a lattice, wherever they are taken.

    state : before the first; lattice : candidates to begin with; places : a good plan; gap : share of J to stop at
    Raises PlanError where neither the errors add up nor a chart can be cut into boxes.
    """
    setups, count = [int(s) for s in np.unique(lattice.setups)], len(places)
    for setup in setups:
        refuse_setup(state.observation, setup)
    if not count:
        return Proof(Bound(state.value, True), 0.0)
    flat = [setup for setup in setups if _flat(state.observation, setup)]
    best, closed, reached, numbers = 0.0, 0.0, np.inf, most_numbers(state, setups, count)
    open_ones: list[float] = []
    lattice = _begun(state, lattice, places)
    for _ in range(_ROUNDS):
        relaxation = _everywhere(state, lattice, count)
        dual = relaxation.solved()
        level = float(relaxation.slopes(dual) @ relaxation.weights) / count
        kept = relaxation.pool.lattice.within(relaxation.weights > _GONE * count)
        found = [_largest(dual, *way, kept, level, gap) for way in _ways(state, setups, flat)]
        found += [_on_plane(dual, *way, level, gap) for way in _ways(state, flat)]
        found += [_on_chart(dual, setup, level, gap) for setup in setups if charted(state, setup)]
        spent = count * max(each.upper for each in found)
        best = max(best, dual.floor(spent, numbers))
        closed, reached = max(closed, dual.whole - spent), min(reached, dual.value)
        left = reached / closed - 1 if closed > 0 else np.inf
        steeper = Places.joined([each.places for each in found])
        open_ones.append(left)
        if left <= gap or not len(steeper) or _stalled(open_ones):
            break
        lattice = Places.joined([kept, steeper])
    return Proof(Bound(best, True), max(left, 0.0))


def _stalled(open_ones: list[float]) -> bool:
    """Whether the last rounds have hardly closed anything.  open_ones : of each round, the share of J that is open"""
    return len(open_ones) > _PATIENCE and open_ones[-1] > _CLOSED * open_ones[-1 - _PATIENCE]


def _begun(state: Covariance, lattice: Places, places: Places) -> Places:
    """Return the candidates that have weight where only those of a lattice, and a plan, may be taken."""
    pool, count = Pool(state.observation, lattice), len(places)
    relaxation = Relaxation(pool, state, places, np.ones(len(pool) + count), float(count), rests=False)
    for _ in settling(relaxation):
        pass
    return relaxation.weighty


def _everywhere(state: Covariance, lattice: Places, count: int) -> Relaxation:
    pool = Pool(state.observation, lattice)
    relaxation = Relaxation(pool, state, lattice.within(slice(0, 0)), np.ones(len(lattice)), float(count), rests=False)
    relaxation.begin_everywhere()
    return relaxation


def charted(state: Covariance, setup: int) -> bool:
    """Whether a set-up is read on a chart."""
    return state.observation.setups[setup].chart is not None


def refuse_setup(observation: Observation, setup: int) -> None:
    """Raise PlanError for a set-up for which no proof can be had."""
    if observation.setups[setup].chart is None:
        if not _flat(observation, setup):
            refuse_unless_polynomial(observation, setup)
    else:
        refuse_unless_boxed(observation, setup)


def _flat(observation: Observation, setup: int) -> bool:
    """Return whether a set-up moves two axes that do not add up, and its rows are polynomials of both."""
    try:
        refuse_unless_polynomial(observation, setup)
    except PlanError:
        return planar(observation, setup)
    return False


def _on_plane(dual: Dual, setup: int, side: Array, level: float, gap: float) -> Largest:
    """Enclose the largest |Z b|² of a set-up that moves two axes which do not add up, and find where it is large."""
    observation, mounted = dual.state.observation, dual.state.observation.setups[setup]
    reach = dual.reach / mounted.noise
    found = largest_on_plane(observation, setup, side, reach, level * (1 + gap / 4), _CUTS)
    spans = np.array([np.ptp(mounted.span(observation.machine.axes[axis], axis)) for axis in mounted.moves])
    steep = int(np.sum(found.lengths > level * (1 + gap / 8)))
    chosen = apart(found.places / spans, np.arange(steep))
    poses = plane_poses(mounted, found.places[chosen])
    return Largest(found.upper, Places.of_setup(setup, poses, np.tile(side, (len(poses), 1))))


def _on_chart(dual: Dual, setup: int, level: float, gap: float) -> Largest:
    """Enclose the largest |Z b|² of a set-up on a chart."""
    observation = dual.state.observation
    reach = dual.reach / observation.setups[setup].noise
    return largest_on_chart(observation, setup, reach, level, gap / 4, _CUTS)


def _ways(state: Covariance, setups: list[int], without: Sequence[int] = ()) -> list[tuple[int, Array]]:
    """Return each set-up that is not on a chart, nor left out, with each of the sides that it can be read from."""
    plain = [setup for setup in setups if not charted(state, setup) and setup not in without]
    return [(setup, side) for setup in plain for side in sides(state.observation, setup)]


def _largest(dual: Dual, setup: int, side: Array, kept: Places, level: float, gap: float) -> Largest:
    """Enclose the largest |Z b|² of a set-up from one side, and find where else it is large, uphill from candidates."""
    observation = dual.state.observation
    mounted, reach = observation.setups[setup], dual.reach
    whole = joined([each.seen(reach / mounted.noise) for each in row_sums(observation, setup, side)])
    mine = (kept.setups == setup) & np.all(kept.approaches == side, axis=1)
    begun = np.vstack([kept.poses[mine][:, mounted.moves], np.array(mounted.park)[None, mounted.moves]])
    tops = uphill(whole.parked, whole.curves, begun)
    known = max(level, float(np.sum(whole.at(tops) ** 2, axis=1).max()))
    found = steepest(whole.parked, whole.curves, known, max(gap / 4, (known / level - 1) / 4), _BOXES)
    tops = np.vstack([tops, uphill(whole.parked, whole.curves, found.places)]) if len(found.places) else tops
    lengths = np.sum(whole.at(tops) ** 2, axis=1)
    spans = np.array([curve.right[-1] - curve.left[0] for curve in whole.curves])
    chosen = apart(tops / spans, np.argsort(-lengths, kind="stable")[: int(np.sum(lengths > level * (1 + gap / 8)))])
    poses = np.tile(np.array(mounted.park), (len(chosen), 1))
    poses[:, mounted.moves] = tops[chosen]
    return Largest(found.upper, Places.of_setup(setup, poses, np.tile(side, (len(poses), 1))))


_PARTS = 3
"""Places looked at in each knot interval along each axis: a curve between knots has no more hills than that."""
_FINER, _FINEST = 3.0, 8
"""Hills are climbed on grids of three by three, each so much finer: in the end to a thousandth of a knot interval."""


class Tops(NamedTuple):
    """No |Z b|² is above upper; places (m, 2) are hills, the highest first, lengths (m,) |Z b|² there."""

    upper: float
    places: Array
    lengths: Array


def planar(observation: Observation, setup: int) -> bool:
    """Return whether a set-up reads one number all over two linear axes, by polynomials of both between knots."""
    mounted = observation.setups[setup]
    if not on_free_plane(observation, setup):
        return False
    side = np.array([1.0 if axis in mounted.moves else 0.0 for axis in range(len(observation.machine.axes))])
    forms = _forms(observation, setup, side, np.eye(observation.size))
    return misfit(forms, *plane_pieces(observation, setup)) < EXACT


def largest_on_plane(observation: Observation, setup: int, side: Array, reach: Array, level: float, boxes: int) -> Tops:
    """Enclose the largest |g reach|² of readings of a set-up from one side; what is not above a level is not followed.

    reach : (n, w) per unit of noise; boxes : how many to look at; what is then still open counts with its upper bound
    """
    forms, (breaks, degree) = _forms(observation, setup, side, reach), plane_pieces(observation, setup)
    places, lengths = _hills(forms, breaks)
    known = max(level, float(lengths.max(initial=0.0)))
    found = largest_ratio(forms, breaks, degree, known, boxes)
    if found.lower > known:
        places, lengths = np.vstack([found.place, places]), np.append(found.lower, lengths)
    return Tops(found.upper, places, lengths)


def _forms(observation: Observation, setup: int, side: Array, reach: Array) -> PlaneForms:
    """Return |g reach|², over one, as a function of places (m, 2)."""
    mounted = observation.setups[setup]
    (way,) = directions_of(mounted)

    def forms(places: Array) -> tuple[Array, Array]:
        poses = plane_poses(mounted, places)
        rows = observation.rows(setup, poses, np.tile(side, (len(poses), 1)), way).rows
        return np.sum((rows @ reach) ** 2, axis=1), np.ones(len(places))

    return forms


def _hills(forms: PlaneForms, breaks: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return the hills of a fine grid, climbed, the highest first: places (m, 2), lengths (m,)."""
    lines = [np.unique(np.linspace(at[:-1], at[1:], _PARTS + 1).ravel()) for at in breaks]
    grid = np.stack([each.ravel() for each in np.meshgrid(*lines, indexing="ij")], axis=1)
    heights = forms(grid)[0].reshape(len(lines[0]), len(lines[1]))
    around = np.pad(heights, 1, constant_values=-np.inf)
    shifts = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    beside = np.max([around[i : i + heights.shape[0], j : j + heights.shape[1]] for i, j in shifts], axis=0)
    places = grid[(heights >= beside).ravel()]
    low, high = (np.array([line[end] for line in lines]) for end in (0, -1))
    step = np.array([float(np.max(np.diff(line))) for line in lines])
    moves = np.stack([each.ravel() for each in np.meshgrid([0, -1, 1], [0, -1, 1], indexing="ij")], axis=1)
    for _ in range(_FINEST):
        step = step / _FINER
        tried = np.clip(places[:, None] + moves * step, low, high)
        best = forms(tried.reshape(-1, 2))[0].reshape(len(places), -1).argmax(axis=1)
        places = tried[np.arange(len(places)), best]
    lengths = forms(places)[0]
    order = np.argsort(-lengths, kind="stable")
    return places[order], lengths[order]


_DEGREES = (3, 4)
"""A row is a cubic, with a slope of the set-up's own of degree 4: both are tried."""
_LOOKS = 64
"""Poses at which the curves are compared with the rows themselves; a wrong one shows at almost every pose."""
_EXACT = 1e-10
"""Rounding of a sum over the axes, with room; a term that is missing is millions of times larger."""


class Sum(NamedTuple):
    """Rows of one number: that at the park pose (n,), and what each moving axis adds to it."""

    parked: Array
    curves: list[BezierCurve]

    def at(self, places: Array) -> Array:
        """Return the rows at coordinates (m, q) of the moving axes, (m, n)."""
        return self.parked + sum(along(c, at) for c, at in zip(self.curves, places.T, strict=True))

    def seen(self, reach: Array) -> Sum:
        """Return the same of rows times reach (n, w)."""
        return Sum(self.parked @ reach, [BezierCurve(c.left, c.right, c.control @ reach) for c in self.curves])


def refuse_unless_polynomial(observation: Observation, setup: int) -> None:
    """Raise PlanError for a set-up whose rows are no sum of polynomials, one per axis."""
    _degree(observation, setup)


def row_sums(observation: Observation, setup: int, side: Array) -> list[Sum]:
    """Return the rows of each number of a reading from one side (q,); raises PlanError where they are no such sum."""
    degree = _degree(observation, setup)
    return [_sum(observation, setup, side, way, degree) for way in directions_of(observation.setups[setup])]


def joined(sums: list[Sum]) -> Sum:
    """Return the numbers of a reading as one vector, for the length of which all of them count."""
    curves = [
        BezierCurve(first.left, first.right, np.concatenate([c.control for c in (first, *others)], axis=2))
        for first, *others in zip(*(each.curves for each in sums), strict=True)
    ]
    return Sum(np.concatenate([each.parked for each in sums]), curves)


def _degree(observation: Observation, setup: int) -> int:
    """Return the degree of the polynomials."""
    for degree in _DEGREES:
        if all(_holds(observation, setup, side, degree) for side in sides(observation, setup)):
            return degree
    mounted = observation.setups[setup]
    what = 'no proof for readings anywhere: with "{setup}" errors do not simply add up axis by axis ({why})'
    remedy = "Leave --prove out, then the bound holds for the candidates; or let it move one linear axis only"
    raise PlanError(what, remedy, setup=mounted.name, why=_why(observation, mounted))


def _why(observation: Observation, mounted: Setup) -> str:
    machine = observation.machine
    turning = [machine.axes[k].name for k in mounted.moves if machine.axes[k].rotary]
    if turning:
        return said("{axes} turns" if len(turning) == 1 else "{axes} turn", axes=listed(said(" and "), turning))
    if mounted.standing:
        return said("a {instrument} looks another way at every place", instrument=mounted.instrument)
    together = [plane.name for plane in observation.errors.planes if set(plane.axes) <= set(mounted.moves)]
    if together and not any(term.angular for term in observation.errors.terms):
        return said("two of its axes act together, {errors}", errors=listed(said(" and "), together))
    return said("rotations act through lever arms")


def _holds(observation: Observation, setup: int, side: Array, degree: int) -> bool:
    """Return whether the sums are the rows, in poses all over the travels."""
    mounted, axes = observation.setups[setup], observation.machine.axes
    poses = np.tile(np.array(mounted.park), (_LOOKS, 1))
    for axis, share in zip(mounted.moves, even_points(_LOOKS, len(mounted.moves)).T, strict=True):
        low, high = mounted.span(axes[axis], axis)
        poses[:, axis] = low + (high - low) * share
    for way in directions_of(mounted):
        found = _sum(observation, setup, side, way, degree)
        true = observation.rows(setup, poses, np.tile(side, (_LOOKS, 1)), way).rows
        summed = found.at(poses[:, mounted.moves])
        if np.any(np.abs(summed - true) > _EXACT * np.abs(true).max(axis=0)):
            return False
    return True


def _sum(observation: Observation, setup: int, side: Array, way: Array | None, degree: int) -> Sum:
    mounted = observation.setups[setup]
    park = np.array(mounted.park)
    parked = observation.rows(setup, park[None], np.zeros((1, len(park))), way).rows[0]
    inner = (1 + nodes(degree + 1)) / 2
    to_control = np.linalg.inv(bernstein(degree, inner))
    curves = []
    for axis in mounted.moves:
        breaks = breaks_along(observation, axis, setup)
        left, right = breaks[:-1], breaks[1:]
        positions = (left[:, None] + np.diff(breaks)[:, None] * inner).ravel()
        poses, approaches = np.tile(park, (len(positions), 1)), np.zeros((len(positions), len(park)))
        poses[:, axis], approaches[:, axis] = positions, side[axis]
        added = observation.rows(setup, poses, approaches, way).rows - parked
        control = np.einsum("ij,bjn->bin", to_control, added.reshape(len(left), degree + 1, -1))
        curves.append(BezierCurve(left, right, control))
    return Sum(parked, curves)
