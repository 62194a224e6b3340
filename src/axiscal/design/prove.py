"""A lower bound that holds for readings anywhere, not only on a lattice, for machines whose errors simply add up.

The bound of `bound.py` needs the largest slope d(t) = |V S g(t)|²/σ² over all poses. On a box of knot intervals
V S g(t) is a sum of cubic curves, one per axis, and lies in the hull of the sums of their Bernstein control points; a
squared length is convex, so its maximum over the box is at most that over these sums. Branch and bound halves the boxes
that may still hold more until the gap is closed; the poses found on the way join the weighted plan. In floating point,
with a margin for rounding, not in interval arithmetic.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.design.bound import Bound, Relaxation, rank_bound
from axiscal.design.dense import sides
from axiscal.design.lattice import Lattice
from axiscal.design.pool import Pool
from axiscal.design.stacked import adds_up
from axiscal.design.state import Point, State
from axiscal.exceptions import PlanError
from axiscal.measurement.observation import directions_of
from axiscal.numerics import Array
from axiscal.numerics.chebyshev import nodes

_ROUNDS = 25
_BOXES = 400_000
_ROUNDING = 1e-11


@dataclass(frozen=True, eq=False, slots=True)
class Proof:
    """A bound on J for readings anywhere in the travels, and the share of it at which closing the gap stopped."""

    bound: Bound
    gap: float


def prove(state: State, setups: list[int], points: list[Point], readings: int, gap: float = 2e-3) -> Proof:
    """Return the bound for so many readings of some set-ups, wherever they are taken.

    state : before the first; points : a good plan; gap : share at which to stop
    Raises PlanError for a machine with lever arms.
    """
    alone = all(len(directions_of(state.observation.setups[setup])) == 1 for setup in setups)
    if not alone or not all(adds_up(state.observation, setup) for setup in setups):
        what = "a proof for readings anywhere needs readings of one value and errors that simply add up, without levers"
        raise PlanError(what, "The bound for the lattice holds for its candidates")
    floor, best, reached = rank_bound(state, readings), 0.0, np.inf
    lattice = _lattice(points)
    for _ in range(_ROUNDS):
        relaxation = Relaxation(Pool(state.observation, lattice), state, [], np.ones(len(lattice)), float(readings))
        relaxation.begin_everywhere()
        value, _, slopes = relaxation.solved()
        level = float(slopes[relaxation.support] @ relaxation.weights) / readings
        found = [_largest(state, relaxation.factor, setup, side, level, gap) for setup, side in _sides(state, setups)]
        steepest = max(found, key=lambda one: one.upper)
        best, reached = max(best, value - readings * (steepest.upper - level)), min(reached, value)
        if reached <= best * (1 + gap) or reached <= floor:
            break
        steeper = [one.point for one in found if one.lower > level]
        if not steeper:
            break
        lattice = _joined(lattice, _lattice(steeper))
    bound = Bound(max(best, floor), True)
    return Proof(bound, reached / bound.value - 1 if bound.value > 0 else np.inf)


class _Steepest(NamedTuple):
    """The largest slope lies between lower, at a point, and upper."""

    lower: float
    upper: float
    point: Point


class _Curves(NamedTuple):
    """V S g along one axis: control points (intervals, 4, w) of cubics over [left, right], each (intervals,)."""

    left: Array
    right: Array
    control: Array


def _sides(state: State, setups: list[int]) -> list[tuple[int, Array]]:
    return [(setup, side) for setup in setups for side in sides(state.observation, setup)]


def _largest(state: State, factor: Array, setup: int, side: Array, level: float, gap: float) -> _Steepest:
    """Enclose the largest slope of a set-up by branch and bound."""
    mounted = state.observation.setups[setup]
    reach = factor @ (state.weight @ factor[: state.weight.shape[1]]).T / mounted.noise
    fixed, curves = _curves(state, setup, side, reach)
    boxes = _first_boxes(curves)
    best, where, closed, looked = -np.inf, np.zeros(len(curves)), 0.0, 0
    while len(boxes[0].left) and looked < _BOXES:
        looked += len(boxes[0].left)
        upper, corners = _values(fixed, boxes)
        top = np.unravel_index(int(corners.argmax()), corners.shape)
        if corners[top] > best:
            best, where = float(corners[top]), _place(boxes, int(top[0]), int(top[1]))
        open_ones = upper > max(best, level) * (1 + gap / 4)
        closed = max(closed, float(upper[~open_ones].max(initial=0.0)))
        boxes = _halved([_taken(box, open_ones) for box in boxes])
    left = float(_values(fixed, boxes)[0].max(initial=0.0)) if len(boxes[0].left) else 0.0
    pose = np.array(mounted.park)
    pose[list(mounted.moves)] = where
    return _Steepest(best, max(closed, left, best) * (1 + _ROUNDING), Point(setup, pose, side))


def _curves(state: State, setup: int, side: Array, reach: Array) -> tuple[Array, list[_Curves]]:
    """Return V S g at the park pose (w,), and what each axis adds to it."""
    mounted, observation = state.observation.setups[setup], state.observation
    park = np.array(mounted.park)
    parked = observation.rows(setup, park[None], np.zeros((1, len(park)))).rows[0]
    curves = []
    inner = (1 + nodes(4)) / 2
    to_control = np.linalg.inv(_bernstein(inner))
    for axis in mounted.moves:
        breaks = observation.breaks(axis, setup)
        left, right = breaks[:-1], breaks[1:]
        positions = (left[:, None] + np.diff(breaks)[:, None] * inner).ravel()
        poses, approaches = np.tile(park, (len(positions), 1)), np.zeros((len(positions), len(park)))
        poses[:, axis], approaches[:, axis] = positions, side[axis]
        added = (observation.rows(setup, poses, approaches).rows - parked) @ reach
        curves.append(_Curves(left, right, np.einsum("ij,bjw->biw", to_control, added.reshape(len(left), 4, -1))))
    return parked @ reach, curves


def _bernstein(t: Array) -> Array:
    """Return the cubic Bernstein polynomials at t (m,): (m, 4)."""
    return np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3], axis=1)


def _first_boxes(curves: list[_Curves]) -> list[_Curves]:
    """Return all combinations of intervals: one entry per box in the curves of every axis."""
    index = np.stack([g.ravel() for g in np.meshgrid(*(np.arange(len(c.left)) for c in curves), indexing="ij")])
    return [_taken(curve, i) for curve, i in zip(curves, index, strict=True)]


def _taken(curve: _Curves, which: NDArray[np.intp] | NDArray[np.bool_]) -> _Curves:
    return _Curves(curve.left[which], curve.right[which], curve.control[which])


def _values(fixed: Array, boxes: list[_Curves]) -> tuple[Array, Array]:
    """Return for each box an upper bound of the slope (b,), and the slopes at its corners (b, 2^q)."""
    total = np.zeros((len(boxes[0].left), 1, len(fixed))) + fixed
    for box in boxes:
        total = (total[:, :, None, :] + box.control[:, None, :, :]).reshape(len(total), -1, len(fixed))
    lengths = np.einsum("bvw,bvw->bv", total, total)
    digits = np.array(list(itertools.product(range(4), repeat=len(boxes))))
    return lengths.max(axis=1), lengths[:, np.all((digits == 0) | (digits == 3), axis=1)]


def _place(boxes: list[_Curves], box: int, corner: int) -> Array:
    """Return the coordinates (q,) of a corner of a box."""
    ends = list(itertools.product((0, 1), repeat=len(boxes)))[corner]
    return np.array([curve.right[box] if end else curve.left[box] for curve, end in zip(boxes, ends, strict=True)])


def _halved(boxes: list[_Curves]) -> list[_Curves]:
    """Return both halves of every box, cut where its control points spread most (de Casteljau)."""
    spread = np.array([np.linalg.norm(np.diff(box.control, axis=1), axis=2).sum(axis=1) for box in boxes])
    cut = spread.argmax(axis=0) if len(boxes[0].left) else np.zeros(0, dtype=np.intp)
    result = []
    for axis, box in enumerate(boxes):
        mine = cut == axis
        first, second = _split(box)
        lower = _Curves(*(np.where(_like(mine, a), a, b) for a, b in zip(first, box, strict=True)))
        upper = _Curves(*(np.where(_like(mine, a), a, b) for a, b in zip(second, box, strict=True)))
        result.append(_Curves(*(np.concatenate(both) for both in zip(lower, upper, strict=True))))
    return result


def _like(mask: NDArray[np.bool_], values: Array) -> NDArray[np.bool_]:
    return mask.reshape(-1, *[1] * (values.ndim - 1))


def _split(box: _Curves) -> tuple[_Curves, _Curves]:
    middle, c = (box.left + box.right) / 2, box.control
    ab, bc, cd = (c[:, 0] + c[:, 1]) / 2, (c[:, 1] + c[:, 2]) / 2, (c[:, 2] + c[:, 3]) / 2
    abc, bcd = (ab + bc) / 2, (bc + cd) / 2
    centre = (abc + bcd) / 2
    first = _Curves(box.left, middle, np.stack([c[:, 0], ab, abc, centre], axis=1))
    return first, _Curves(middle, box.right, np.stack([centre, bcd, cd, c[:, 3]], axis=1))


def _lattice(points: list[Point]) -> Lattice:
    setups, poses, approaches = zip(*points, strict=True)
    return Lattice(np.array(setups, dtype=np.intp), np.array(poses), np.array(approaches))


def _joined(one: Lattice, other: Lattice) -> Lattice:
    parts = zip((one.setups, one.poses, one.approaches), (other.setups, other.poses, other.approaches), strict=True)
    return Lattice(*(np.concatenate(both) for both in parts))
