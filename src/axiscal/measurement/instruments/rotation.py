"""Instruments that read the rotation of the tool about one direction, level and autocollimator: y = dᵀε + zero.

A level, or the mirror of an autocollimator, that is stepped along a way on feet a base apart.

y = atan( (d × a)ᵀ (w(t + L/2) − w(t − L/2)) / L ) + zero. Here w is the shape of the way and a its direction.
To first order y is the slope of a chord; as L goes to zero, the derivative of the straightness.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import joined
from axiscal.machine.axis import travel_text
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import INCLINED, ZERO, Reads, Setup, Usual
from axiscal.measurement.type_b import GAIN
from axiscal.numerics import Array
from axiscal.units import format_quantity
from axiscal_core.instrument import At, Unknowns

_ALONG = 1e-6
"""Rounding of a unit vector."""
_UNSEEN = 1e-9
"""Rounding of a row, 1/m or 1."""


class Rotation(Setup):
    """One angle about the set-up's direction: of the tool, or of feet that are stepped along a way."""

    reads: ClassVar[Reads] = "angle"
    unknown_reads: ClassVar[Mapping[str, Reads]] = MappingProxyType({"zero": "angle"})

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return dᵀε + zero, or the angle of the chord; at.moved : of one foot against the other, per length."""
        if self.base is None:
            return [at.turned @ np.array(self.direction) + u["zero"]]
        return [np.arctan(np.sum(self._across(at.poses) * at.moved, axis=1)) + u["zero"]]

    def _across(self, poses: Array) -> Array:
        """Return d × a, a the way along which the axis goes: the direction whose slope is a turn about d, (m, 3)."""
        return np.cross(np.array(self.direction), self.ways(poses))

    def check(self) -> None:
        """Raise DescriptionError where feet have no slope to read: the way has no shape, or its rest no known slope."""
        if self.base is None:
            return
        base, machine = self.base, self.machine
        moving = [machine.axes[index] for index in self.moves]
        if len(moving) != 1 or moving[0].rotary:
            what, named = "a base is stepped along one straight way, and here {axes} move", [a.name for a in moving]
            remedy = 'Name the linear axis whose way it is, such as moves = ["X"]'
            raise DescriptionError(what, remedy, axes=joined(named))
        (axis,), park = moving, np.array([self.park])
        if base >= axis.length:
            what = "a base of {base} is not shorter than the travel of {axis}"
            remedy, travel = "Both feet stand within the travel, which is {travel}", travel_text(axis)
            raise DescriptionError(what, remedy, base=format_quantity(base, "mm", 6), axis=axis.name, travel=travel)
        if abs(np.linalg.norm(self._across(park)[0]) - 1) > _ALONG:
            what = "feet that are stepped along {axis} show its slope, and that is no turn about this direction"
            remedy = "Give a direction across the way; for the roll of a carriage take base out: the level rides on it"
            raise DescriptionError(what, remedy, axis=axis.name)
        (seen,) = np.abs(Observation(machine, (self,)).numbers(Places.of_setup(0, park, np.zeros_like(park))).rows)
        levelled = any(unknown.name == "zero" for unknown in self.unknowns)
        shown = [term for term in machine.terms if seen[term.columns].max(initial=0.0) > _UNSEEN]
        if all(term.kind == "location" and levelled for term in shown):
            what = "the machine states no straightness error of {axis} that a slope about this direction could show"
            error = f"E{'X' if axis.name[0] == 'Z' else 'Z'}{axis.name}"
            raise DescriptionError(what, "Add one under [errors], such as {error}", axis=axis.name, error=error)
        for term in shown:
            cell = max(side.cell for side in term.sides if side.axis == self.moves[0])
            if term.rest > 0 and base < cell * (1 - 1e-9):
                what = (
                    "a base of {short} is shorter than {long}, within which the rest of {function} has no known slope"
                )
                remedy = "Use a longer base, give that error more knots, or take its rest out"
                short, long = format_quantity(base, "mm", 6), format_quantity(cell, "mm", 4)
                raise DescriptionError(what, remedy, short=short, long=long, function=term.name)


class Level(Rotation):
    """An electronic level."""

    instrument = "level"
    usual = Usual(2.0e-6, (ZERO,), 300.0, 5.0, 5.0, INCLINED)
    type_b = (replace(GAIN, size=0.02, source="assumption: 2 %", least=0.0),)


class Autocollimator(Rotation):
    """It looks at a mirror from afar."""

    instrument = "autocollimator"
    usual = Usual(0.5e-6, (ZERO,), 1800.0, 1.0, 3.0, INCLINED)
    type_b = (replace(GAIN, source="assumption: 1 %", least=0.0),)
    site = "line"
