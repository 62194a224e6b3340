"""What a person may choose about a measuring program."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from axiscal.exceptions import ProgramError
from axiscal.machine.axis import Axis
from axiscal.units import format_quantity

LENGTH = 1e-3
ANGLE = math.radians(1.0)
SHARE = 0.01
"""The usual overrun: 1 mm or 1 deg, but no more than a hundredth of the travel."""

LEAST = 0.1
"""Where the travel ends, an overrun may shrink to this share of what is wanted; less would not take up the play."""


@dataclass(frozen=True, slots=True)
class Options:
    """How the machine goes to its readings; raises ProgramError for what makes no sense.

    overrun_length, overrun_angle : m, rad; from how far away a reading is approached at least; None: the usual one
    wait : at a reading, "stop" halts the program until somebody presses start; "dwell" gives the instrument its
        reading time
    feed : feed as a share of each axis' speed, above 0, at most 1
    order : names of axes that move together, group after group; None: linear axes first, then rotary ones
    """

    overrun_length: float | None = None
    overrun_angle: float | None = None
    wait: Literal["stop", "dwell"] = "stop"
    feed: float = 1.0
    order: tuple[tuple[str, ...], ...] | None = None

    def __post_init__(self) -> None:
        for value, unit in ((self.overrun_length, "mm"), (self.overrun_angle, "deg")):
            if value is not None and not 0 < value < math.inf:
                raise ProgramError(f"an overrun of {format_quantity(value, unit)}", "Give one above zero")
        if not 0 < self.feed <= 1:
            raise ProgramError(f"a feed of {self.feed:g} times the speed of the axes", "Give a share from 0 to 1")
        if self.wait not in ("stop", "dwell"):
            raise ProgramError(f'"{self.wait}" is no way to wait for an instrument', "Choose stop or dwell")

    def overrun(self, axis: Axis) -> float:
        """Return from how far away readings of this axis are approached, m or rad."""
        asked = self.overrun_angle if axis.rotary else self.overrun_length
        return min(ANGLE if axis.rotary else LENGTH, SHARE * axis.length) if asked is None else asked
