"""Room to come to a place from the side that was planned: at the ends of a travel there is none."""

from __future__ import annotations

import math

from axiscal.errors.model import ErrorModel
from axiscal.estimation.case import Case
from axiscal.machine.axis import Axis
from axiscal.machine.motion import inward
from axiscal.measurement.place import Place, Places
from axiscal.measurement.setup import Setup
from axiscal.units import from_unit, to_unit

Pose = tuple[float, ...]
Approach = tuple[int, ...]

_SLACK = 1e-6
"""Share of a step: rounding of a position that stands on the step already."""
_DIGITS = {False: ("mm", 3), True: ("deg", 4)}
"""Unit and decimals of what a person can dial in: the micrometre, a ten-thousandth of a degree."""


def with_rooms(case: Case, places: Places) -> tuple[Place, ...]:
    """Return places, each with room to come to it from its side."""
    rows = zip(places.setups.tolist(), places.poses.tolist(), places.approaches.astype(int).tolist(), strict=True)
    setups, found = case.description.setups, list[Place]()
    for setup, pose, approach in rows:
        found.append(Place(setups[setup].name, *with_room(case.errors, setups[setup], tuple(pose), tuple(approach))))
    return tuple(found)


def with_room(errors: ErrorModel, setup: Setup, pose: Pose, approach: Approach) -> tuple[Pose, Approach]:
    """Return a place near the planned one that can be approached from the planned side.

    The place moves inward by the lack of overrun if the side matters, because the axis has a reversal value. Otherwise
    the place stays and the side is left open.
    """
    if setup.chart is not None:  # its places leave room for the approach, and lie where the chart has them
        return pose, approach
    at, come = [_readable(axis, value) for axis, value in zip(errors.machine.axes, pose, strict=True)], list(approach)
    for k, axis in enumerate(errors.machine.axes):
        place = _with_room(axis, at[k], approach[k], setup.raster[k])
        if place != at[k] and k in errors.reversing:
            at[k] = place
        elif place != at[k]:
            come[k] = 0
    return tuple(at), tuple(come)


def _readable(axis: Axis, position: float) -> float:
    """Return a position that a person can dial in."""
    unit, digits = _DIGITS[axis.rotary]
    rounded = from_unit(round(to_unit(position, unit), digits), unit)
    return min(max(rounded, axis.travel[0]), axis.travel[1])


def _with_room(axis: Axis, position: float, side: int, raster: float) -> float:
    """Return the position, or the nearest one on the raster that leaves room for the overrun."""
    nearest = inward(axis, position, side)
    if nearest == position:
        return position
    unit, digits = _DIGITS[axis.rotary]
    step = raster if raster > 0 else from_unit(10.0**-digits, unit)
    return step * (math.ceil(nearest / step - _SLACK) if side > 0 else math.floor(nearest / step + _SLACK))
