"""Instruments that read a distance to the TCP from a point that is known roughly only: ball bar and length-only tracer.

y = |p + δp + R_t tool − station − shift| − |p − station| + zero

The centre of a bar shifts with its artefact. Rows are linearised about the best known place of the station. So a
station may be millimetres from its stated place, once readings have located it.

Tracers may read at once: one reading is the distance of the same tool point from each of their stations. The number of
a tracer, from 1, marks its unknowns: zero_2, station_x_2; the tool is the same for all. Which number is meant comes as
a direction (k,), 1 for it and 0 for the others.

The tool point against a ball, in three directions: the nest of an R-test, or a sphere that is touched.

y = δp + R_t tool − (s + ω × d + κ d + e) in the workpiece frame. `tool` is the offset in the spindle from the stated
place, and turns with the tool. The bracket is the ball against its stated place (see `artefact`). An R-test without an
artefact has the place of the nest as zero. A sphere touched at its pole and two sides n_i, not opposite ones, adds
− r Σ n_i. There r is by how much sphere and stylus are larger than stated.

The laser tracker: it reads where the TCP is, in all directions, from a station of unknown place and orientation.

Its place of the TCP, less the nominal one: y = R(turn)(p + δp + R_t tool − station) + station + zero − p.
A tracker set down by eye is turned by milliradians, so it is linear only about the turn θ₀ that is found (`found`).
There y = R(θ₀)(δp + R_t tool) + zero + J turn + c, J the derivative of R(θ)(p − station), c the reading without these.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from axiscal.machine.description import Machine
from axiscal.machine.kinematics import Deviation
from axiscal.measurement.instruments.kind import (
    TOOL,
    TOOL_READS,
    Model,
    Nominal,
    Reads,
    displaced,
    moves,
    need_station,
)
from axiscal.measurement.setup import Setup, Unknown
from axiscal.measurement.touched import touch_frames
from axiscal.numerics import Array
from axiscal_core import rigid

RADIUS = "radius"
ZEROS = ("zero_x", "zero_y", "zero_z")


class Nest(Model):
    """Three lengths along x, y, z of the workpiece frame."""

    reads: Reads = "length"
    values = 3
    directed = False
    unknown_reads: Mapping[str, Reads] = MappingProxyType({**dict.fromkeys((*ZEROS, RADIUS), "length"), **TOOL_READS})

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return the part of an unknown along d, (m,)."""
        if unknown in ZEROS:
            return np.full(nominal.count, direction[ZEROS.index(unknown)])
        larger = unknown == RADIUS
        moved = -touch_frames(nominal.machine, nominal.poses).sum(axis=1) if larger else moves(setup, unknown, nominal)
        part: Array = np.sum(self.direction_of(setup, direction, nominal) * moved, axis=1)
        return part

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Deviation, unknowns: Mapping[str, float]
    ) -> Array:
        """Return dᵀ(δp + R tool + zero − where the ball is − r Σ n_i), (m,)."""
        zero = np.array([unknowns.get(name, 0.0) for name in ZEROS])
        shown: Array = (displaced(setup, nominal, actual, unknowns) + zero) @ direction
        if unknowns.get(RADIUS):
            shown = shown + unknowns[RADIUS] * self.unknown_effect(setup, RADIUS, direction, nominal)
        return shown


SHIFTS = ("station_x", "station_y", "station_z")
_UNKNOWNS: dict[str, Reads] = dict.fromkeys(("zero", *SHIFTS, *TOOL), "length")
MOST = 4
"""Stations; no more are known to be bought together."""
_OWN = ("zero", *SHIFTS)
_LEAST = 1e-3
"""m: nearer to the station a distance has no direction; nobody measures there."""


class Distance(Model):
    """One distance, or one from each station."""

    reads: Reads = "length"
    values = 1
    directed = False
    unknown_reads: Mapping[str, Reads] = MappingProxyType(_UNKNOWNS)

    def direction_of(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return the unit vector from the station to the TCP, (m, 3)."""
        line = nominal.tcp - _Station.meant(setup, direction).found
        unit: Array = line / np.maximum(np.linalg.norm(line, axis=1, keepdims=True), _LEAST)
        return unit

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return 1 for the zero, the unit vector's part of the tool, less that of a shift of the station, (m,).

        Nothing for what is another station's.
        """
        name = _Station.meant(setup, direction).own(unknown)
        if name == "zero":
            return np.ones(nominal.count)
        moved = -np.eye(3)[SHIFTS.index(name)] if name in SHIFTS else moves(setup, name, nominal)
        part: Array = np.sum(self.direction_of(setup, direction, nominal) * moved, axis=1)
        return part

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Deviation, unknowns: Mapping[str, float]
    ) -> Array:
        """Return |p + δp + R tool − station − shift| − |p − station| + zero, (m,)."""
        station = _Station.meant(setup, direction)
        own = {station.own(name): value for name, value in unknowns.items()}
        shift = np.array([own.get(name, 0.0) for name in SHIFTS])
        moved = displaced(setup, nominal, actual, unknowns)
        seen = np.linalg.norm(nominal.tcp + moved - station.stated - shift, axis=1)
        shown: Array = seen - np.linalg.norm(nominal.tcp - station.stated, axis=1) + own.get("zero", 0.0)
        return shown

    def check_setup(self, setup: Setup, machine: Machine) -> None:
        """Raise DescriptionError without a station."""
        if not setup.stations:
            need_station(setup, "the {instrument}'s other end")


