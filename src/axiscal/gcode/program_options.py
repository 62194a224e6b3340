"""What a person may choose about a measuring program."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from axiscal.exceptions import ProgramError


@dataclass(frozen=True, slots=True)
class ProgramOptions:
    """How the machine goes to its readings; raises ProgramError for what makes no sense.

    wait : at a reading, "stop" halts the program until somebody presses start; "dwell" gives the instrument its
        reading time
    feed : feed as a share of each axis' speed, above 0, at most 1
    order : names of axes that move together, group after group; None: linear axes first, then rotary ones
    clearance : name of the axis that goes clear before others move, and at the end, with its coordinate, m or rad
    """

    wait: Literal["stop", "dwell"] = "stop"
    feed: float = 1.0
    order: tuple[tuple[str, ...], ...] | None = None
    clearance: tuple[str, float] | None = None

    def __post_init__(self) -> None:
        if not 0 < self.feed <= 1:
            raise ProgramError(f"a feed of {self.feed:g} times the speed of the axes", "Give a share from 0 to 1")
        if self.wait not in ("stop", "dwell"):
            raise ProgramError(f'"{self.wait}" is no way to wait for an instrument', "Choose stop or dwell")
