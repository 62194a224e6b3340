"""Instruments that read the displacement of the TCP along a direction: interferometer, indicator, probe, edge.

y = dᵀδp + zero + slope · s + growth · dᵀe s + lag · a sign(dᵀe).
Here s is the travel of the moving axis from its middle, e its way in the workpiece frame, a = ±1 the side it came from.
A leg of a square that is turned by ω has the slope ω · (e × d): the two legs have it with opposite signs. The
growth is by how much the material is longer than at 20 °C. Its known part is taken off; the rest is an unknown. The lag
is what a stylus or spindle with play shows of the way it was moved last.

Instruments that read the rotation of the tool about one direction, electronic level and autocollimator: y = dᵀε + zero.

A level, or the mirror of an autocollimator, that is stepped along a way on feet a base apart.

y = atan( (d × a)ᵀ (w(t + L/2) − w(t − L/2)) / L ) + zero. Here w is the shape of the way and a its direction.
To first order y is the slope of a chord; as L goes to zero, the derivative of the straightness.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.errors.plane import PlaneError
from axiscal.exceptions import DescriptionError
from axiscal.machine.description import Machine
from axiscal.measurement.instruments.kind import Kind, Reads
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import Way, across
from axiscal.numerics import Array
from axiscal.units import format_quantity
from axiscal_core import rigid
from axiscal_core.instrument import At, Unknowns

_ALONG = 1e-6
"""Rounding of a unit vector."""
_UNSEEN = 1e-9
"""Rounding of a lever, m/rad or 1."""


class Rotation(Kind):
    """One angle about the set-up's direction: of the tool, or of feet that are stepped along a way."""

    reads: Reads = "angle"
    unknown_reads: Mapping[str, Reads] = MappingProxyType({"zero": "angle"})

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return dᵀε + zero, or the angle of the chord; at.moved : of one foot against the other, per length."""
        if self.setup.base is None:
            return [at.turned @ np.array(self.setup.direction) + u["zero"]]
        return [np.arctan(np.sum(across(self.machine, self.setup, at.poses) * at.moved, axis=1)) + u["zero"]]

    @classmethod
    def check_setup(cls, setup: Setup, machine: Machine) -> None:
        """Raise DescriptionError where feet have no slope to read."""
        if setup.base is None:
            return
        _refuse_other_moves(setup, machine)
        base, axis = setup.base, machine.axes[setup.moves[0]]
        if base >= axis.length:
            what = "a base of {base} is not shorter than the travel of {axis}"
            remedy, travel = "Both feet stand within the travel, which is {travel}", axis.travel_text
            raise DescriptionError(what, remedy, base=format_quantity(base, "mm", 6), axis=axis.name, travel=travel)
        slope_seen = across(machine, setup, np.array([setup.park]))[0]
        if abs(np.linalg.norm(slope_seen) - 1) > _ALONG:
            what = "feet that are stepped along {axis} show its slope, and that is no turn about this direction"
            remedy = "Give a direction across the way; for the roll of a carriage take base out: the level rides on it"
            raise DescriptionError(what, remedy, axis=axis.name)
        _refuse_unseen(setup, machine)


def _refuse_other_moves(setup: Setup, machine: Machine) -> None:
    moving = [machine.axes[index] for index in setup.moves]
    if len(moving) != 1 or moving[0].rotary:
        named = ", ".join(axis.name for axis in moving)
        what = "a base is stepped along one straight way, and here {axes} moves"
        what = what if len(moving) == 1 else "a base is stepped along one straight way, and here {axes} move"
        raise DescriptionError(what, 'Name the linear axis whose way it is, such as moves = ["X"]', axes=named)


def _refuse_unseen(setup: Setup, machine: Machine) -> None:
    """Raise DescriptionError where the way has no shape, or a rest whose slope over such a short base nobody knows."""
    errors, base = ErrorModel(machine), setup.base or 0.0
    levers = Way(errors, setup, base).levers(np.array([setup.park]))[:, 0]
    levelled = any(unknown.name == "zero" for unknown in setup.unknowns)
    shown = [f for f, lever in zip(errors.terms, levers, strict=True) if abs(lever) > _UNSEEN]
    axis = machine.axes[setup.moves[0]].name
    if all(function.kind == "location" and levelled for function in shown):
        what = "the machine states no straightness error of {axis} that a slope about this direction could show"
        error = f"E{'X' if axis[0] == 'Z' else 'Z'}{axis}"
        raise DescriptionError(what, "Add one under [errors], such as {error}", axis=axis, error=error)
    for function in shown:
        cell = function.cell_along(setup.moves[0]) if isinstance(function, PlaneError) else function.cell
        if function.rest > 0 and base < cell * (1 - 1e-9):
            short, long = format_quantity(base, "mm", 6), format_quantity(cell, "mm", 4)
            what = "a base of {short} is shorter than {long}, within which the rest of {function} has no known slope"
            remedy = "Use a longer base, give that error more knots, or take its rest out"
            raise DescriptionError(what, remedy, short=short, long=long, function=function.name)


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
        shown: Array = moved @ np.array(self.setup.direction) + u["zero"]
        for name, size in u.items():
            if size and name != "zero":
                shown = shown + (np.tan(size) if name == "slope" else size) * self._effect(name, at)
        return [shown]

    def _effect(self, unknown: str, at: At) -> Array:
        """Return what a unit of an unknown adds, (m,).

        The travel for the slope, the travel along the direction for the growth, of a square the turn about x, y or z;
        of the lag the side from which the linear axis that moves came, along the direction.
        """
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
