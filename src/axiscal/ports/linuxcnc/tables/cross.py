"""Straightness, sag and squareness for LinuxCNC: HAL text that moves an axis by the position of another.

`COMP_FILE` knows one axis only. Between motion and drives HAL can add any function of one position: a `lincurve` of 16
points for each pair. Their sum for an axis goes through a gain, which rises from 0 to 1 once all joints are homed and
falls when one is not. A limit of its speed follows, since the coordinate of a joint jumps at homing. HAL adds the sum
to the command of every joint of the axis and takes it off its feedback, so LinuxCNC does not see it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.document.file import number_or_none
from axiscal.document.ports import rendered
from axiscal.exceptions import InputError, TableError
from axiscal.tables.loaded import OldFile
from axiscal.tables.table import CompensationTable
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

POINTS = 16
"""By LinuxCNC's manual: points of a `lincurve`."""
RAMP = 1.0
"""Seconds from nothing to the whole correction."""
_LEAST_SPEED = 2e-4
"""m/s; the correction of an axis may always move as fast."""
_HEADROOM = 4.0
"""The correction may move as many times faster than the axes that are looked up ask for at their stated speed."""
_POINT = re.compile(r"\s*setp\s+\S*[xy]-val-\d+\s")
_CURVE = re.compile(r"setp\s+\S*?\b([a-z][0-9]?)-([a-z][0-9]?)\.([xy])-val-(\d+)\s+(\S+)")


def write(
    tables: Sequence[CompensationTable],
    joints: Mapping[str, Sequence[int]],
    speeds: Mapping[str, float],
    unit: str = "mm",
) -> str:
    """Return the HAL text; tables : over other axes, 16 points at most.  Raises TableError.

    joints : numbers of those of each axis; speeds : of each axis, m/s; unit : of the configuration, mm or in
    """
    own, overs, curves = dict[str, list[CompensationTable]](), dict[str, list[str]](), list[dict[str, object]]()
    for table in tables:
        table.refuse_more(POINTS)
        if other := next((axis for axis in (table.axis, table.over) if len(axis) != 1), ""):
            raise TableError("LinuxCNC has no axis {axis}", "Its axes are X Y Z A B C U V W", axis=other)
        added = np.round(-np.asarray(to_unit((table.forward + table.reverse) / 2, table.value_unit(unit))), 7) + 0.0
        curves.append({"name": _name(table), "points": [*zip(to_unit(table.positions, unit), added, strict=True)]})
        own.setdefault(table.axis, []).append(table)
        overs.setdefault(table.over, []).append(_name(table))
    moved = list[dict[str, object]]()
    for axis, mine in own.items():
        (first, *parts), low, several = map(_name, mine), axis.lower(), len(joints[axis]) > 1
        labels = [(n, f"{low}-joint-{n}" if several else low) for n in joints[axis]]
        speed = f"{to_unit(fastest(mine, speeds), unit):.6g}"
        moved.append({"axis": axis, "low": low, "first": first, "parts": parts, "fastest": speed, "joints": labels})
    positions = [(over.lower(), joints[over][0], names) for over, names in overs.items()]
    known = {"curves": curves, "positions": positions, "moved": moved}
    values = {"ramp": f"{RAMP:g}", "slope": f"{1 / RAMP:g}", "headroom": f"{_HEADROOM:g}"}
    return rendered("axiscal.ports.linuxcnc", "cross.hal.jinja", **known, **values)


def _name(table: CompensationTable) -> str:
    return f"cross-{table.axis.lower()}-{table.over.lower()}"


def fastest(own: Sequence[CompensationTable], speeds: Mapping[str, float]) -> float:
    """Return how fast the correction of an axis may move, m/s."""
    return max(_LEAST_SPEED, _HEADROOM * sum(steepest(table) * speeds[table.over] for table in own))


def steepest(table: CompensationTable) -> float:
    """Return the largest slope of a table."""
    return float(np.max(np.abs(np.diff(table.forward) / np.diff(table.positions))))


def read(file: OldFile, machine: Machine, unit: str, untaken: list[InputError]) -> list[CompensationTable]:
    """Return the curves of axes over other axes in a HAL text; untaken : takes points that are of none."""
    found = dict[tuple[str, str], dict[str, dict[int, float | None]]]()
    for line, text in enumerate(file.text.splitlines(), 1):
        if curve := _CURVE.search(text):
            sides = found.setdefault((curve[1].upper(), curve[2].upper()), {"x": {}, "y": {}})
            sides[curve[3]][int(curve[4])] = number_or_none(curve[5])
        elif _POINT.match(text):
            what, remedy = "{text!r} names no axis over another one", "name the curve as in setp y-x.x-val-00 0"
            untaken.append(TableError(what, remedy, file.name, line, text=text.strip()[:60]))
    tables = []
    for (moved, over), sides in found.items():
        x, y = (np.array([sides[side][i] for i in sorted(sides[side])], dtype=float) for side in "xy")
        if len(x) != len(y) or not np.all(np.diff(x) > 0) or not np.all(np.isfinite(y)):
            what, remedy = "the curve of {moved} over {over} is not whole", "give the HAL file as it is"
            raise TableError(what, remedy, file.name, moved=moved, over=over)
        at, added = (from_unit(each, "deg" if machine.axis(n).rotary else unit) for n, each in ((over, x), (moved, y)))
        tables.append(CompensationTable(moved, at, -added, -added, over=over))
    return tables
