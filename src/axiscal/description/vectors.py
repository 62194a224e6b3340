"""Directions and places as campaign.toml has them: "x", "-y", [1, 0, 0], ["0 mm", "0 mm", "-300 mm"]."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from typing import Annotated

from axiscal.document import shown
from axiscal.document.validation import QuantityText, ReadAs
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import later
from axiscal.measurement.setup import Vector
from axiscal.units import parse_quantity

At = Callable[..., AbstractContextManager[None]]
"""Places failures at the keys of a set-up."""
_LETTER = re.compile(r"([+-]?)([xyzXYZ])")
WAYS = later('Write "x", "-y" or three numbers such as [1, 0, 0], in the workpiece frame')


def unit_vector(value: str | Sequence[float | int]) -> Vector:
    """Return a direction; raises DescriptionError."""
    if isinstance(value, str):
        found = _LETTER.fullmatch(value)
        if found is None:
            raise DescriptionError("{text} is not a direction", WAYS, text=shown(value))
        sign = -1.0 if found[1] == "-" else 1.0
        x, y, z = (sign if letter == found[2].lower() else 0.0 for letter in "xyz")
        return x, y, z
    largest = max((abs(number) for number in value), default=0)
    if len(value) != 3 or not 1e-100 < largest < 1e100:
        raise DescriptionError("{text} is not a direction", WAYS, text=shown(list(value)))
    x, y, z = (number / math.hypot(*value) for number in value)
    return x, y, z


def spot(given: Sequence[str]) -> Vector:
    """Return a place, m; raises DescriptionError or UnitError."""
    if len(given) != 3:
        remedy = 'Give three lengths such as ["0 mm", "0 mm", "-300 mm"], in the workpiece frame'
        raise DescriptionError("{text} is not a place", remedy, text=shown(list(given)))
    x, y, z = (parse_quantity(text, "length") for text in given)
    return x, y, z


def span(given: Sequence[str]) -> tuple[float, float]:
    """Return two lengths that increase, m; raises DescriptionError or UnitError."""
    ends = [parse_quantity(text, "length") for text in given]
    if len(ends) != 2 or not ends[0] < ends[1]:
        raise DescriptionError("{text} does not increase", "Give the lower end first", text=shown(list(given)))
    return ends[0], ends[1]


Spot = Annotated[Vector, ReadAs(list[QuantityText], spot)]
Span = Annotated[tuple[float, float], ReadAs(list[QuantityText], span)]
Direction = Annotated[Vector, ReadAs(str | list[float | int], unit_vector)]
"""Fields of a table in campaign.toml, in SI."""
