"""A set-up: one instrument, mounted in one way, that reads along (or about) one direction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from axiscal.machine.axis import Axis

Approach = Literal["both", "+", "-"]
Vector = tuple[float, float, float]

FINEST = 1e-10
"""No reading is known better than this, m or rad: an atom's width. Smaller noise is a slip, and ends in rounding."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """A quantity of the set-up itself that is estimated along with the machine.

    name : such as "zero" (constant offset of every reading, m or rad) or "slope" (rad; times the distance of the
        moving linear axis from the middle of its travel); each kind of instrument has its own
    std : prior standard deviation in the same unit
    """

    name: str
    std: float


@dataclass(frozen=True, slots=True)
class Setup:
    """How one instrument stands on the machine.

    direction : unit vector in the workpiece frame, along which a length or about which an angle is read
    moves : indices of the axes that may move, in chain order
    park : (n_axes,) m or rad, where the axes stand that do not move; middle of travel for those that do
    noise : standard deviation of one reading, m or rad, what its display rounds off included
    setup_time, settle, reading_time : s
    raster : (n_axes,) m or rad, positions are multiples of it; 0 is continuous
    approach : directions from which a moving axis comes to a position; "both" is needed to see reversal
    station : where a tracker, tracer or ball bar stands, m, in the workpiece frame
    growth : thermal expansion of the measured material at its temperature against 20 °C, a strain
    found : how far from there its station has been found so far, m; None is nowhere else
    base : how far apart the feet of a level stand that is stepped along the way of the axis that moves, m; its poses
        are those of the middle; None where it rides on what moves
    drift : standard deviation of the rate at which its zero wanders while it stands, m/s or rad/s
    resolution : the step q of its display, m or rad; 0 where it shows everything
    """

    name: str
    instrument: str
    direction: Vector
    moves: tuple[int, ...]
    park: tuple[float, ...]
    noise: float
    unknowns: tuple[Unknown, ...]
    setup_time: float
    settle: float
    reading_time: float
    raster: tuple[float, ...]
    approach: Approach
    station: Vector | None = None
    found: Vector | None = None
    growth: float = 0.0
    base: float | None = None
    drift: float = 0.0
    resolution: float = 0.0

    @property
    def rounding(self) -> float:
        """Standard deviation of what the display rounds off, q/√12, m or rad (GUM F.2.2.1)."""
        return self.resolution / math.sqrt(12.0)

    @property
    def scatter(self) -> float:
        """Standard deviation of a reading before the display rounds it, m or rad."""
        return max(math.sqrt(max(self.noise**2 - self.rounding**2, 0.0)), FINEST)

    def span(self, axis: Axis, index: int) -> tuple[float, float]:
        """Return from where to where it can be read along an axis, m or rad: the travel, for feet that stand within."""
        low, high = axis.travel
        half = (self.base or 0.0) / 2 if index in self.moves else 0.0
        return low + half, high - half
