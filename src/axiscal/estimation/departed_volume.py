"""What a departure of size 1 does over the volume: as far as splines follow it, and what they leave of it."""

from __future__ import annotations

import numpy as np

from axiscal.accuracy.yardstick import Yardstick
from axiscal.measurement.departures import Departure, Family, joint_shape, shape
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered
from axiscal.numerics.spread import even_points

_POINTS = 400
"""Points along an axis for a mean of squares: a step is met to a four-hundredth of the travel."""


def field(yardstick: Yardstick, departure: Departure) -> tuple[Array, float]:
    """Return V φ (w, r), φ as far as splines follow it, and the mean square over the volume of what they do not, m²."""
    if departure.pair is not None:
        return _joint_field(yardstick, departure.place, departure.function or 0, departure.pair)
    return _field(yardstick, departure.family, departure.place, departure.function or 0)


@remembered
def _joint_field(yardstick: Yardstick, place: float, index: int, pair: tuple[int, int]) -> tuple[Array, float]:
    """Return no part that splines follow, and the mean square of what two axes do together."""
    axes, lever = yardstick.errors.machine.axes, yardstick.moments.levers[yardstick.errors.functions[index].name]
    poses = np.zeros((_POINTS, len(axes)))
    low, high = np.array([yardstick.box[k] for k in pair]).T
    poses[:, list(pair)] = low + (high - low) * even_points(_POINTS, 2)
    square = float(np.mean(joint_shape(place, pair, axes, poses) ** 2))
    return np.zeros((len(yardstick.root.matrix), 1)), lever * square


@remembered
def _field(yardstick: Yardstick, family: Family, place: float, index: int) -> tuple[Array, float]:
    function = yardstick.errors.functions[index]
    at, rows, nearest = _spline(yardstick, index)
    values = shape(family, place, function, yardstick.errors.machine.axes[function.axis], at)
    followed = nearest @ values
    lever = yardstick.moments.levers[function.name]
    beside = float(lever * np.sum(np.mean((values - rows @ followed) ** 2, axis=0)))
    return yardstick.root.matrix[:, function.columns] @ followed, beside


@remembered
def _spline(yardstick: Yardstick, index: int) -> tuple[Array, Array, Array]:
    """Return even points of an error over the volume (p,), its rows there (p, k), and their pseudo-inverse (k, p)."""
    function = yardstick.errors.functions[index]
    low, high = yardstick.box[function.axis]
    at = low + (high - low) * (np.arange(_POINTS) + 0.5) / _POINTS
    rows = function.basis.rows(at)
    nearest: Array = np.asarray(np.linalg.pinv(rows, rcond=max(rows.shape) * np.finfo(float).eps), dtype=float)
    return at, rows, nearest
