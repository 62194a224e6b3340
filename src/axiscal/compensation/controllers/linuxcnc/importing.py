"""Old compensation of a LinuxCNC: `COMP_FILE` of either type, `BACKLASH`, and curves of axes over axes in HAL text."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.compensation.controllers.linuxcnc.reader import LinuxcncTable, parse
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.loaded import Loaded
from axiscal.compensation.lookup import Lookup
from axiscal.compensation.old_files import OldFile
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.units import from_unit

_CURVE = re.compile(r"setp\s+\S*?\b([a-z][0-9]?)-([a-z][0-9]?)\.([xy])-val-(\d+)\s+(\S+)")

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,2})?", re.ASCII)

_LARGEST = 1e6
"""In the machine's unit: a kilometre in millimetres, which no table corrects."""


def load(files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
    """Return what the files did; raises TableError."""
    joints = options.joints(machine)
    lookups: list[Lookup] = []
    for file in files:
        if file.name.lower().endswith(".hal"):
            lookups += _curves(file, machine, options.unit)
            continue
        axis = _axis(file, machine, joints)
        one = _backlash if file.backlash else _table
        lookups += one(file, axis, machine, options.unit)
    return Loaded(tuple(lookups))


def _axis(file: OldFile, machine: Machine, joints: Mapping[str, Sequence[int]]) -> str:
    """Return the axis that a file is for: as said, by its joint, or by its name, X.comp or joint0.comp."""
    names = {axis.name.casefold(): axis.name for axis in machine.axes}
    if file.axis:
        return machine.axis(file.axis).name
    number = file.joint
    if number is None and (numbered := re.search(r"joint_?(\d+)", file.stem, re.IGNORECASE)):
        number = int(numbered[1])
    owners = [axis for axis, numbers in joints.items() if number in numbers]
    if owners:
        return owners[0]
    for word in re.split(r"[^A-Za-z0-9]+", file.stem):
        if word.casefold() in names:
            return names[word.casefold()]
    raise TableError("nothing says which axis this table is for", f"write --on-top-of X={file.name}", file.name)


def _table(file: OldFile, axis: str, machine: Machine, machine_unit: str) -> list[Lookup]:
    kept = _parsed(file, _type(file))
    if not len(kept.nominal):
        raise TableError("LinuxCNC reads no row of this file", "name a COMP_FILE", file.name)
    unit = "deg" if machine.axis(axis).rotary else machine_unit
    at, forward, reverse = (from_unit(values, unit) for values in (kept.nominal, kept.forward, kept.reverse))
    return [Lookup(axis, axis, at, forward, 1), Lookup(axis, axis, at, reverse, -1)]


def _parsed(file: OldFile, file_type: int) -> LinuxcncTable:
    kept = parse(file.text, file_type=file_type)
    if not all(np.all(np.abs(column) < _LARGEST) for column in (kept.nominal, kept.forward, kept.reverse)):
        raise TableError(
            "it has a number that is too large for a machine", "give the file as the control loads it", file.name
        )
    return kept


def _type(file: OldFile) -> int:
    """Return COMP_FILE_TYPE, found from the values where nobody said: those of Type 0 go with the nominal ones."""
    if file.file_type is not None:
        return file.file_type
    rows = _parsed(file, 1)
    if len(rows.nominal) < 2:
        return 0
    slope = np.ptp(rows.forward) / np.ptp(rows.nominal)
    return 0 if slope > 0.5 else 1


def _backlash(file: OldFile, axis: str, machine: Machine, unit: str) -> list[Lookup]:
    """Return half the backlash to each side, as motion adds it (control.c)."""
    own = machine.axis(axis)
    half = float(from_unit((file.backlash or 0.0) / 2, "deg" if own.rotary else unit))
    at = np.array(own.travel)
    return [Lookup(axis, axis, at, np.full(2, side * half), side) for side in (1, -1)]


def _curves(file: OldFile, machine: Machine, unit: str) -> list[Lookup]:
    """Return the curves of axes over other axes."""
    found: dict[tuple[str, str], dict[str, dict[int, float]]] = {}
    for moved, over, side, number, value in _CURVE.findall(file.text):
        if not _NUMBER.fullmatch(value):
            raise TableError(f"{value[:40]!r} is no number of a curve", "give the HAL file as it is", file.name)
        found.setdefault((moved.upper(), over.upper()), {"x": {}, "y": {}})[side][int(number)] = float(value)
    lookups = []
    for (moved, over), sides in found.items():
        x, y = (np.array([sides[side][i] for i in sorted(sides[side])]) for side in "xy")
        if len(x) != len(y) or np.any(np.diff(x) <= 0):
            raise TableError(f"the curve of {moved} over {over} is not whole", "give the HAL file as it is", file.name)
        at, added = _inside(x, machine.axis(over).rotary, unit), _inside(y, machine.axis(moved).rotary, unit)
        lookups.append(Lookup(moved, over, at, added))
    return lookups


def _inside(values: Array, rotary: bool, unit: str) -> Array:
    return np.asarray(from_unit(values, "deg" if rotary else unit), dtype=float)
