"""Places, directions and approaches as people and files write them: mm and deg, "-y", "X+ Y-"."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from axiscal.language.spoken import listed, put, said
from axiscal.machine.axis import Axis
from axiscal.measurement.instrument import INSTRUMENTS, values_of
from axiscal.measurement.instruments.distance import MOST
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.units import to_unit

_VALUE_COLUMNS = ("value_um", "value_urad", *(f"value_{name}_um" for name in ("x", "y", "z", *range(1, MOST + 1))))
"""Columns for values in a file of readings, in their order."""
_TO_A_MICROMETRE = 6
"""Decimals of m, or rad: a reading is told from others by less, and where it was taken stands in the list."""


def shown_coordinate(value: float, axis: Axis) -> float:
    """Return a coordinate (m or rad) in mm or deg, without the digits that the conversion left."""
    converted = to_unit(value, axis.unit)
    return round(converted, 9) + 0.0 if math.isfinite(converted) else converted


def shown_pose(axes: Sequence[Axis], pose: Sequence[float]) -> dict[str, float]:
    """Return a pose (n_axes,) in mm and deg by axis."""
    return {axis.name: shown_coordinate(value, axis) for axis, value in zip(axes, pose, strict=True)}


def place_text(axes: Sequence[Axis], pose: Sequence[float], only: Sequence[int] | None = None) -> str:
    """Return a pose as "X = 120 mm, C = 30 deg", of all axes or of some."""
    chosen = range(len(axes)) if only is None else only
    return listed(", ", [_coordinate(axes[k], shown_coordinate(pose[k], axes[k])) for k in chosen])


def _coordinate(axis: Axis, shown: float) -> str:
    return put("{axis} = {at:.9g} {unit}", axis=axis.name, at=float(shown), unit=axis.unit)


def place_read(axes: Sequence[Axis], setup: Setup, reading: Reading) -> str:
    """Return where a reading is taken, to the micrometre: 'X = 120 mm'; "" where nothing moves."""
    return place_text(axes, [round(value, _TO_A_MICROMETRE) for value in reading.pose], setup.moves)


def reading_text(axes: Sequence[Axis], setup: Setup, reading: Reading, index: int) -> str:
    """Return which reading is meant: 'reading 7 in "laser" at X = 120 mm'.  index : in the list of readings"""
    place, number = place_read(axes, setup, reading), reading.numbered(index)
    if not place:
        return said('reading {number} in "{setup}"', number=number, setup=setup.name)
    return said('reading {number} in "{setup}" at {place}', number=number, setup=setup.name, place=place)


def shown_approach(axes: Sequence[Axis], approach: Sequence[float]) -> dict[str, str]:
    """Return "+" or "-" by axis, for the axes whose direction of the last motion counts.  approach : +1, -1, 0."""
    return {a.name: "+" if sign > 0 else "-" for a, sign in zip(axes, approach, strict=True) if sign}


def approach_text(axes: Sequence[Axis], approach: Sequence[float]) -> str:
    """Return the directions of approach as files of readings have them: "X+ Y-"."""
    return " ".join(name + sign for name, sign in shown_approach(axes, approach).items())


def direction_text(setup: Setup) -> str:
    """Return the direction that a set-up reads along or about: "x", "-y" or "(0.6, 0.8, 0)"."""
    for letter, component in zip("xyz", setup.direction, strict=True):
        if abs(component) == 1:
            return letter if component > 0 else f"-{letter}"
    return "(" + ", ".join(f"{component:.4g}" for component in setup.direction) + ")"


def value_names(setup: Setup) -> tuple[str, ...]:
    """Return what the numbers of a reading are told apart by: x, y, z, or those of the stations; "" of a single one."""
    if setup.stations:
        return tuple(str(number) for number in range(1, values_of(setup) + 1))
    return ("x", "y", "z") if values_of(setup) > 1 else ("",)


def value_columns(setup: Setup) -> tuple[str, ...]:
    """Return the columns of a file of readings for its values, such as value_um, or value_x_um and two more."""
    return tuple(f"value{'_' * bool(name)}{name}_{reading_unit(setup)}" for name in value_names(setup))


def columns_of(setups: Iterable[Setup]) -> list[str]:
    """Return the columns of a file of readings for the values of set-ups, those of each kind beside each other."""
    needed = {column for setup in setups for column in value_columns(setup)}
    return [column for column in _VALUE_COLUMNS if column in needed]


def reading_unit(setup: Setup) -> str:
    """Return the unit in which its readings are shown: "um" or "urad"."""
    return "um" if INSTRUMENTS[setup.instrument].reads == "length" else "urad"
