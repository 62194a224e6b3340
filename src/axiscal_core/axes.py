"""The nominal chain of axes, read from the workpiece to the tool.

    >>> axes = [Axis.linear("X", "x", ("0 mm", "600 mm")), Axis.turning("C", "z", (0, 6.28))]
    >>> chain(axes, np.array([[0.1, 0.0]]), tool=np.array([0, 0, -0.2])).tcp
    array([[ 0.1,  0. , -0.2]])

On the tool side the frame of an axis stands behind the travel of a carriage and before the turn of a rotor. On the
workpiece side, read in this direction, it is the other way round.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from axiscal_core import rigid
from axiscal_core.refusals import Array, InputError, finite, named, one, one_of, within
from axiscal_core.units import METRES, RADIANS, Of, Quantity, quantities, si

DIRECTIONS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
Link = Any  # an axis of whoever has `rotary`, `direction`, `origin` and `workpiece_side`, ours or the product's
_LONGEST = {METRES: 200.0, RADIANS: 40.0}  # no axis goes farther
Direction = str | Sequence[float]
""" "x", "-y", or three numbers."""


def unit_vector(direction: Direction, function: str, argument: str) -> Array:
    """Return a direction as a vector of length one, (3,)."""
    if isinstance(direction, str):
        bare = direction.removeprefix("-")
        one_of(function, argument, bare, [*DIRECTIONS])
        return np.array(DIRECTIONS[bare]) * (-1 if direction.startswith("-") else 1)
    vector = finite(function, argument, direction, (3,))
    length = float(np.linalg.norm(vector))
    if length == 0:
        raise InputError(function, argument, "has no length", 'Give "x", or three numbers that are not all zero')
    return vector / length


@dataclass(frozen=True, eq=False)
class Axis:
    """One axis.  Make it with `linear` or `turning`.

    direction : (3,) of travel or turn; origin : (3,) a point on a rotary axis, m; travel : from, to, m or rad
    workpiece_side : it carries the workpiece; overrun : how far beyond a place it goes before it turns, m or rad
    """

    name: str
    rotary: bool
    direction: Array
    travel: tuple[float, float]
    workpiece_side: bool
    origin: Array
    overrun: float

    @classmethod
    def linear(
        cls, name: str, along: Direction, travel: Sequence[Quantity], on_workpiece: bool = False,
        overrun: Quantity | None = None,
    ) -> Axis:  # fmt: skip
        """Return a carriage."""
        return cls._made("Axis.linear", name, False, along, travel, on_workpiece, (0.0, 0.0, 0.0), overrun)

    @classmethod
    def turning(
        cls, name: str, about: Direction, travel: Sequence[Quantity], origin: Sequence[Quantity] = (0.0, 0.0, 0.0),
        on_workpiece: bool = False, overrun: Quantity | None = None,
    ) -> Axis:  # fmt: skip
        """Return a rotor.  origin : a point on its axis where all axes stand at zero"""
        return cls._made("Axis.turning", name, True, about, travel, on_workpiece, origin, overrun)

    @classmethod
    def _made(
        cls, function: str, name: str, rotary: bool, direction: Direction, travel: Sequence[Quantity],
        on_workpiece: bool, origin: Sequence[Quantity], overrun: Quantity | None,
    ) -> Axis:  # fmt: skip
        of = RADIANS if rotary else METRES
        one(function, "on_workpiece", on_workpiece, bool, "True or False")
        low, high = quantities(travel, function, "travel", (2,), [of]).tolist()
        if low >= high:
            raise InputError(function, "travel", f"goes from {low:g} to {high:g}", "Give the lower end first")
        if high - low > _LONGEST[of]:
            remedy = 'Numbers are m and rad: write "400 mm", "90 deg"'
            raise InputError(function, "travel", f"goes from {low:g} to {high:g} {of[0]}", remedy)
        # 1 mm or 1 deg is usual, but no more than a hundredth of the travel
        usual = min(np.pi / 180 if rotary else 1e-3, (high - low) / 100)
        over = usual if overrun is None else within(function, "overrun", si(overrun, function, "overrun", of), 0.0)
        way = unit_vector(direction, function, "about" if rotary else "along")
        at = quantities(origin, function, "origin", (3,), [METRES])
        return cls(named(function, "name", name), rotary, way, (low, high), on_workpiece, at, over)

    @property
    def length(self) -> float:
        """The travel, m or rad."""
        return self.travel[1] - self.travel[0]

    @property
    def of(self) -> Of:
        """What its coordinate is."""
        return RADIANS if self.rotary else METRES

    @property
    def cyclic(self) -> bool:
        """True for one whole turn: both ends are one place."""
        return self.rotary and abs(self.length - 2 * np.pi) < 1e-9


class Frames(NamedTuple):
    """Axis frames and TCP in the workpiece frame.

    rotations : (q, m, 3, 3) R_k; origins : (q, m, 3) m; tcp : (m, 3) m; tool : (m, 3, 3) R_t, of the tool
    """

    rotations: Array
    origins: Array
    tcp: Array
    tool: Array

    @property
    def stem(self) -> Array:
        """Unit vectors from the tip of the tool to the spindle, (m, 3)."""
        return self.tool[:, :, 2]


def chain(axes: Sequence[Link], poses: Array, tool: Array, held: Array | None = None) -> Frames:
    """Return the nominal frames.

    poses : (m, q); tool : (3,) the tool point where all axes stand at zero, m; held : (3, 3) the tool's turn there
    """
    motion = rigid.identity(len(poses))
    rotations, origins = [], []
    for axis, coordinate in zip(axes, poses.T, strict=True):
        motion = to_frame(axis, motion, coordinate, None)
        rotations.append(motion.rotation)
        origins.append(motion.translation)
        motion = from_frame(axis, motion, coordinate, None)
    turned = motion.rotation if held is None else motion.rotation @ held
    return Frames(np.array(rotations), np.array(origins), motion.apply(tool), turned)


def to_frame(axis: Link, motion: rigid.Motion, coordinate: Array, tilt: Array | None) -> rigid.Motion:
    """Return the motion up to the frame of an axis.  tilt : (m, 3, 3) of the direction of travel, None for none"""
    if axis.rotary:
        motion = motion.shifted(np.array(axis.origin))
        return motion.then(_turn(axis, coordinate)) if axis.workpiece_side else motion
    return motion if axis.workpiece_side else motion.shifted(_travel(axis, coordinate, tilt))


def from_frame(axis: Link, motion: rigid.Motion, coordinate: Array, tilt: Array | None) -> rigid.Motion:
    """Return the motion from the frame of an axis to that of the next one; arguments as for `to_frame`."""
    if axis.rotary:
        motion = motion if axis.workpiece_side else motion.then(_turn(axis, coordinate))
        return motion.shifted(-np.array(axis.origin))
    return motion.shifted(_travel(axis, coordinate, tilt)) if axis.workpiece_side else motion


def _travel(axis: Link, coordinate: Array, tilt: Array | None) -> Array:
    straight = np.outer(coordinate, axis.direction)
    return straight if tilt is None else np.einsum("mij,mj->mi", tilt, straight)


def _turn(axis: Link, coordinate: Array) -> Array:
    return rigid.turned_about(np.array(axis.direction), coordinate)
