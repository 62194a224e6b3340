"""Instruments that read a distance to the TCP from a point that is known roughly only: ball bar and length-only tracer.

y = |p + δp + R_t tool − station − shift| − |p − station| + zero

The centre of a bar shifts with its artefact. Rows are linearised about the best known place of the station. So a
station may be millimetres from its stated place, once readings have located it.

Tracers may read at once: one reading is the distance of the same tool point from each of their stations. The number of
a tracer, from 1, marks its unknowns: zero_2, station_x_2; the tool is the same for all. Which number is meant comes as
a direction (k,), 1 for it and 0 for the others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from axiscal.machine.description import Machine
from axiscal.measurement.instruments.kind import (
    TOOL,
    TOOL_READS,
    Actual,
    Nominal,
    Reads,
    ball_effect,
    ball_moved,
    displaced,
    need_station,
    tool_part,
)
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array

SHIFTS = ("station_x", "station_y", "station_z")
_UNKNOWNS: dict[str, Reads] = dict.fromkeys(("zero", *SHIFTS, *TOOL), "length")
MOST = 4
"""Stations; no more are known to be bought together."""
_OWN = ("zero", *SHIFTS)
_LEAST = 1e-3
"""m: nearer to the station a distance has no direction; nobody measures there."""


class Distance:
    """One distance."""

    reads: Reads = "length"
    values = 1
    directed = False
    unknown_reads: Mapping[str, Reads] = MappingProxyType(_UNKNOWNS)

    def direction_of(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return the unit vector from the station to the TCP, (m, 3)."""
        line = nominal.tcp - _found(setup)
        unit: Array = line / np.maximum(np.linalg.norm(line, axis=1, keepdims=True), _LEAST)
        return unit

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return 1 for the zero, the unit vector's part of the tool, less that of a shift of the station, (m,)."""
        if unknown == "zero":
            return np.ones(nominal.count)
        unit = self.direction_of(setup, direction, nominal)
        if unknown in TOOL:
            return tool_part(unknown, unit, nominal)
        if unknown in SHIFTS:
            return -unit[:, SHIFTS.index(unknown)]
        part: Array = np.einsum("mc,mc->m", ball_effect(setup, unknown, nominal), unit)
        return part

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Actual, unknowns: Mapping[str, float]
    ) -> Array:
        """Return |p + δp + R tool − station − shift| − |p − station| + zero, (m,)."""
        stated = _stated(setup)
        shift = np.array([unknowns.get(name, 0.0) for name in SHIFTS])
        moved = displaced(nominal, actual, unknowns) + ball_moved(setup, unknowns, nominal)
        seen = np.linalg.norm(nominal.tcp + moved - stated - shift, axis=1)
        shown: Array = seen - np.linalg.norm(nominal.tcp - stated, axis=1) + unknowns.get("zero", 0.0)
        return shown

    def nonlinear_part(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return |p − station − s| − |p − station| + uᵀs, with s the shift found and u the unit vectors there, (m,)."""
        shift = _found(setup) - _stated(setup)
        now, first = (np.linalg.norm(nominal.tcp - at, axis=1) for at in (_found(setup), _stated(setup)))
        part: Array = now - first + self.direction_of(setup, shift, nominal) @ shift
        return part

    def check(self, setup: Setup, machine: Machine) -> None:
        """Raise DescriptionError without a station."""
        need_station(setup, "the {instrument}'s other end")


_ONE = Distance()


class Distances:
    """One distance from each station."""

    reads: Reads = "length"
    values = MOST
    directed = False
    unknown_reads: Mapping[str, Reads] = MappingProxyType(
        {**{f"{name}_{k + 1}": "length" for name in _OWN for k in range(MOST)}, **TOOL_READS}
    )

    def direction_of(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return the unit vector from its station to the TCP, (m, 3)."""
        return _ONE.direction_of(_alone(setup, _meant(direction)), direction, nominal)

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return the same as of one tracer, nothing for what is another one's, (m,)."""
        which = _meant(direction)
        name = _own_name(unknown, which)
        if name is None:
            return np.zeros(nominal.count)
        return _ONE.unknown_effect(_alone(setup, which), name, direction, nominal)

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Actual, unknowns: Mapping[str, float]
    ) -> Array:
        """Return what this one of them would show, (m,)."""
        which = _meant(direction)
        named = ((_own_name(name, which), value) for name, value in unknowns.items())
        own = {name: value for name, value in named if name is not None}
        return _ONE.shown(_alone(setup, which), direction, nominal, actual, own)

    def nonlinear_part(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return what this one of them shows beside rows times unknowns, (m,)."""
        return _ONE.nonlinear_part(_alone(setup, _meant(direction)), direction, nominal)

    def check(self, setup: Setup, machine: Machine) -> None:
        """Everything makes sense: where they stand is said."""


def shifts_of(number: int) -> tuple[str, ...]:
    """Return the names of where the station of a number is found, x, y, z.  number : from 0"""
    return tuple(_numbered(name, number) for name in SHIFTS)


def of_each(unknowns: Sequence[Unknown], count: int) -> tuple[Unknown, ...]:
    """Return the unknowns of so many stations, from those of one: its own for each of them, the others once."""
    own = [unknown for unknown in unknowns if unknown.name in _OWN]
    each = [replace(unknown, name=_numbered(unknown.name, k)) for k in range(count) for unknown in own]
    return (*each, *(unknown for unknown in unknowns if unknown.name not in _OWN))


def _stated(setup: Setup) -> Array:
    return np.zeros(3) if setup.station is None else np.array(setup.station)


def _found(setup: Setup) -> Array:
    found: Array = _stated(setup) + np.array(setup.found or (0.0, 0.0, 0.0))
    return found


def _alone(setup: Setup, which: int) -> Setup:
    """Return one of the tracers as a separate set-up."""
    found = None if setup.found is None else setup.found[3 * which : 3 * which + 3]
    named = ((_own_name(unknown.name, which), unknown) for unknown in setup.unknowns)
    own = tuple(replace(unknown, name=name) for name, unknown in named if name is not None)
    return replace(setup, station=setup.stations[which], stations=(), found=found, unknowns=own)


def _meant(direction: Array) -> int:
    return int(np.argmax(direction))


def _numbered(name: str, number: int) -> str:
    return f"{name}_{number + 1}"


def _own_name(unknown: str, number: int) -> str | None:
    """Return what one tracer calls an unknown of them all; None where it is another one's."""
    if unknown in TOOL:
        return unknown
    stem, _, last = unknown.rpartition("_")
    return stem if last == str(number + 1) else None
