"""From the belief to tables: what a correction along one axis, over one axis, can take away, and at which points.

A carriage that is told to go c(t) less far moves the TCP by −c(t) along the axis. The best c(t), in least squares over
the volume, is the mean deviation along the axis at t over all positions of the others. It holds the positioning error
of the axis and, through the mean lever arm, its angular errors. Over the position of *another* axis the same mean holds
straightness and squareness. A table is not that curve but a line between points, so its values are the ones whose line
is nearest to the curve.

The deviation is the posterior mean: a part that the readings did not show shrinks to zero and gets no correction. A
point in a cell that was read takes the rest of the cell as well. So a table leaves only the scatter at the targets of a
test.

A line between two points is off by about h² |f''| / 8: points belong where the curve bends, for a control that takes
them anywhere. They are set one by one where the line is farthest from the curve. They begin with the ends, or with the
knots of the errors: only there the bend of a spline differs on both sides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.numerics import Array
from axiscal.tables.conditional import mean_along, turned
from axiscal.tables.table import CompensationTable, Hats
from axiscal.units import format_quantity
from axiscal_core.machine import Machine

SAMPLES = 1025
"""Places at which curve and line are compared; a table has some tens of points."""
_DECIMALS, _APART = 9, 1e-6
"""m or rad: knots nearer than rounding are one, and one that is as near to an end is that end."""
_NOT_APART = 1e-10
"""m or rad: nearer than this no point is needed."""

_POINTS_PER_INTERVAL = 4
MOST_POINTS = 129
"""So that no one has to leaf through a table; four an interval are rarely more than a hundred."""
_NOTHING = 1e-12
"""m or rad: rounding."""
_NEARER = 1e-8
"""m or rad: by so much points elsewhere have to bring the line nearer, for no control shows less."""
_WORTH = 0.9
"""A table that leaves more than this of what was found, √(values² + u²), is none."""
_EDGE = 1e-6
"""Share of a cell: just inside its edge."""
_SILENT, _DIFFERENCE = 0.95, 0.65
_OPEN = 0.2  # where the prior was this narrow by construction, next to the table's zero, nothing is said

Spacing = float | Mapping[str, float] | None
"""Distance of the points: of all linear axes, m, or of some axes by name, m or rad."""
Multiples = tuple[float | None, float | None]


def axis_tables(
    estimate: Estimate,
    spacing: Spacing = None,
    most: int = MOST_POINTS,
    multiples: Multiples = (None, None),
    told: bool = True,
) -> tuple[CompensationTable, ...]:
    """Return a table for every axis whose positioning deviation the belief knows.

    spacing, most : as for `points`; multiples : the multiple of a linear axis, m, and of a rotary one, rad
    told : False for those that readings do not tell from nought
    Raises TableError for a spacing that does not divide a travel, or needs more points than fit.
    """
    model, found = estimate.model, list[CompensationTable]()
    for k in sorted({function.axis for function in model.curves}):
        at = points(model, k, spacing, most, multiples[model.axes[k].rotary])
        found.append(own_table(estimate, k, at))
    return tuple(table for table in found if table.told is told)


def cross_tables(
    estimate: Estimate,
    spacing: Spacing = None,
    most: int = MOST_POINTS,
    multiple: float | None = None,
    uneven: bool = False,
    told: bool = True,
) -> tuple[CompensationTable, ...]:
    """Return tables of linear axes over the positions of the other linear axes: straightness, sag and squareness.

    Where no reading has seen how one moves over another there is no table.  Arguments and failures as for `axis_tables`
    uneven : points may stand anywhere, and stand where the line is nearest to the curve
    """
    axes, found = [k for k, axis in enumerate(estimate.machine.axes) if not axis.rotary], list[CompensationTable]()
    for over in axes:
        hats = hats_along(estimate, over, points(estimate.model, over, spacing, most, multiple))
        for axis in (axis for axis in axes if axis != over):
            curves = curves_at(estimate, axis, over, hats.nodes)
            if np.ptp(curves @ estimate.mean) > _NOTHING:  # no table over another axis holds a constant
                table = _fitted(estimate, axis, over, hats, curves)
                table = _nearest(estimate, table) if uneven else table
                found.append(replace(table, told=table.told and estimate.sees(curves.mean(axis=0))))
    return tuple(table for table in found if table.told is told)


def backlash(estimate: Estimate) -> dict[str, float]:
    """Return by how much each axis stops short after it has turned round, m or rad; below zero where it runs ahead."""
    found = {}
    for table in axis_tables(estimate):
        at = np.linspace(*estimate.box[estimate.machine.index(table.axis)], 1001)
        found[table.axis] = float(np.mean(table.deviation(at, -1) - table.deviation(at, 1)))
    return found


def own_table(estimate: Estimate, axis: int, positions: Array, uneven: bool = False) -> CompensationTable:
    """Return the table of an axis over its own position.

    positions : (n,) m or rad, increasing; uneven : as many may stand elsewhere between the first and the last
    """
    hats = hats_along(estimate, axis, positions)
    even = _fitted(estimate, axis, axis, hats, curves_at(estimate, axis, axis, hats.nodes))
    return _nearest(estimate, even) if uneven else even


def points(
    model: Machine, axis: int, spacing: Spacing = None, most: int = MOST_POINTS, multiple: float | None = None
) -> Array:
    """Return evenly spaced positions that cover the travel of an axis.

    spacing : their distance, on linear axes unless an axis is named; most : how many fit
    multiple : the distance shall be a multiple of this, m or rad; the last point may then lie beyond the travel
    Raises TableError for a spacing that does not divide the travel, or needs more points than fit.
    """
    own = model.axes[axis]
    start, stop = own.travel
    chosen = spacing.get(own.name) if isinstance(spacing, Mapping) else None if own.rotary else spacing
    if chosen is not None:
        count = min(max(round((stop - start) / chosen), 1), most - 1)
        if abs(count * chosen - (stop - start)) > 1e-9:
            near, shown, travel = (format_quantity(x, own.unit) for x in ((stop - start) / count, chosen, stop - start))
            what = "{shown} does not divide the {travel} of {name} into {most} parts or fewer"
            remedy = "{near} would, or leave the spacing out"
            raise TableError(what, remedy, shown=shown, travel=travel, name=own.name, near=near, most=most - 1)
        return np.linspace(start, stop, count + 1)
    intervals = max((len(f.spline.knots) - 1 for f in model.curves if f.axis == axis), default=1)
    count = max(min(_POINTS_PER_INTERVAL * intervals, most - 1), 1)
    if multiple is None:
        return np.linspace(start, stop, count + 1)
    steps = (stop - start) / multiple
    if own.cyclic:
        count = max(n for n in range(1, count + 1) if abs(steps / n - round(steps / n)) < 1e-6)
        return np.linspace(start, stop, count + 1)
    first = np.floor(start / multiple + 1e-6) * multiple
    step = np.ceil((stop - first) / count / multiple - 1e-6) * multiple
    spread: Array = first + step * np.arange(int(np.ceil((stop - first) / step - 1e-6)) + 1)
    return spread


def curves_at(estimate: Estimate, axis: int, over: int, at: Array) -> Array:
    """Return the mean deviation along an axis at positions of one (m,), increasing, as rows (s, m, size).

    There is one for each side from which a position is reached, one where they make no difference. Of a rotary axis it
    is the rotation.
    """
    model, at = estimate.model, _read_at(estimate, over, at)
    sides = (1, -1) if over in model.reversing else (1,)
    if model.axes[axis].rotary:
        return np.stack([turned(model, estimate.box, axis, at, sign) for sign in sides])
    return np.stack([mean_along(model, estimate.box, axis, over, at, sign) for sign in sides])


def _read_at(estimate: Estimate, axis: int, positions: Array) -> Array:
    """Return positions of an axis, and beyond what was read the end of that: a table is constant there."""
    return np.clip(positions, *estimate.read[axis]) if estimate.read else positions


def hats_along(estimate: Estimate, over: int, positions: Array) -> Hats:
    """Return the hats on positions of an axis, for curves with the knots of its errors."""
    knots = np.concatenate([np.array(estimate.read[over : over + 1]).ravel(), *estimate.model.knots_along(over)])
    closed = estimate.machine.axes[over].cyclic
    return Hats.on(positions, knots if len(knots) else positions, estimate.box[over], closed)


def _nearest(estimate: Estimate, even: CompensationTable) -> CompensationTable:
    """Return a table with as many points, set so that its line is nearest to the curve; never farther than `even`."""
    axis, over = estimate.machine.index(even.axis), estimate.machine.index(even.over)
    at = np.linspace(even.positions[0], even.positions[-1], SAMPLES)
    knots, shown = np.concatenate([np.zeros(0), *estimate.model.knots_along(over)]), curves_at(estimate, axis, over, at)
    hats = hats_along(estimate, over, closest(shown @ estimate.mean, at, knots, even.positions))
    found = _fitted(estimate, axis, over, hats, curves_at(estimate, axis, over, hats.nodes))
    return found if found.departure < even.departure - _NEARER else even  # along a straight line any are as near


def _fitted(estimate: Estimate, axis: int, over: int, hats: Hats, curves: Array) -> CompensationTable:
    """Return the table nearest to curves given as rows (s, nodes, size), forward and reverse."""
    free = np.stack([hats.best(side) for side in curves])
    anchor = _anchor(estimate, axis, over, hats, curves, free)
    shown = curves @ estimate.mean - anchor @ estimate.mean
    values = hats.best(shown.T).T
    counts, at = np.any(free, axis=(0, 1)) | (anchor != 0), hats.points
    rows, off = free[:, :, counts], anchor[counts]
    rows_of = rows, rows - off, rows - rows.mean(axis=(0, 1)), _bent(rows, at)

    def stds(root: Array) -> list[Array]:
        """Return standard deviations of the values, the larger of both directions, (points,), by F with F Fᵀ.

        Before a constant is taken off, after it, less the mean over the table, and less the best-fit line of each
        direction, which may be how the part lies.
        """
        return [np.sqrt(np.max(np.sum((each @ root[counts]) ** 2, axis=-1), axis=0)) for each in rows_of]

    wide, known, shape, _ = stds(estimate.factor)
    wide_before, before, *_ = stds(estimate.model.root())
    rest = float(sum(estimate.model.curves[index].rest for index in _followed(estimate, axis, over)))
    departure = max(hats.departure(curve, line) for curve, line in zip(shown, values, strict=True))
    values = values + _rest_read(estimate, axis, over, hats.points)
    own, looked_up = estimate.machine.axes[axis], estimate.machine.axes[over]
    # Where readings said nothing the deviation is as uncertain as before, and so is its difference to the zero point of
    # the table, up to the knowledge at that point: readings that leave the constant open may still know the curve.
    silent: NDArray[np.bool_] = (wide >= _SILENT * wide_before) & (known >= _DIFFERENCE * before)
    silent &= before > _OPEN * np.max(before)
    # They tell a table that takes away a tenth of √(values² + u²), as it stands, or its shape: of the answer; over the
    # volume only where that counts.
    shapes, told = (values, values - values.mean(), _bent(values[..., None], at)), False
    for each, spread in zip(shapes, stds(estimate.factor if estimate.open is None else estimate.open)[1:], strict=True):
        size, u = np.sqrt(np.mean(each**2)), np.hypot(np.sqrt(np.mean(spread**2)), rest)
        told |= bool(u < _WORTH * np.hypot(size, u) and size > _NOTHING)
    return CompensationTable(
        own.name,
        at,
        values[0],
        values[-1],
        np.hypot(known, rest),
        looked_up.name,
        silent,
        departure,
        float(np.hypot(np.sqrt(np.mean(shape**2)), rest)),
        (own.name, looked_up.name) in estimate.told or (estimate.whole and told),
    )


def _bent(rows: Array, along: Array) -> Array:
    """Return rows (s, points, n) less the best-fit line of each over the points.  along : (points,)"""
    line = np.stack([np.ones(len(along)), along - along.mean()], axis=1)
    fitted: Array = line @ (np.linalg.pinv(line) @ rows)
    return rows - fitted


def _anchor(estimate: Estimate, axis: int, over: int, hats: Hats, curves: Array, values: Array) -> Array:
    """Return the constant that is taken off, of curves (s, nodes, …) and the values at the points (s, points, …).

    Without rotary axes the workpiece's zero takes up a constant. So every table is zero where the axis is, and all of
    them add nothing at machine zero. With rotary axes the place of the rotor matters: the constant stays in the axis'
    own table, once, and the others have mean zero.
    """
    if not any(a.rotary for a in estimate.machine.axes):
        return hats.at(float(np.clip(0.0, *hats.points[[0, -1]])), values.mean(axis=0))
    if axis == over:
        return np.zeros(curves.shape[2:])
    mean: Array = hats.weights @ curves.mean(axis=0) / hats.weights.sum()
    return mean


def _rest_read(estimate: Estimate, axis: int, over: int, points: Array) -> Array:
    """Return what the readings say of that rest at the points of a table, (points,), nothing in cells not read.

    Where a table is zero it stays zero. Over another axis of a machine that turns the error looks another way at every
    pose, and nothing is said.
    """
    turns = any(each.rotary for each in estimate.machine.axes)
    if axis != over and turns:
        return np.zeros(len(points))
    sign = float(estimate.machine.axes[over].sign * np.sum(estimate.machine.axes[axis].direction))
    at, read = _read_at(estimate, over, points), np.zeros(len(points))
    for index in _followed(estimate, axis, over):
        step = _EDGE * estimate.model.curves[index].sides[0].cell
        after, before = (estimate.rest_at(index, at + side * step) for side in (1, -1))
        read += sign * np.where(after != 0, after, before)  # on an edge of cells that of the other side
    return read if turns else read - np.interp(np.clip(0.0, *points[[0, -1]]), points, read)


def _followed(estimate: Estimate, axis: int, over: int) -> list[int]:
    """Return the indices of the errors that a table follows directly."""
    name = f"E{estimate.machine.axes[axis].positioning_error[1]}{estimate.machine.axes[over].name}"
    return [index for index, function in enumerate(estimate.model.curves) if function.name == name]


def closest(curves: Array, at: Array, knots: Array, even: Array) -> Array:
    """Return no more positions than `even` has, whose line is nearest to curves: the fewest of those that are as near.

    curves : (s, n) forward and reverse, m or rad; at : (n,) increasing, from the first to the last position of a table
    knots : of the errors
    """

    def farthest(points: Array) -> tuple[float, float]:
        """Return how far the line through points of the curves is from them at the most, and where."""
        lines = np.stack([np.interp(at, points, np.interp(points, at, curve)) for curve in curves])
        apart = np.abs(curves - lines).max(axis=0)
        return float(apart.max()), float(at[int(np.argmax(apart))])

    distinct, found = np.unique(np.round(knots, _DECIMALS)), [even]
    inner = distinct[(distinct > at[0] + _APART) & (distinct < at[-1] - _APART)]
    for points in (at[[0, -1]], np.concatenate([at[:1], inner, at[-1:]])):
        while len(points) < len(even):
            apart, place = farthest(points)
            if apart < _NOT_APART or np.min(np.abs(points - place)) < (at[-1] - at[0]) / SAMPLES:
                break
            points = np.sort(np.append(points, place))
        found += [points] if len(points) <= len(even) else []
    off = [farthest(points)[0] for points in found]
    near = [points for points, each in zip(found, off, strict=True) if each <= min(off[0], min(off) + _NEARER)]
    return min(near, key=len)
