"""A curve as a picture draws it, in the units in which it is shown."""

from __future__ import annotations

from typing import NamedTuple

from axiscal.numerics import Array


class DrawnLine(NamedTuple):
    """at : (m,) positions; middle : (m,) mean; half : (m,) half of the band that holds it with 95 %"""

    name: str
    at: Array
    middle: Array
    half: Array
    position_unit: str
    unit: str
