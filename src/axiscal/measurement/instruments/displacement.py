"""Instruments that read the displacement of the TCP along a direction: interferometer, indicator, probe, edge.

y = dᵀδp + zero + slope · s + growth · dᵀe s + lag · a sign(dᵀe).
Here s is the travel of the moving axis from its middle, e its way in the workpiece frame, a = ±1 the side it came from.
A leg of a square that is turned by ω has the slope ω · (e × d): the two legs have it with opposite signs. The
growth is by how much the material is longer than at 20 °C. Its known part is taken off; the rest is an unknown. The lag
is what a stylus or spindle with play shows of the way it was moved last.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from axiscal.measurement.instruments.kind import Kind, Reads
from axiscal.numerics import Array
from axiscal_core import rigid
from axiscal_core.instrument import At, Unknowns

SQUARE = ("square_x", "square_y", "square_z")
"""By how much the square is turned that a leg belongs to."""
_LEAST_ALONG = 0.5
"""Of a way along the direction that is read, from which its side of approach is the side of the play."""
_READS: dict[str, Reads] = {
    "zero": "length",
    "slope": "angle",
    "growth": "angle",
    "lag": "length",
    **dict.fromkeys(SQUARE, "angle"),
}


class Displacement(Kind):
    """One length along the set-up's direction."""

    unknown_reads: Mapping[str, Reads] = MappingProxyType(_READS)

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return dᵀδp + known growth + the effects of the unknowns: of a slope by its tangent."""
        moved = at.moved + self.grown(at) if self.setup.growth else at.moved
        if self.setup.offset is not None:
            arm = at.tool @ np.array(self.setup.offset)
            moved = moved + rigid.turned(arm, at.turned) - arm
        shown: Array = moved @ np.array(self.setup.direction)
        for name, size in u.items():
            if size:
                shown = shown + (np.tan(size) if name == "slope" else size) * self._effect(name, at)
        return [shown]

    def _effect(self, unknown: str, at: At) -> Array:
        """Return what a unit of an unknown adds, (m,).

        One for the zero, the travel for the slope, the travel along the direction for the growth, of a square the turn
        about x, y or z; of the lag the side from which the linear axis that moves came, along the direction.
        """
        if unknown == "zero":
            return np.ones(len(at.poses))
        direction, travelled = np.array(self.setup.direction), self.travelled(at.poses)
        if unknown == "slope":
            return travelled
        ways = self.ways(at.poses)
        if unknown in SQUARE:
            return travelled * np.cross(ways, direction)[:, SQUARE.index(unknown)]
        along: Array = ways @ direction
        if unknown == "growth":
            return travelled * along
        if self.slide is None:
            return np.zeros(len(at.poses))
        side: Array = at.sides[:, self.slide] * np.where(np.abs(along) >= _LEAST_ALONG, np.sign(along), 0.0)
        return side


class Length(Displacement):
    """How much farther the tool is from a first place than it should be, along the line to the second.

    y = dᵀ(δp − δp₁) + growth · L, where at.moved is the difference, L the length.
    """

    unknown_reads: Mapping[str, Reads] = MappingProxyType({"growth": "angle"})

    def middle(self, at: At) -> Array:
        """Return its first end."""
        first: Array = self.machine.frames(np.array([self.setup.start])).tcp
        return first

    def grown(self, at: At) -> Array:
        """Return how much farther a machine that is warmer than 20 °C takes the tool from there, (m, 3) m."""
        return np.asarray(self.setup.growth * (at.tcp - self.middle(at)))

    def _effect(self, unknown: str, at: At) -> Array:
        """Return what a unit of growth adds, (m,)."""
        along: Array = (at.tcp - self.middle(at)) @ np.array(self.setup.direction)
        return along
