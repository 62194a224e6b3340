"""Lines of a machine: where an axis was read, or is to be read, while the others stand still."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.machine.description import Machine
from axiscal.measurement.instrument import model_of, values_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

PLACES = 41
"""Places of a line: what a spline of a dozen knots does between two of them is below a hundredth of its size."""
_ALONG = 0.999
"""Cosine of 2.5 degrees: a set-up that reads further off a direction of the workpiece reads something else."""
_SAME = 1e-6
"""m or rad: two readings at one place."""

Seen = tuple[Literal["length", "angle"], int]
"""Whether a set-up reads lengths or angles, and along, or about, which direction x, y, z of the workpiece frame."""


@dataclass(frozen=True, eq=False)
class AxisLine:
    """Where one axis moves alone.

    axis : index of it; poses : (n, q) evenly from one end to the other, m or rad
    setup : the set-up that reads there, "" for none
    plus, minus : places read from either side, m or rad; both : places read from both
    """

    axis: int
    poses: Array
    setup: str = ""
    plus: tuple[float, ...] = ()
    minus: tuple[float, ...] = ()
    both: tuple[float, ...] = ()

    @property
    def positions(self) -> Array:
        """The coordinates of the axis along the line, (n,)."""
        result: Array = self.poses[:, self.axis]
        return result

    @property
    def read(self) -> int:
        """Number of places read."""
        return len(self.plus) + len(self.minus) - len(self.both)

    def at(self, positions: Sequence[float]) -> Array:
        """Return poses of the line at other positions of the axis, (len, q)."""
        poses = np.tile(self.poses[0], (len(positions), 1))
        poses[:, self.axis] = positions
        return poses


def seen_by(setup: Setup) -> Seen | None:
    """Return what a set-up reads along a line; None where it reads no line, or no direction of the workpiece."""
    several = len(setup.moves) != 1 or values_of(setup) > 1 or setup.base is not None
    if several or setup.chart is not None or setup.balls or setup.length is not None:
        return None
    along = int(np.argmax(np.abs(setup.direction)))
    if abs(setup.direction[along]) < _ALONG or setup.station is not None:
        return None
    return model_of(setup).reads, along


def line_of(setup: Setup, readings: Sequence[Reading], machine: Machine, whole: bool = False) -> AxisLine:
    """Return the line of a set-up that reads one: what was read of it, or may be where nothing was.

    whole : as far as it may be read, whatever was
    """
    (axis,) = setup.moves
    mine = [reading for reading in readings if reading.setup == setup.name]
    stands, ends = np.array(setup.park), setup.span(machine.axes[axis], axis)
    if mine:
        at = np.array([reading.pose for reading in mine])
        stands = np.median(at, axis=0)
        ends = ends if whole else (float(at[:, axis].min()), float(at[:, axis].max()))
    poses = np.tile(stands, (PLACES, 1))
    poses[:, axis] = np.linspace(*ends, PLACES)
    return AxisLine(axis, poses, setup.name, *_places(mine, axis))


def through_the_volume(description: CampaignDescription, axis: int, readings: Sequence[Reading] = ()) -> AxisLine:
    """Return the line along, or about, an axis through the middle of the target's volume.

    Other rotary axes stand at zero where that is inside.  readings : those count that were taken with others moving
    """
    machine, (low, high) = description.machine, np.array(description.target.volume).T
    zero = np.array([each.rotary for each in machine.axes]) & (low <= 0) & (high >= 0)
    poses = np.tile(np.where(zero, 0.0, (low + high) / 2), (PLACES, 1))
    poses[:, axis] = np.linspace(low[axis], high[axis], PLACES)
    moving = {setup.name for setup in description.setups if axis in setup.moves}
    mine = [reading for reading in readings if reading.setup in moving]
    return AxisLine(axis, poses, "", *_places(mine, axis))


def _places(readings: Sequence[Reading], axis: int) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    """Return the positions read from +, from − and from both, each once, in rising order."""
    plus, minus = (_once(reading.pose[axis] for reading in readings if reading.approach[axis] == k) for k in (1, -1))
    return plus, minus, tuple(place for place in plus if any(abs(place - other) < _SAME for other in minus))


def _once(positions: Iterable[float]) -> tuple[float, ...]:
    at = sorted(positions)
    return tuple(here for here, before in zip(at, [-np.inf, *at], strict=False) if here - before > _SAME)
