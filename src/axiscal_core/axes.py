"""The nominal chain of axes, read from the workpiece to the tool.

    >>> axes = [Axis.linear("X", "x", ("0 mm", "600 mm")), Axis.turning("C", "z", (0, 6.28))]
    >>> chain(axes, np.array([[0.1, 0.0]]), tool=np.array([0, 0, -0.2])).tcp
    array([[ 0.1,  0. , -0.2]])

On the tool side the frame of an axis stands behind the travel of a carriage and before the turn of a rotor. On the
workpiece side, read in this direction, it is the other way round.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from axiscal_core.refusals import Array, InputError, finite, named, one, one_of, within
from axiscal_core.rigid import Motion, identity, turned_about
from axiscal_core.units import METRES, RADIANS, Of, Quantity, quantities, si

DIRECTIONS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
Counting = Literal["iso", "reversed"]  # a positive coordinate moves the tool positively past the workpiece, or not
LINEAR_SPEED, LINEAR_ACCELERATION = 10.0 / 60.0, 1.0  # m/s, m/s²: the traverse of a carriage of which nothing is said
ROTARY_SPEED, ROTARY_ACCELERATION = math.radians(60.0), math.radians(360.0)  # rad/s, rad/s²: of a rotor
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


Three = tuple[float, float, float]


@dataclass(frozen=True)
class Axis:
    """One axis.  Make it with `linear` or `turning`.

    direction : of travel or turn, a unit vector in the machine frame; origin : a point on a rotary axis, m
    travel : from, to, m or rad; workpiece_side : it carries the workpiece
    overrun : how far beyond a place it goes before it turns, m or rad
    speed, acceleration : m/s or rad/s, m/s² or rad/s²
    turns : whole ones below and above a travel of one turn that the control allows, None where nobody said
    counting : as stated, None where nothing is said, which means ISO 841
    diameters : a cross slide of a lathe whose display shows diameters; coordinates here are radii all the same
    """

    name: str
    rotary: bool
    direction: Three
    travel: tuple[float, float]
    workpiece_side: bool
    origin: Three
    overrun: float
    speed: float = LINEAR_SPEED
    acceleration: float = LINEAR_ACCELERATION
    turns: tuple[int, int] | None = None
    counting: Counting | None = None
    diameters: bool = False

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
        stated = usual_overrun(rotary, high - low) if overrun is None else si(overrun, function, "overrun", of)
        over = within(function, "overrun", stated, 0.0)
        x, y, z = unit_vector(direction, function, "about" if rotary else "along").tolist()
        at_x, at_y, at_z = quantities(origin, function, "origin", (3,), [METRES]).tolist()
        quick = (ROTARY_SPEED, ROTARY_ACCELERATION) if rotary else (LINEAR_SPEED, LINEAR_ACCELERATION)
        name = named(function, "name", name)
        return cls(name, rotary, (x, y, z), (low, high), on_workpiece, (at_x, at_y, at_z), over, *quick)

    @property
    def letter(self) -> str:
        """Its kind by ISO 841: the name without the digit."""
        return self.name[:1]

    @property
    def sign(self) -> int:
        """+1 on the tool side, −1 on the workpiece side: s_k of the error model (conventions, Errors)."""
        return -1 if self.workpiece_side else 1

    @property
    def reversed(self) -> bool:
        """Whether its coordinate grows against the direction of ISO 841."""
        return self.counting == "reversed"

    @property
    def turned(self) -> Axis:
        """The axis if its coordinate grows the other way."""
        x, y, z = (0.0 - each for each in self.direction)
        return replace(self, direction=(x, y, z), counting="iso" if self.reversed else "reversed")

    @property
    def positioning_error(self) -> str:
        """Name of the error along (about) the axis itself: "EXX", "EXU", "ECC"."""
        sizes = [abs(part) for part in self.direction]
        along = sizes.index(max(sizes))
        return f"E{('ABC' if self.rotary else 'XYZ')[along]}{self.name}"

    @property
    def dimension(self) -> Literal["length", "angle"]:
        """What its coordinates are."""
        return "angle" if self.rotary else "length"

    @property
    def unit(self) -> str:
        """The unit in which its coordinates are written and shown: "mm" or "deg"."""
        return "deg" if self.rotary else "mm"

    @property
    def column(self) -> str:
        """The column of its coordinates in a file, "X_mm", or "X_radius_mm" where a display shows diameters."""
        return f"{self.name}{'_radius' * self.diameters}_{self.unit}"

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
        return self.rotary and abs(self.length - math.tau) <= 1e-9


def usual_overrun(rotary: bool, length: float) -> float:
    """Return 1 mm or 1 deg, but no more than a hundredth of the travel, m or rad."""
    return min(math.radians(1.0) if rotary else 1e-3, length / 100)


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


def chain(axes: Sequence[Axis], poses: Array, tool: Array, held: Array | None = None) -> Frames:
    """Return the nominal frames.

    poses : (m, q); tool : (3,) the tool point where all axes stand at zero, m; held : (3, 3) the tool's turn there
    """
    motion = identity(len(poses))
    rotations, origins = [], []
    for axis, coordinate in zip(axes, poses.T, strict=True):
        motion = to_frame(axis, motion, coordinate, None)
        rotations.append(motion.rotation)
        origins.append(motion.translation)
        motion = from_frame(axis, motion, coordinate, None)
    turned = motion.rotation if held is None else motion.rotation @ held
    return Frames(np.array(rotations), np.array(origins), motion.apply(tool), turned)


def to_frame(axis: Axis, motion: Motion, coordinate: Array, tilt: Array | None) -> Motion:
    """Return the motion up to the frame of an axis.  tilt : (m, 3, 3) of the direction of travel, None for none"""
    if axis.rotary:
        motion = motion.shifted(np.array(axis.origin))
        return motion.then(_turn(axis, coordinate)) if axis.workpiece_side else motion
    return motion if axis.workpiece_side else motion.shifted(_travel(axis, coordinate, tilt))


def from_frame(axis: Axis, motion: Motion, coordinate: Array, tilt: Array | None) -> Motion:
    """Return the motion from the frame of an axis to that of the next one; arguments as for `to_frame`."""
    if axis.rotary:
        motion = motion if axis.workpiece_side else motion.then(_turn(axis, coordinate))
        return motion.shifted(-np.array(axis.origin))
    return motion.shifted(_travel(axis, coordinate, tilt)) if axis.workpiece_side else motion


def _travel(axis: Axis, coordinate: Array, tilt: Array | None) -> Array:
    straight = np.outer(coordinate, axis.direction)
    return straight if tilt is None else np.einsum("mij,mj->mi", tilt, straight)


def _turn(axis: Axis, coordinate: Array) -> Array:
    return turned_about(np.array(axis.direction), coordinate)
