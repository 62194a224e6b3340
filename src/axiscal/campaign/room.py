"""Room to come to a place from the side that was planned: at the ends of a travel there is none."""

from __future__ import annotations

import math

from axiscal.error_model.model import ErrorModel
from axiscal.gcode.options import Options
from axiscal.machine.axis import Axis
from axiscal.measurement.setup import Setup
from axiscal.units import from_unit, to_unit

Pose = tuple[float, ...]
Approach = tuple[int, ...]

_SLACK = 1e-9


def with_room(errors: ErrorModel, setup: Setup, pose: Pose, approach: Approach) -> tuple[Pose, Approach]:
    """Return a place near the planned one that can be come to from the planned side.

    Where the side matters, because the axis has a reversal value, the place moves inward by as much as the overrun
    lacks; where it does not, the place stays and the side is left open.
    """
    reverses = {function.axis for function in errors.functions if function.kind == "reversal"}
    at, come = [_readable(axis, value) for axis, value in zip(errors.machine.axes, pose, strict=True)], list(approach)
    for k, axis in enumerate(errors.machine.axes):
        inward = _inward(axis, at[k], approach[k], setup.raster[k])
        if inward is not None and k in reverses:
            at[k] = inward
        elif inward is not None:
            come[k] = 0
    return tuple(at), tuple(come)


def _readable(axis: Axis, position: float) -> float:
    """Return a position that a person can dial in: to the micrometre, or a ten-thousandth of a degree."""
    unit, digits = ("deg", 4) if axis.rotary else ("mm", 3)
    rounded = from_unit(round(to_unit(position, unit), digits), unit)
    return min(max(rounded, axis.travel[0]), axis.travel[1])


def _inward(axis: Axis, position: float, side: int, raster: float) -> float | None:
    """Return the nearest position that leaves room for the overrun; None if there is room. A full turn has no ends."""
    if side == 0 or axis.cyclic:
        return None
    low, high = axis.travel
    overrun = Options().overrun(axis)
    nearest = low + overrun if side > 0 else high - overrun
    if side * (position - nearest) >= -_SLACK:
        return None
    if raster <= 0:
        return nearest
    steps = nearest / raster
    return raster * (math.ceil(steps - _SLACK) if side > 0 else math.floor(steps + _SLACK))
