"""Bilateral leadscrew tables (`kw.ssfk`): what an axis is off by, for each direction, in tenths of a µm or 1e-4 deg.

A value is the actual position less the setpoint ("absolute position errors", TF5200 axis compensation), and the kernel
takes it away. Points are evenly spaced from kw_startpos on.
"""

from __future__ import annotations

import re

import numpy as np

from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.tables.loaded import Lookup
from axiscal.tables.table import CompensationTable
from axiscal.units import from_unit, to_unit

_UNITS = {"mm": 1e-4, "deg": 1e-4}
"""One unit of the file in mm or deg."""
_LINE = re.compile(r"(kopf|kw\.ssfk)\.(\w+)(?:\[(\d+)\]\.(\w+))?\s+(\S+)")


def unit(axis_unit: str) -> float:
    """Return one unit of the file, m or rad."""
    return float(from_unit(_UNITS[axis_unit], axis_unit))


def write(table: CompensationTable, number: int, cyclic: bool) -> str:
    """Return the list of one axis; number : logical axis; cyclic : the table holds one turn and repeats."""
    position = table.unit
    at, forward, reverse = (_whole(values, position) for values in (table.positions, table.forward, table.reverse))
    steps = np.diff(at)
    if np.ptp(steps):
        raise TableError("the points of {axis} are not evenly spaced", "leave the spacing to axiscal", axis=table.axis)
    keys = {"interval": steps[0], "kw_startpos": at[0], "kw_nr_max": len(at), "unit": 1, "bilateral": 1}
    lines = [f"kopf.log_achs_nr {number}", f"kopf.log_achs_name {table.axis}"]
    lines += [f"kw.ssfk.{key} {value}" for key, value in {**keys, "modulo": int(cyclic)}.items()]
    for name, values in (("pos", forward), ("neg", reverse)):
        lines += [f"kw.ssfk.table[{i}].{name} {value}" for i, value in enumerate(values)]
    return "\n".join(lines) + "\n"


def read(text: str, machine: Machine) -> list[Lookup]:
    """Return what the kernel makes of a list; raises TableError for a line that it would not know."""
    keys, sides = dict[str, str](), {"pos": dict[int, int](), "neg": dict[int, int]()}
    for line in text.splitlines():
        found = _LINE.fullmatch(line)
        if found is None or (found[4] is not None and found[4] not in sides):
            raise TableError("the kernel would not know {text!r}", "this is a defect of axiscal", text=line[:40])
        if found[4] is None:
            keys[found[2]] = found[5]
        else:
            sides[found[4]][int(found[3])] = int(found[5])
    needed = ("log_achs_name", "kw_nr_max", "kw_startpos", "interval")
    if missing := [key for key in needed if key not in keys]:
        raise TableError("the list says no kw.ssfk.{missing}", "give it as the kernel loads it", missing=missing[0])
    count = int(keys["kw_nr_max"])
    if any(set(values) != set(range(len(values))) or len(values) != count for values in sides.values()):
        remedy = "give it as the kernel loads it"
        raise TableError("the list has not its {count} entries on both sides", remedy, count=count)
    axis = machine.axis(keys["log_achs_name"])
    scale = unit(axis.unit)
    at: Array = scale * (int(keys["kw_startpos"]) + int(keys["interval"]) * np.arange(count, dtype=float))
    pos, neg = (-scale * np.array([values[i] for i in range(count)]) for values in sides.values())
    return [Lookup(axis.name, axis.name, at, pos, 1), Lookup(axis.name, axis.name, at, neg, -1)]


def _whole(values: Array, shown: str) -> Array:
    return np.round(np.asarray(to_unit(values, shown)) / _UNITS[shown]).astype(np.int64)
