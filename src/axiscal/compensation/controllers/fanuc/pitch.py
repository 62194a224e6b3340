"""What the parameters of a FANUC say of the points of an axis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.compensation.controllers.fanuc.records import EXPECTED, Records
from axiscal.compensation.export_options import ExportOptions
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array

DETECTION = 1e-6
"""Detection unit of increment system IS-B, m."""
DIRECTION, BOTH, NEGATIVE, APART = 1006, 3605, 3626, 3627
"""Numbers of the parameters that hold the way to the reference point, the choice of two sets, and the second one."""
_NEEDED = range(3620, 3625)
"""By FANUC's manual: the parameters that say which points an axis has."""
_BACKWARDS = 5
"""Bit ZMI of parameter 1006."""


@dataclass(frozen=True, slots=True)
class PitchParameters:
    """The points of one axis.

    reference, first, last : numbers of points; magnification : multiplies each entry; interval : m
    negative : number of the first point of the set for travel downwards, None without one
    downwards : whether the reference point is approached downwards

    A point holds the section that ends at it: the first one begins an interval below it (B-63980EN, parameter 3620).
    """

    reference: int
    first: int
    last: int
    magnification: int
    interval: float
    negative: int | None = None
    downwards: bool = False

    @property
    def positions(self) -> Array:
        """Where the sections end, one more than points, m; the reference point is the machine's zero."""
        numbers = np.arange(self.first - 1, self.last + 1, dtype=float)
        at: Array = (numbers - self.reference) * self.interval
        return at

    @property
    def origin(self) -> int:
        """Index of the reference point among the positions."""
        return self.reference - self.first + 1

    @property
    def step(self) -> float:
        """What an entry of 1 moves, m."""
        return self.magnification * DETECTION

    @property
    def numbers(self) -> tuple[range, ...]:
        """Numbers of its points, of the second set too."""
        count = self.last - self.first + 1
        second = () if self.negative is None else (range(self.negative, self.negative + count),)
        return (range(self.first, self.last + 1), *second)

    def covering(self, low: float, high: float) -> tuple[int, int]:
        """Return the numbers of the first and last point that a travel needs, by FANUC's formula."""
        below, above = np.floor(low / self.interval + 1e-6), np.ceil(high / self.interval - 1e-6)
        return self.reference + int(below) + 1, self.reference + int(above)


def linear_numbers(machine: Machine, options: ExportOptions) -> dict[str, int]:
    """Return the controlled-axis number of each linear axis."""
    return {name: n for name, n in options.numbered(machine).items() if not machine.axis(name).rotary}


def read_plans(records: Records, file: str, numbers: Mapping[str, int]) -> dict[str, PitchParameters]:
    """Return what the parameters say; axes without a positive interval are left out.

    numbers : of the controlled axes by name.  Raises TableError.
    """
    found = {name: _plan(records, file, name, number) for name, number in numbers.items()}
    plans = {name: plan for name, plan in found.items() if plan is not None}
    if not plans:
        raise TableError("no axis has an interval of compensation (3624)", "set it on the control first", file)
    _refuse_shared_points(plans, file)
    return plans


def _plan(records: Records, file: str, name: str, number: int) -> PitchParameters | None:
    values = [records.get(key, {}).get(number) for key in _NEEDED]
    missing = [key for key, value in zip(_NEEDED, values, strict=True) if value is None]
    if missing:
        shown = ", ".join(map(str, missing))
        raise TableError(f"there are no parameters {shown} for {name} (axis {number})", EXPECTED, file)
    reference, first, last, magnification, interval = (value or "0" for value in values)
    width = float(interval) * (1e-3 if "." in interval else DETECTION)
    if width <= 0:
        return None
    negative = _second_set(records, file, name, number)
    downwards = _bit(records.get(DIRECTION, {}).get(number, "0"), _BACKWARDS)
    plan = PitchParameters(
        int(reference), int(first), int(last), max(1, int(magnification)), width, negative, downwards
    )
    _refuse_order(name, plan, file)
    return plan


def _second_set(records: Records, file: str, name: str, number: int) -> int | None:
    """Return parameter 3626 where it counts: it is not 0, and 3605#0 does not say that one set serves both ways."""
    first = int(records.get(NEGATIVE, {}).get(number, "0"))
    if first == 0 or not _bit(records.get(BOTH, {}).get(number, "1"), 0):
        return None
    if number not in records.get(APART, {}):
        raise TableError(f"{name} (axis {number}) has parameter 3626 without 3627", EXPECTED, file)
    return first


def _bit(value: str, place: int) -> bool:
    return value.rjust(8, "0")[-1 - place] == "1"


def _refuse_order(name: str, plan: PitchParameters, file: str) -> None:
    if not plan.first - 1 <= plan.reference <= plan.last or plan.first == plan.last:
        what = f"{name} has points {plan.first} to {plan.last} and the reference point {plan.reference}"
        raise TableError(what, "the reference point lies between the others", file)


def _refuse_shared_points(plans: Mapping[str, PitchParameters], file: str) -> None:
    owner: dict[int, str] = {}
    for name, plan in plans.items():
        for number in (number for points in plan.numbers for number in points):
            if number in owner:
                what = f"point {number} belongs to {owner[number]} and to {name}"
                raise TableError(what, "give each set points of its own: 3620 to 3622 and 3626", file)
            owner[number] = name
