"""Instruments that read the displacement of the TCP along a direction: interferometer, indicator, probe, edge.

y = dᵀδp + zero + slope · s + growth · dᵀe s.
Here s is the travel of the moving axis from its middle, e its way in the workpiece frame.
A leg of a square that is turned by ω has the slope ω · (e × d): the two legs have it with opposite signs. The
growth is by how much the material is longer than at 20 °C. Its known part is taken off; the rest is an unknown.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.measurement.setup import GAUGE, LASER, SQUARE, ZERO, Setup, Unknown, Usual, known
from axiscal.measurement.type_b import AIR, GAIN, WARM, Read, TypeB, constant, scaled
from axiscal.numerics import Array
from axiscal_core import rigid
from axiscal_core.instrument import At, Unknowns


class Displacement(Setup):
    """One length along the set-up's direction."""

    unknown_reads = known("zero", "slope", "growth", *SQUARE)

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return dᵀδp + known growth + the effects of the unknowns: of a slope by its tangent."""
        moved = at.moved + self.grown(at) if self.growth else at.moved
        if self.offset is not None:
            arm = at.tool @ np.array(self.offset)
            moved = moved + rigid.turned(arm, at.turned) - arm
        shown: Array = moved @ np.array(self.direction)
        for name, size in u.items():
            if size:
                shown = shown + (np.tan(size) if name == "slope" else size) * self._effect(name, at)
        return [shown]

    def _effect(self, unknown: str, at: At) -> Array:
        """Return what a unit of an unknown adds, (m,).

        One for the zero, the travel for the slope, the travel along the direction for the growth, of a square the turn
        about x, y or z.
        """
        if unknown == "zero":
            return np.ones(len(at.poses))
        direction, travelled = np.array(self.direction), self.travelled(at.poses)
        if unknown == "slope":
            return travelled
        ways = self.ways(at.poses)
        if unknown in SQUARE:
            return travelled * np.cross(ways, direction)[:, SQUARE.index(unknown)]
        grown: Array = travelled * (ways @ direction)
        return grown


class Interferometer(Displacement):
    """A laser along a line."""

    instrument, site = "interferometer", "line"
    usual = Usual(0.3e-6, (ZERO,), 1800.0, 1.0, 3.0, LASER)
    light = against_length = display = True
    type_b = (
        TypeB(
            "scale", 1e-6, "um/m",
            "no certificate; a free red helium-neon laser is known to 1.5 ppm (Stone et al. 2009)",
            "instrument", scaled,
        ),
        AIR,
        TypeB(
            "cosine", 1e-3, "mrad", "beam set by eye; 1 − cos is half its square", "set-up",
            lambda read, size: size**2 / 2 * read.along, "rectangular",
        ),
        TypeB(
            "dead_path", 0.2, "mm", "assumption; its air is as above", "set-up",
            lambda read, size: dict(read.setup.stated).get("air", AIR.size) * size * read.ones, covered=("zero",),
        ),
        *WARM,
    )  # fmt: skip


class Indicator(Displacement):
    """A dial or lever gauge."""

    instrument, display = "indicator", True
    usual = Usual(1.0e-6, (ZERO,), 600.0, 1.0, 5.0, GAUGE)
    type_b = (GAIN,)


def _bowed(read: Read, size: float) -> Array:
    """Return a bow, (k, r), whose sag is `size` times its length."""
    way = read.setup.travelled(read.at.poses)
    span = float(np.ptp(way))
    bowed: Array = size * span * (2 * (way - way.min()) / (span or 1.0) - 1) ** 2 * read.ones
    return bowed


class Straightedge(Displacement):
    """It is read by an indicator, and lies at an unknown angle."""

    instrument, site, display = "straightedge", "reach", True
    usual = Usual(1e-6, (ZERO, Unknown("slope", 1e-3)), 1200.0, 1.0, 5.0, GAUGE)
    type_b = (
        TypeB(  # each leg has half of the angle between two
            "square", 10e-6, "urad", "assumption", "set-up",
            lambda read, size: size / np.sqrt(2.0) * read.setup.travelled(read.at.poses) * read.ones,
            applies=lambda setup: any(unknown.name in SQUARE for unknown in setup.unknowns),
        ),
        TypeB("bow", 2e-6, "um/m", "assumption", "set-up", _bowed),
        GAIN,
    )  # fmt: skip


class Probe(Displacement):
    """A touch probe in the spindle."""

    instrument, site = "probe", "reach"
    usual = Usual(1.0e-6, (ZERO,), 600.0, 0.5, 6.0, GAUGE, "retracted")
    type_b = (TypeB("pre_travel", 1e-6, "um", "assumption", "instrument", constant, covered=("zero",)),)


class PrinterProbe(Probe):
    """The probe of a 3D printer, which is there already.

    What owners have shown of Klipper's PROBE_ACCURACY, a standard deviation of ten readings, goes from 0.8 um (docked
    microswitches) to 13 um (inductive ones); 5 um is an assumption.
    """

    usual = Probe.usual._replace(noise=5e-6, setup_time=60.0)


class HalvedLength(Displacement):
    """A length in records of before: half of what it is too long at each end, from a zero that nobody knows."""

    instrument, site, against_length = "gauge", "length", True
    usual = Usual(20e-6, (Unknown("zero", 1e-2),), 120.0, 0.0, 20.0)
    type_b = (TypeB("scale", 20e-6, "um/m", "assumption; a gauge block has 1 um/m", "instrument", scaled), *WARM)


class Length(HalvedLength):
    """A length between two places: a gauge block, a step gauge, two balls, a ruler, or calipers on a workpiece.

    How much farther the tool is from a first place than it should be, along the line to the second. The usual noise is
    that of calipers up to 150 mm, whose maximum permissible error is 20 um as a rule.

    y = dᵀ(δp − δp₁) + growth · L, where at.moved is the difference, L the length.
    """

    usual = HalvedLength.usual._replace(unknowns=())
    unknown_reads = known("growth")

    def middle(self, at: At) -> Array:
        """Return its first end."""
        first: Array = self.machine.frames(np.array([self.start])).tcp
        return first

    def grown(self, at: At) -> Array:
        """Return how much farther a machine that is warmer than 20 °C takes the tool from there, (m, 3) m."""
        return np.asarray(self.growth * (at.tcp - self.middle(at)))

    def _effect(self, unknown: str, at: At) -> Array:
        """Return what a unit of growth adds, (m,)."""
        along: Array = (at.tcp - self.middle(at)) @ np.array(self.direction)
        return along
