"""The numbers of one axis as a program writes them: mm or deg, multiples of one step, proven to lie in the travel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

from axiscal.document import shown
from axiscal.exceptions import ProgramError, TravelError
from axiscal.language.spoken import said
from axiscal.units import format_quantity, to_unit
from axiscal_core.axes import Axis

Decimals = tuple[Decimal, ...]
_ROUNDED = 3
"""Steps of the program's last decimal that rounding may take from an overrun."""
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
    def of_axis(cls, axis: Axis, decimals: int) -> AxisScale:
        """Return the scale of an axis; raises ProgramError when no number that can be written lies in its travel."""
        step = Decimal(1).scaleb(-decimals)
        low, high = (exact(to_unit(end, axis.unit)) for end in axis.travel)
        first, last = low.quantize(step, ROUND_CEILING) + 0, high.quantize(step, ROUND_FLOOR) + 0
        if first > last:
            what = "no number with {decimals} decimals lies in the travel of {axis}, {low} to {high}"
            remedy = "Choose a controller with more decimals"
            raise ProgramError(what, remedy, decimals=decimals, axis=axis.name, low=low, high=high)
        return cls(axis, step, low, high, first, last)

    @property
    def unit(self) -> str:
        """mm or deg."""
        return self.axis.unit

    @property
    def travel(self) -> str:
        """The travel, for people."""
        return said("{low} to {high}", low=self.low, high=f"{self.high} {self.unit}")

    def nearest(self, value: float) -> Decimal | None:
        """Return the number next to a coordinate (m or rad) that lies in the travel; None for one outside of it."""
        slack = 1e-9 * self.axis.length
        if not (math.isfinite(value) and self.axis.travel[0] - slack <= value <= self.axis.travel[1] + slack):
            return None
        return min(max(exact(to_unit(value, self.unit)).quantize(self.step), self.first), self.last) + 0

    def above(self, value: float) -> Decimal:
        """Return the next multiple of the step that is no shorter than a distance in m or rad."""
        return exact(to_unit(value, self.unit)).quantize(self.step, ROUND_CEILING)

    def sided(self, number: Decimal, side: int) -> tuple[Decimal, Decimal] | None:
        """Return a position and where to turn before it, at the other end of a turn where this one leaves no room.

        None where no end leaves room; room lost by rounding to the numbers of the program is forgiven.
        """
        wanted, turns = self.above(self.axis.overrun), self.axis.cyclic and self.last - self.first == 360
        for place in (number, *([number + side * 360] if side and turns else [])):
            room = place - self.first if side > 0 else self.last - place
            if self.first <= place <= self.last and (not side or room >= wanted - _ROUNDED * self.step):
                return place, place - side * min(wanted, room)
        return None

    def written(self, value: Decimal) -> str:
        """Return the number as text; raises ProgramError unless it reads back as itself and lies in the travel."""
        text = f"{value + 0:.{-int(self.step.as_tuple().exponent)}f}"
        if Decimal(text) != value or not self.low <= value <= self.high:
            what = "{axis} would go to {text} {unit}, and its travel is {low} to {high}"
            remedy, axis = "Choose a smaller overrun, or a raster within the travel", self.axis.name
            raise ProgramError(what, remedy, axis=axis, text=text, unit=self.unit, low=self.low, high=self.high)
        return text


@dataclass(frozen=True, slots=True)
class ReadingTarget:
    """A reading: its number in the plan, where the axes stand, and how far off their way to it begins at least.

    turning : the position, less the overrun where the side counts; approach : +1, −1, 0 per axis
    """

    number: int
    position: Decimals
    turning: Decimals
    approach: tuple[int, ...]

    def way_in(self, standing: Decimals) -> Decimals:
        """Return where to turn on the way from where the axes stand: an axis that comes far enough does not turn."""
        axes = zip(standing, self.position, self.turning, self.approach, strict=True)
        return tuple(p if side == 0 or (p - s) * side >= abs(p - t) else t for s, p, t, side in axes)


def target(
    scales: Sequence[AxisScale], setup: str, number: int, pose: Sequence[float], approach: Sequence[int]
) -> ReadingTarget:
    """Return a reading in the numbers of a program; raises TravelError for one outside the travel, or without room."""
    label = said("reading {number} of the set-up {setup}", number=number, setup=shown(setup))
    if not len(pose) == len(approach) == len(scales) or any(side not in (-1, 0, 1) for side in approach):
        remedy = "Plan it for this machine"
        raise ProgramError("{label} does not fit the machine's {count} axes", remedy, label=label, count=len(scales))
    placed = list[tuple[Decimal, Decimal]]()
    for scale, value, side in zip(scales, pose, map(int, approach), strict=True):
        place = scale.nearest(value)
        if place is None or (sided := scale.sided(place, side)) is None:
            what = "{label}: {at} lies outside {travel}, or leaves less than the overrun of {overrun} to come to {side}"
            remedy = "Plan it further inside, where no raster leads beyond, or give the axis a smaller overrun"
            at, to = f"{scale.axis.name} = {format_quantity(value, scale.unit, 9)}", f"{scale.axis.name}{' +-'[side]}"
            told = {"at": at, "side": to.strip(), "overrun": format_quantity(scale.axis.overrun, scale.unit, 3)}
            raise TravelError(what, remedy, None, None, label=label, travel=scale.travel, **told)
        placed.append(sided)
    position, turning = zip(*placed, strict=True)
    return ReadingTarget(number, position, turning, tuple(int(side) for side in approach))
