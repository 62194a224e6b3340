"""Axes by the letters of ISO 841: kind and direction follow from the name."""

from __future__ import annotations

from axiscal.document import shown
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.units import format_quantity
from axiscal_core.axes import (
    LINEAR_ACCELERATION,
    LINEAR_SPEED,
    ROTARY_ACCELERATION,
    ROTARY_SPEED,
    Axis,
    Counting,
    Three,
    usual_overrun,
)

LINEAR_LETTERS = "XYZUVWPQR"
ROTARY_LETTERS = "ABC"


def letter_direction(letter: str) -> int:
    """Return 0, 1 or 2: the machine direction x, y, z that an axis letter moves along or turns about (ISO 841)."""
    letters = ROTARY_LETTERS if letter in ROTARY_LETTERS else LINEAR_LETTERS
    return letters.index(letter) % 3


def iso_axis(
    name: str,
    workpiece_side: bool,
    travel: tuple[float, float],
    speed: float = 0.0,
    acceleration: float = 0.0,
    origin: Three = (0.0, 0.0, 0.0),
    overrun: float | None = None,
    turns: tuple[int, int] | None = None,
    counting: Counting | None = None,
    diameters: bool = False,
) -> Axis:
    """Return the axis of a name such as "X", "U2" or "C", with what is usual where a size is 0 or None.

    Raises DescriptionError for a name that is not an ISO 841 letter with an optional digit.
    """
    letter = name[:1]
    if letter not in LINEAR_LETTERS + ROTARY_LETTERS or not letter:
        remedy = "Axis names begin with one of X Y Z U V W P Q R A B C"
        raise DescriptionError("{name} is not an axis name", remedy, name=shown(name))
    rotary, way = letter in ROTARY_LETTERS, -1.0 if counting == "reversed" else 1.0
    x, y, z = (way if place == letter_direction(letter) else 0.0 for place in range(3))
    over = usual_overrun(rotary, travel[1] - travel[0]) if overrun is None else overrun
    quick = speed or (ROTARY_SPEED if rotary else LINEAR_SPEED)
    sharp = acceleration or (ROTARY_ACCELERATION if rotary else LINEAR_ACCELERATION)
    return Axis(name, rotary, (x, y, z), travel, workpiece_side, origin, over, quick, sharp, turns, counting, diameters)


def travel_text(axis: Axis) -> str:
    """Return the travel in words: "0 mm to 600 mm"."""
    low, high = (format_quantity(end, axis.unit) for end in axis.travel)
    return said("{low} to {high}", low=low, high=high)
