"""Where to start on a machine whose errors simply add up: every point of a fine lattice, from tables of axis pairs.

Without lever arms a row is a sum over the axes, g(t) = g_0 + Σ_k g_k(t_k). Both forms of the gain are then sums over
pairs of axes (the stacked splines of B&H eq. 28-33). With few axes every point of the tensor lattice is looked at, with
many each of a number of starts climbs it axis by axis.

A quadratic form of a sum over axes is held as one table per axis and one per pair of axes:

    |v_0 + Σ_k v_k(t_k)|² = constant + Σ_k single_k[t_k] + Σ_{k<l} double_kl[t_k, t_l]
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.model import ErrorModel
from axiscal.measurement.candidates import knot_lattice, raster_positions
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array, even_points
from axiscal.numerics.remembered import remembered
from axiscal.numerics.ties import TIE, first_best_each
from axiscal.planning.gains.gain import Scorer
from axiscal.planning.step.ground import sides

_PER_INTERVAL = 8
_EVERY_POINT = 300_000
_CLIMBERS = 64
"""Starts where the lattice is too large to be looked at as a whole."""
_SWEEPS = 30
"""Sweeps end where none rises; this only ends what would go round."""
_ADDS_UP = 1e-12
"""Rounding of a sum over the axes; a lever arm that is missing is millions of times larger."""
_LOOKS = 3
"""Poses that are looked at: rows that do not add up differ at almost every pose."""
_POINTS = 20_000
_FINEST = 16


@dataclass(frozen=True, eq=False, slots=True)
class Starts:
    """Candidates of one set-up that no neighbour on a lattice beats.

    poses, approaches : (m, q); gains : (m,)
    """

    poses: Array
    approaches: Array
    gains: Array


def adds_up(observation: Observation, setup: int) -> bool:
    """Return whether the rows of a set-up are sums over its axes, looked at in a few poses."""
    return _adds_up(observation.errors, observation.setups[setup])


@remembered
def _adds_up(errors: ErrorModel, mounted: Setup) -> bool:
    """Return the same, which does not depend on what was read, nor on the other set-ups."""
    moves = mounted.moves
    if len(moves) == 1:
        return True
    if any(set(plane.axes) <= set(moves) for plane in errors.planes):
        return False
    park = np.array(mounted.park)
    poses = np.tile(park, (_LOOKS, len(moves) + 1, 1))
    for i, share in enumerate(even_points(_LOOKS, len(moves)).T):
        axis = errors.machine.axes[moves[i]]
        poses[:, [0, i + 1], moves[i]] = (axis.travel[0] + axis.length * share)[:, None]
    flat = np.concatenate([park[None], poses.reshape(-1, len(park))])
    rows = Observation(errors, (mounted,)).rows(0, flat, np.zeros_like(flat)).rows
    parked, rows = rows[0], rows[1:].reshape(_LOOKS, len(moves) + 1, -1)
    apart = rows[:, 0] - parked - (rows[:, 1:] - parked).sum(axis=1)
    return bool(np.all(np.abs(apart) <= _ADDS_UP * np.abs(rows).max(axis=(0, 1))))


def starts(scorer: Scorer, setup: int) -> Starts:
    """Return the points that no neighbour beats on a fine lattice over a set-up that adds up."""
    stack = stack_of(scorer.observation, setup)
    sizes = [len(grid.positions) for grid in stack.grids]
    above, below = stack.tables(scorer)
    if np.prod(sizes) <= _EVERY_POINT:
        points, gains = peaks(above.everywhere() / below.everywhere())
    else:
        points, gains = _climbed(above, below, sizes)
    poses = np.tile(np.array(scorer.observation.setups[setup].park), (len(points), 1))
    approaches = np.zeros_like(poses)
    for grid, index in zip(stack.grids, points.T, strict=True):
        poses[:, grid.axis], approaches[:, grid.axis] = grid.positions[index], grid.signs[index]
    return Starts(poses, approaches, gains)


@dataclass(frozen=True, eq=False, slots=True)
class Grid:
    """Places positions of one axis, (p,), with the sign of the approach, (p,), and what they add.

    columns : (c,) of the rows that change along the axis; rows : (p, c); variances : (p,)
    """

    axis: int
    positions: Array
    signs: Array
    columns: NDArray[np.intp]
    rows: Array
    variances: Array


@dataclass(frozen=True, eq=False, slots=True)
class StackedStarts:
    """The lattice of one set-up: the row (n,) and variance of the parked pose, and what each axis adds."""

    row: Array
    variance: float
    grids: list[Grid]

    def tables(self, scorer: Scorer) -> tuple[Pairs, Pairs]:
        """Return numerator and denominator of the gain on the tensor lattice."""
        parked, parts = self.row @ scorer.both, [scorer.both[g.columns] for g in self.grids]
        rows, rank = [g.rows for g in self.grids], scorer.rank
        above = Pairs.from_parts(parked[rank:], rows, [p[:, rank:] for p in parts])
        below = Pairs.from_parts(parked[:rank], rows, [p[:, :rank] for p in parts])
        return above, below.plus(self.variance, [g.variances for g in self.grids])


@remembered
def stack_of(observation: Observation, setup: int) -> StackedStarts:
    """Return the lattice of a set-up that adds up."""
    mounted = observation.setups[setup]
    park = np.array([mounted.park])
    parked = observation.rows(setup, park, np.zeros_like(park))
    row, variance = parked.rows[0], float(parked.variances[0])
    return StackedStarts(row, variance, [_grid(observation, setup, axis, row, variance) for axis in mounted.moves])


def _grid(observation: Observation, setup: int, axis: int, parked: Array, variance: float) -> Grid:
    mounted = observation.setups[setup]
    positions = _positions(observation, setup, axis)
    signs = np.full(len(positions), float(mounted.sides[0]))
    if len(mounted.sides) > 1 and axis in observation.errors.reversing:
        positions, signs = np.tile(positions, 2), np.concatenate([signs, -signs])
    poses = np.tile(np.array(mounted.park), (len(positions), 1))
    approaches = np.zeros_like(poses)
    poses[:, axis], approaches[:, axis] = positions, signs
    seen = observation.rows(setup, poses, approaches)
    added = seen.rows - parked
    columns = np.flatnonzero(np.any(added != 0, axis=0))
    return Grid(axis, positions, signs, columns, added[:, columns], seen.variances - variance)


def _positions(observation: Observation, setup: int, axis: int) -> Array:
    mounted = observation.setups[setup]
    if mounted.raster[axis] > 0:
        return raster_positions(observation.machine, mounted, axis)
    return knot_lattice(observation, setup, axis, _PER_INTERVAL)


def peaks(gains: Array) -> tuple[NDArray[np.intp], Array]:
    """Return the lattice points (n, axes) that gain no less than the points beside them, and their gains."""
    beaten = np.zeros(gains.shape, dtype=bool)
    for axis in range(gains.ndim):
        along, covered = np.moveaxis(gains, axis, 0), np.moveaxis(beaten, axis, 0)
        covered[:-1] |= along[1:] > along[:-1]
        covered[1:] |= along[:-1] > along[1:]
    points = np.argwhere(~beaten)
    return points, gains[tuple(points.T)]


def _climbed(above: Pairs, below: Pairs, sizes: list[int]) -> tuple[NDArray[np.intp], Array]:
    """Return the lattice points that evenly spread starts reach, axis by axis, and their gains."""
    points = (even_points(_CLIMBERS, len(sizes)) * sizes).astype(np.intp)
    gains = np.zeros(len(points))
    for _ in range(_SWEEPS):
        before = gains
        for axis in range(len(sizes)):
            ratio = above.axis_forms(axis, points) / below.axis_forms(axis, points)
            points[:, axis] = first_best_each(ratio, TIE)
            gains = ratio[np.arange(len(ratio)), points[:, axis]]
        if np.all(gains <= before * (1 + 1e-12)):
            break
    _, first = np.unique(points, axis=0, return_index=True)
    return points[first], gains[first]


def dense_starts(scorer: Scorer, setup: int) -> Starts:
    """Return the points of a tensor lattice, as fine as _POINTS allow, that no neighbour beats, from every side."""
    mounted, positions = scorer.observation.setups[setup], _lattice(scorer, setup)
    lattice = np.stack([grid.ravel() for grid in np.meshgrid(*positions, indexing="ij")], axis=1)
    poses = np.tile(np.array(mounted.park), (len(lattice), 1))
    poses[:, list(mounted.moves)] = lattice
    found = []
    for side in sides(scorer.observation, setup):
        gains = scorer.gains(Places.of_setup(setup, poses, np.tile(side, (len(poses), 1))))
        where, best = peaks(gains.reshape([len(each) for each in positions]))
        top = np.ravel_multi_index(tuple(where.T), [len(each) for each in positions])
        found.append((poses[top], np.tile(side, (len(top), 1)), best))
    return Starts(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def _lattice(scorer: Scorer, setup: int) -> list[Array]:
    observation = scorer.observation
    mounted, machine = observation.setups[setup], observation.machine
    for parts in range(_FINEST, 0, -1):
        positions = [
            raster_positions(machine, mounted, k)
            if mounted.raster[k] > 0
            else knot_lattice(observation, setup, k, parts)
            for k in mounted.moves
        ]
        if np.prod([len(p) for p in positions]) <= _POINTS:
            break
    return [p[:: max(1, len(p) * len(positions) // 1024)] for p in positions]


@dataclass(frozen=True, eq=False, slots=True)
class Pairs:
    """The form on a tensor lattice: constant, per axis (p_k,), per pair k < l (p_k, p_l)."""

    constant: float
    single: list[Array]
    double: dict[tuple[int, int], Array]

    @classmethod
    def from_parts(cls, fixed: Array, rows: list[Array], parts: list[Array]) -> Pairs:
        """Return the tables for v_0 = fixed (x,) and v_k = rows_k (p_k, c_k) parts_k (c_k, x)."""
        axes = range(len(rows))
        single = [_quadratic(r, p @ p.T) + 2 * r @ (p @ fixed) for r, p in zip(rows, parts, strict=True)]
        double = {(k, m): 2 * rows[k] @ (parts[k] @ parts[m].T) @ rows[m].T for k in axes for m in axes if k < m}
        return cls(float(fixed @ fixed), single, double)

    def plus(self, constant: float, single: list[Array]) -> Pairs:
        """Return the form with a constant and a term per axis added."""
        return Pairs(self.constant + constant, [a + b for a, b in zip(self.single, single, strict=True)], self.double)

    def everywhere(self) -> Array:
        """Return the form at all points of the tensor lattice, (p_1, p_2, …)."""
        axes = range(len(self.single))
        result = np.full((1,) * len(axes), self.constant)
        for (k, m), table in self.double.items():
            result = result + table.reshape([len(self.single[i]) if i in (k, m) else 1 for i in axes])
        for k, values in enumerate(self.single):
            result = result + values.reshape([-1 if i == k else 1 for i in axes])
        return result

    def axis_forms(self, axis: int, points: NDArray[np.intp]) -> Array:
        """Return the form at every lattice position of one axis, (n, p_axis).  points : (n, axes), lattice indices."""
        rest = np.full(len(points), self.constant)
        result = np.tile(self.single[axis], (len(points), 1))
        for k, values in enumerate(self.single):
            if k != axis:
                rest += values[points[:, k]]
        for (k, m), table in self.double.items():
            if axis not in (k, m):
                rest += table[points[:, k], points[:, m]]
            else:
                result += table.T[points[:, m]] if k == axis else table[points[:, k]]
        result += rest[:, None]
        return result


def _quadratic(rows: Array, form: Array) -> Array:
    values: Array = np.einsum("pi,pi->p", rows @ form, rows)
    return values
