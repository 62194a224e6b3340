"""The numbers of one axis as a program writes them: mm or deg, multiples of one step, proven to lie in the travel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

from axiscal.exceptions import ProgramError
from axiscal.machine.axis import Axis
from axiscal.machine.driving import near
from axiscal.units import to_unit

_NOISE = 9
"""Decimals in mm or deg beyond which a binary number is noise: 1e-12 m."""


def exact(value: float) -> Decimal:
    """Return a number in mm or deg as it was meant, without the noise of binary arithmetic."""
    return Decimal(repr(round(float(value), _NOISE)))


@dataclass(frozen=True, slots=True)
class AxisScale:
    """One axis in its written unit.

    step : the last decimal; low, high : the travel; first, last : the multiples of the step next to its ends
    """

    axis: Axis
    step: Decimal
    low: Decimal
    high: Decimal
    first: Decimal
    last: Decimal

    @classmethod
    def of(cls, axis: Axis, decimals: int) -> AxisScale:
        """Return the scale of an axis; raises ProgramError when no number that can be written lies in its travel."""
        step = Decimal(1).scaleb(-decimals)
        low, high = (exact(to_unit(end, axis.unit)) for end in axis.travel)
        first, last = low.quantize(step, ROUND_CEILING) + 0, high.quantize(step, ROUND_FLOOR) + 0
        if first > last:
            what = f"no number with {decimals} decimals lies in the travel of {axis.name}, {low} to {high}"
            raise ProgramError(what, "Choose a controller with more decimals")
        return cls(axis, step, low, high, first, last)

    @property
    def unit(self) -> str:
        """mm or deg."""
        return self.axis.unit

    @property
    def nearness(self) -> Decimal:
        """How near to a reading moves may be slow, mm or deg."""
        return self.above(near(self.axis))

    @property
    def turn(self) -> Decimal | None:
        """One turn, for an axis whose ends are the same place."""
        return Decimal(360) if self.axis.cyclic and self.last - self.first == 360 else None

    def nearest(self, value: float) -> Decimal | None:
        """Return the number next to a coordinate (m or rad) that lies in the travel; None for one outside of it."""
        slack = 1e-9 * self.axis.length
        if not (math.isfinite(value) and self.axis.travel[0] - slack <= value <= self.axis.travel[1] + slack):
            return None
        return min(max(exact(to_unit(value, self.unit)).quantize(self.step), self.first), self.last) + 0

    def above(self, value: float) -> Decimal:
        """Return the next multiple of the step that is no shorter than a distance in m or rad."""
        return exact(to_unit(value, self.unit)).quantize(self.step, ROUND_CEILING)

    def written(self, value: Decimal) -> str:
        """Return the number as text; raises ProgramError unless it reads back as itself and lies in the travel."""
        text = f"{value + 0:.{-int(self.step.as_tuple().exponent)}f}"
        read = Decimal(text)
        if read != value or not self.low <= read <= self.high:
            what = f"{self.axis.name} would go to {text} {self.unit}, and its travel is {self.low} to {self.high}"
            raise ProgramError(what, "Choose a smaller overrun, or a raster within the travel")
        return text
