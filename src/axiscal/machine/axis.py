"""One linear or rotary axis of a machine (ISO 841 letters)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Literal

from axiscal.document import shown
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.units import format_quantity

LINEAR_LETTERS = "XYZUVWPQR"
ROTARY_LETTERS = "ABC"
LINEAR_SPEED = 10.0 / 60.0
"""Traverse of a linear axis where the description names none: 10 m/min, in m/s."""
LINEAR_ACCELERATION = 1.0
"""m/s²."""
ROTARY_SPEED = math.radians(60.0)
"""Traverse of a rotary axis where the description names none: 10 rpm, in rad/s."""
ROTARY_ACCELERATION = math.radians(360.0)
"""rad/s²."""
LINEAR_OVERRUN = 1e-3
ROTARY_OVERRUN = math.radians(1.0)
OVERRUN_SHARE = 0.01
"""Where the description names no overrun: 1 mm or 1 deg, but no more than a hundredth of the travel."""


Counting = Literal["iso", "reversed"]
"""Which way an axis counts: a positive coordinate moves the tool positively relative to the workpiece, or not."""


def letter_direction(letter: str) -> int:
    """Return 0, 1 or 2: the machine direction x, y, z that an axis letter moves along or turns about (ISO 841)."""
    letters = ROTARY_LETTERS if letter in ROTARY_LETTERS else LINEAR_LETTERS
    return letters.index(letter) % 3


@dataclass(frozen=True, slots=True)
class Axis:
    """An axis as the maker built it; kind and direction follow from its name.

    name : "X", "U2", "C"; letter : its kind, the name without the digit
    direction : unit vector in the machine frame, along the travel or the axis line, where the coordinate increases
    workpiece_side : primed in the chain, it carries the workpiece
    travel : (lowest, highest) coordinate, m or rad
    speed, acceleration : m/s or rad/s, m/s² or rad/s²; the usual ones where none is given
    origin : a point on the axis line of a rotary axis, m, machine frame, all axes at zero
    stated_overrun : m or rad, None for the usual one
    stated_turns : whole turns below and above its travel of one turn that the control allows, None where nobody said
    counting : as stated, None where nothing is said, which means ISO 841
    diameters : of the cross slide of a lathe whose display shows diameters; coordinates here are radii all the same
    Raises DescriptionError for a name that is not an ISO 841 letter with an optional digit.
    """

    name: str
    workpiece_side: bool
    travel: tuple[float, float]
    speed: float = 0.0
    acceleration: float = 0.0
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    stated_overrun: float | None = None
    stated_turns: tuple[int, int] | None = None
    counting: Counting | None = None
    diameters: bool = False
    letter: str = field(init=False)
    rotary: bool = field(init=False)
    direction: tuple[float, float, float] = field(init=False)

    def __post_init__(self) -> None:
        letter = self.name[:1]
        if letter not in LINEAR_LETTERS + ROTARY_LETTERS or not letter:
            remedy = "Axis names begin with one of X Y Z U V W P Q R A B C"
            raise DescriptionError("{name} is not an axis name", remedy, name=shown(self.name))
        rotary, way = letter in ROTARY_LETTERS, -1.0 if self.counting == "reversed" else 1.0
        found = {
            "letter": letter,
            "rotary": rotary,
            "direction": tuple(way if place == letter_direction(letter) else 0.0 for place in range(3)),
            "speed": self.speed or (ROTARY_SPEED if rotary else LINEAR_SPEED),
            "acceleration": self.acceleration or (ROTARY_ACCELERATION if rotary else LINEAR_ACCELERATION),
        }
        for name, value in found.items():
            object.__setattr__(self, name, value)

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
        return replace(self, counting="iso" if self.reversed else "reversed")

    @property
    def positioning_error(self) -> str:
        """Name of the error along (about) the axis itself: "EXX", "EXU", "ECC"."""
        letters = "ABC" if self.rotary else "XYZ"
        return f"E{letters[letter_direction(self.letter)]}{self.name}"

    @property
    def length(self) -> float:
        """Length of the travel, m or rad."""
        return self.travel[1] - self.travel[0]

    @property
    def overrun(self) -> float:
        """The distance over which a place is approached where the side counts, m or rad."""
        usual = min(ROTARY_OVERRUN if self.rotary else LINEAR_OVERRUN, OVERRUN_SHARE * self.length)
        return usual if self.stated_overrun is None else self.stated_overrun

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
    def travel_text(self) -> str:
        """The travel in words: "0 mm to 600 mm"."""
        low, high = (format_quantity(end, self.unit) for end in self.travel)
        return said("{low} to {high}", low=low, high=high)

    @property
    def cyclic(self) -> bool:
        """True for a rotary axis whose travel is one full turn to 1e-9 rad."""
        return self.rotary and abs(self.length - math.tau) <= 1e-9
