"""A deviation at chosen positions, as a controller's table holds it."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import TableError
from axiscal.machine.names import AXIS_NAME
from axiscal.numerics import Array
from axiscal.units import format_quantity


@dataclass(frozen=True, slots=True, eq=False)
class CompensationTable:
    """The deviation of one axis, actual minus nominal along its own positive direction, tool relative to workpiece.

    axis : its name, as in the chain; rotary : whether it turns
    positions : (n,) m or rad, strictly increasing, of the axis itself or of `over`
    forward, reverse : (n,) m or rad, the deviation when the position was approached upwards or downwards
    std : (n,) m or rad, the standard deviation that the deviation is known to
    over : the linear axis over whose position the deviation goes; the axis itself unless said otherwise
    prior_only : (n,) where the readings said nothing: the deviation there is what was believed beforehand
    shape_std : RMS of the standard deviation of the deviation less its mean over the table, m or rad
    departure : largest distance between the table and the curve it was made of, over the volume, m or rad
    Raises TableError for anything that no controller could hold.
    """

    axis: str
    rotary: bool
    positions: Array
    forward: Array
    reverse: Array
    std: Array
    over: str = ""
    prior_only: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    departure: float = 0.0
    shape_std: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "over", self.over or self.axis)
        for axis in (self.axis, self.over):
            if not re.fullmatch(AXIS_NAME, axis):
                remedy = "axes are named like X, Y2 or C"
                raise TableError("{name!r} is not the name of an axis", remedy, name=axis[:20])
        for name in ("positions", "forward", "reverse", "std"):
            values = np.array(getattr(self, name), dtype=np.float64)
            values.setflags(write=False)
            object.__setattr__(self, name, values)
            self._check(name, values)
        if self.prior_only.shape != self.positions.shape:
            object.__setattr__(self, "prior_only", np.zeros(len(self.positions), dtype=bool))
        if np.any(np.diff(self.positions) <= 0):
            raise TableError("the positions of {axis} do not increase", "sort them, and give each once", axis=self.axis)

    def _check(self, name: str, values: Array) -> None:
        if values.ndim != 1 or values.size == 0 or values.shape != np.shape(self.positions):
            what = "the table of {axis} has {name} of shape {shape} for {places} positions"
            shape, places = np.shape(values), np.shape(self.positions)
            remedy = "give one number for each position"
            raise TableError(what, remedy, axis=self.axis, name=name, shape=shape, places=places)
        if not np.all(np.isfinite(values)):
            where = self.positions[int(np.argmin(np.isfinite(values)))]
            what = "{name} of {axis} is not finite at {where:g} m or rad"
            raise TableError(what, "leave that position out", name=name, axis=self.axis, where=where)

    def deviation(self, position: Array, direction: int) -> Array:
        """Return the deviation at positions (m,) approached in direction +1 or -1: linear between, constant outside."""
        return np.interp(position, self.positions, self.forward if direction > 0 else self.reverse)

    @property
    def unit(self) -> str:
        """The unit in which positions are shown."""
        return "deg" if self.rotary and self.over == self.axis else "mm"

    @property
    def fine_unit(self) -> str:
        """The unit in which deviations are shown."""
        return "arcsec" if self.rotary else "um"

    def averaged(self) -> CompensationTable:
        """Return the table without reversal: the mean of both directions."""
        mean = (self.forward + self.reverse) / 2
        return replace(self, forward=mean, reverse=mean)

    @property
    def reversal(self) -> tuple[float, float]:
        """Smallest and largest size of the step between the two directions anywhere on the table, m or rad."""
        step = self.forward - self.reverse
        crosses = bool(np.any(step > 0) and np.any(step < 0))
        return 0.0 if crosses else float(np.min(np.abs(step))), float(np.max(np.abs(step)))

    def shown(self, value: float) -> str:
        """Return a deviation (m or rad) as text."""
        return format_quantity(value, self.fine_unit, 3)
