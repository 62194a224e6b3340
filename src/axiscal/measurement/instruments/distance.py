"""Instruments that read a distance to the TCP from a point that is known roughly only: ball bar and length-only tracer.

y = |p + δp + R_t tool − station − shift| − |p − station| + zero, the centre of a bar shifting with its artefact:
linearised about the best known place of the station, so that a station that is millimetres away from where it was said
to be does no harm once its place has been found.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from axiscal.machine.description import Machine
from axiscal.measurement.instruments.kind import (
    TOOL,
    Actual,
    Nominal,
    Reads,
    ball_effect,
    ball_moved,
    displaced,
    need_station,
    tool_part,
)
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

SHIFTS = ("station_x", "station_y", "station_z")
_UNKNOWNS: dict[str, Reads] = dict.fromkeys(("zero", *SHIFTS, *TOOL), "length")
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

    def curvature(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return Eᵀ(1 − uuᵀ)E/ρ, E what each unknown does to the line from the station to the tool, (m, k, k)."""
        line = nominal.tcp - _found(setup)
        away = np.maximum(np.linalg.norm(line, axis=1), _LEAST)
        unit = line / away[:, None]
        moved = np.stack([_moved(setup, u.name, nominal) for u in setup.unknowns], axis=2)
        across = moved - unit[:, :, None] * np.einsum("mc,mck->mk", unit, moved)[:, None, :]
        curved: Array = np.einsum("mcj,mck->mjk", across, across) / away[:, None, None]
        return curved

    def check(self, setup: Setup, machine: Machine) -> None:
        """Raise DescriptionError without a station."""
        need_station(setup, f"the {setup.instrument}'s other end")


def _moved(setup: Setup, unknown: str, nominal: Nominal) -> Array:
    """Return what a unit of an unknown does to the line from the station to the tool, (m, 3)."""
    if unknown in TOOL:
        moved: Array = nominal.tool[:, :, TOOL.index(unknown)]
        return moved
    if unknown in SHIFTS:
        return np.broadcast_to(-np.eye(3)[SHIFTS.index(unknown)], (nominal.count, 3))
    return np.zeros((nominal.count, 3)) if unknown == "zero" else ball_effect(setup, unknown, nominal)


def _stated(setup: Setup) -> Array:
    return np.zeros(3) if setup.station is None else np.array(setup.station)


def _found(setup: Setup) -> Array:
    found: Array = _stated(setup) + np.array(setup.found or (0.0, 0.0, 0.0))
    return found