class _Station(NamedTuple):
    """The station that a number of a reading is from: where it is stated, where it is found, m; its number, from 1.

    suffix : of the names of its unknowns, "_2"; "" where one instrument reads
    """

    stated: Array
    found: Array
    suffix: str

    @classmethod
    def meant(cls, setup: Setup, direction: Array) -> _Station:
        """Return it.  direction : (k,) of k stations, 1 for the one that is meant"""
        which = int(np.argmax(direction)) if setup.stations else 0
        stated = np.array((setup.standing or ((0.0, 0.0, 0.0),))[which])
        shift = np.zeros(3) if setup.found is None else np.array(setup.found[3 * which : 3 * which + 3])
        return cls(stated, stated + shift, f"_{which + 1}" if setup.stations else "")

    def own(self, unknown: str) -> str:
        """Return what it alone would call an unknown; another station's stays as it is."""
        stem = unknown.removesuffix(self.suffix)
        return stem if stem in _OWN else unknown


def location_unknowns(setup: Setup) -> tuple[str, ...]:
    """Return the unknowns that say where stations are found, x, y, z of each, or how a tracker is turned."""
    if setup.instrument == "tracker":
        return TURNS
    return tuple(_numbered(name, number) for number in range(len(setup.stations)) for name in SHIFTS) or SHIFTS


def of_each(unknowns: Sequence[Unknown], count: int) -> tuple[Unknown, ...]:
    """Return the unknowns of so many stations, from those of one: its own for each of them, the others once."""
    own = [unknown for unknown in unknowns if unknown.name in _OWN]
    each = [replace(unknown, name=_numbered(unknown.name, k)) for k in range(count) for unknown in own]
    return (*each, *(unknown for unknown in unknowns if unknown.name not in _OWN))


def _numbered(name: str, number: int) -> str:
    return f"{name}_{number + 1}"


TURNS = ("turn_x", "turn_y", "turn_z")


class Tracker(Nest):
    """Three lengths along x, y, z of the workpiece frame."""

    unknown_reads: Mapping[str, Reads] = MappingProxyType(
        {**dict.fromkeys(ZEROS, "length"), **dict.fromkeys(TURNS, "angle"), **TOOL_READS}
    )

    def direction_of(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return d as it lies in the workpiece frame, R(θ₀)ᵀ d, for every reading, (m, 3)."""
        return np.broadcast_to(direction @ rigid.rotation(_found(setup))[0], (nominal.count, 3))

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return the part of a zero or of the tool along d, or of the turn of the frame about the station, (m,)."""
        if unknown not in TURNS:
            return super().unknown_effect(setup, unknown, direction, nominal)
        turn, line = _found(setup), nominal.tcp - _station(setup)
        on = rigid.skew(rigid.left_jacobian(turn)[:, :, TURNS.index(unknown)])  # how R(θ) turns on with that part of θ
        part: Array = line @ (on @ rigid.rotation(turn))[0].T @ direction
        return part

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Deviation, unknowns: Mapping[str, float]
    ) -> Array:
        """Return dᵀ( R(turn)(p + δp + R tool − station) − (p − station) + zero ), (m,)."""
        turn = rigid.rotation(np.array([[unknowns.get(name, 0.0) for name in TURNS]]))[0]
        zero = np.array([unknowns.get(name, 0.0) for name in ZEROS])
        line = nominal.tcp - _station(setup)
        shown: Array = ((line + displaced(setup, nominal, actual, unknowns)) @ turn.T - line + zero) @ direction
        return shown

    def check_setup(self, setup: Setup, machine: Machine) -> None:
        """Raise DescriptionError without a station."""
        need_station(setup, "the tracker")


def _station(setup: Setup) -> Array:
    return np.zeros(3) if setup.station is None else np.array(setup.station)


def _found(setup: Setup) -> Array:
    return np.array([setup.found or (0.0, 0.0, 0.0)])
