"""Instruments that read a distance to the TCP from a point that is known roughly only: ball bar and length-only tracer.

y = |p + δp + R_t tool − station − shift| − |p − station| + zero

The centre of a bar shifts with its artefact. Rows are linearised about the best known place of the station. So a
station may be millimetres from its stated place, once readings have located it.

Tracers may read at once: one reading is the distance of the same tool point from each of their stations. The number of
a tracer, from 1, marks its unknowns: zero_2, station_x_2; the tool is the same for all.

The tool point against a ball, in three directions: the nest of an R-test, or a sphere that is touched.

y = δp + R_t tool − (s + ω × d + κ d + e) in the workpiece frame. `tool` is the offset in the spindle from the stated
place, and turns with the tool. The bracket is the ball against its stated place (see `artefact`). An R-test without an
artefact has the place of the nest as zero.

The laser tracker: it reads where the TCP is, in all directions, from a station of unknown place and orientation.

Its place of the TCP, less the nominal one: y = R(turn)(p + δp + R_t tool − station) + station + zero − p.
A tracker set down by eye is turned by milliradians, so it is linear only about the turn θ₀ that is found (`found`).
There y = R(θ₀)(δp + R_t tool) + zero + J turn + c, J the derivative of R(θ)(p − station), c the reading without these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.measurement.setup import CARRIED, GAUGE, LASER, ZERO, Setup, Unknown, Usual, known
from axiscal.measurement.touched import touch_frames
from axiscal.measurement.type_b import AIR, GAIN, WARM, Read, TypeB, constant, scaled
from axiscal.numerics import Array
from axiscal_core import rigid
from axiscal_core.instrument import TOOL, At, Unknowns, length

ZEROS = ("zero_x", "zero_y", "zero_z")
_ON_TOOL = Unknown.each(TOOL, CARRIED)
_THREE = Unknown.each(ZEROS, ZERO.std)


class Nest(Setup):
    """Three lengths along x, y, z of the workpiece frame."""

    numbers = ("x", "y", "z")
    directed = False
    unknown_reads = known(*ZEROS, *TOOL)

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return δp + R tool + zero − where the ball is."""
        return _from_zeros(self.tip(at, u), u)


class RTest(Nest):
    """A nest that a ball in the spindle stays in."""

    instrument = "rtest"
    usual = Usual(0.7e-6, (*_THREE, *_ON_TOOL), 900.0, 1.0, 3.0, GAUGE, "held")
    type_b = (*WARM, GAIN)
    site = "ball"


def _larger(read: Read, size: float) -> Array:
    """Return what a larger sphere and stylus do: in the mean of opposite sides its pole alone shows them, (k, r)."""
    larger: Array = -size * np.sum(read.ways * touch_frames(read.setup.machine, read.at.poses)[:, 2], axis=2)
    return larger


class TouchedSphere(Nest):
    """A sphere that a probe in the spindle touches from all sides; mounted ball by ball."""

    instrument, all_round = "sphere", True
    usual = Usual(1.5e-6, (), 300.0, 1.0, 15.0, GAUGE, "retracted")
    type_b = (*WARM, TypeB("radius", 1e-6, "um", "assumption", "instrument", _larger, covered=("radius",)))
    site = "ball"


def _from_zeros(place: Array, u: Unknowns) -> list[Array]:
    return [part + u[zero] for part, zero in zip(place.T, ZEROS, strict=True)]


SHIFTS = ("station_x", "station_y", "station_z")
_OWN = ("zero", *SHIFTS)


class Distance(Setup):
    """One distance, or one from each station."""

    directed = False
    unknown_reads = known(*_OWN, *TOOL)

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return |p + δp + R tool − station − shift| − |p − station| + zero."""
        tip, shown = self.tip(at, u), list[Array]()
        for number, station in enumerate(self.standing):
            zero, *shifts = (_numbered(name, number) for name in _OWN) if self.stations else _OWN
            shift = np.array([u.get(name, 0.0) for name in shifts])
            seen = length(at.tcp + tip - np.array(station) - shift)
            shown.append(seen - length(at.tcp - np.array(station)) + u.get(zero, 0.0))
        return shown

    @property
    def located(self) -> tuple[str, ...]:
        """X, y, z of each station."""
        return tuple(_numbered(name, number) for number in range(len(self.stations)) for name in SHIFTS) or SHIFTS

    @property
    def names(self) -> tuple[str, ...]:
        """The numbers of the stations."""
        return tuple(str(number + 1) for number in range(len(self.stations))) or self.numbers


class BallBar(Distance):
    """A bar about a cup, which is set to a tenth of a millimetre."""

    instrument = "ballbar"
    usual = Usual(0.5e-6, (ZERO, *Unknown.each(SHIFTS, 1e-4), *_ON_TOOL), 900.0, 0.5, 1.0, GAUGE)
    type_b = (
        TypeB(
            "length", 1e-6, "um", "assumption: 1 um and 2 um/m", "instrument", constant, covered=("zero",), longer=2e-6,
        ),
    )  # fmt: skip
    site = "bar"


# its maker states an MPE
_SCALE = TypeB("scale", 1.5e-6, "um/m", "assumption; its maker states an MPE", "instrument", scaled)


def _strained(read: Read, size: float) -> Array:
    """Return a strain of the distance from the station, (k, r)."""
    stations = np.array(read.setup.standing)
    strained: Array = size * np.linalg.norm(read.at.tcp - stations[:, None], axis=2)
    return strained


class Tracer(Distance):
    """A length-only interferometer that follows the tool from a station that nobody knows within five millimetres."""

    instrument = "tracer"
    usual = Usual(0.3e-6, (ZERO, *Unknown.each(SHIFTS, 5e-3), *_ON_TOOL), 1800.0, 1.0, 3.0, LASER)
    type_b = (replace(AIR, effect=_strained), *WARM, replace(_SCALE, effect=_strained))
    light = against_length = True
    site = "sight"


def of_each(unknowns: Sequence[Unknown], count: int) -> tuple[Unknown, ...]:
    """Return the unknowns of so many stations, from those of one: its own for each of them, the others once."""
    own = [unknown for unknown in unknowns if unknown.name in _OWN]
    each = [replace(unknown, name=_numbered(unknown.name, k)) for k in range(count) for unknown in own]
    return (*each, *(unknown for unknown in unknowns if unknown.name not in _OWN))


def _numbered(name: str, number: int) -> str:
    return f"{name}_{number + 1}"


TURNS = ("turn_x", "turn_y", "turn_z")


class Tracker(Setup):
    """Three lengths along x, y, z of the workpiece frame, from a station that is set up by eye: a milliradian."""

    instrument = "tracker"
    usual = Usual(10e-6, (*_THREE, *Unknown.each(TURNS, 1e-3), *_ON_TOOL), 3600.0, 2.0, 5.0, LASER)
    type_b = (AIR, *WARM, _SCALE)
    light, against_length, directed = True, True, False
    numbers = ("x", "y", "z")
    site = "sight"
    unknown_reads = known(*ZEROS, *TURNS, *TOOL)

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return R(turn)(p + δp + R tool − station) − (p − station) + zero."""
        line = at.tcp - np.array(self.station or (0.0, 0.0, 0.0))
        turn = rigid.rotation(np.array([[u[name] for name in TURNS]]))[0]
        return _from_zeros((line + self.tip(at, u)) @ turn.T - line, u)

    @property
    def located(self) -> tuple[str, ...]:
        """How it is turned."""
        return TURNS
