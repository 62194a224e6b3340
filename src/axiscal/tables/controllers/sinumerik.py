"""All tables for a SINUMERIK 840D sl, ONE or 828D.

`$AA_ENC_COMP` has no direction: it holds the mean of both. Two `$AN_CEC` tables, one for each direction, hold the
difference to it; their input is their output. CEC tables with another input hold straightness, sag and squareness.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from axiscal.document.file import number_or_none
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import InputError, TableError
from axiscal.language.spoken import later
from axiscal.numerics import Array
from axiscal.tables.exporter import ExportOptions, TableFormat, Written, paragraphs, sign_said
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.table import CompensationTable
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

_BESIDE = re.compile(r"^\s*N\d+\s+|'[\da-fA-F]{2,8}\s*$|;.*")  # numbers of blocks, sums of archives, remarks
_PASSED = re.compile(r"%_N_.*|CHANDATA\(.*|\$M[AN]_\w+ENABLE.*|\$SN_CEC_TABLE_ENABLE.*|NEWCONF.*|STOPRE.*|M17|M30|")
_VALUE = re.compile(r"\$A([AN])_(ENC_COMP|CEC)(?:_([A-Z_]+))?\[(\d+)(?:,(\w+))?(?:,(\w+))?\]\s*=\s*\(?([^)\s;]+)\)?")
_MOST_POINTS = 100_000
"""Of a table; controls hold a few thousand."""
_TABLES, _POINTS = 128, 2000
"""By SIEMENS' manual: CEC tables that a control holds; points that MD18342 allows for one."""
_SMALL = (8, 200)
"""Tables, and points of each, that an 828D has."""
_ENC, _CEC = "AX_EEC.INI", "NC_CEC.INI"
_ROUNDING = 1e-6
"""Of the last decimal of a limit: what lies over it through rounding alone raises it by no digit."""
_SIGN = "K3 of the Function Manual Extended Functions (6FC5397-1BP40) states the sign of ENC_COMP and not that of CEC"
_WHOSE = later(
    "Say whose it is, --number X=1 for AX1, or which system, --measuring-system 2; else take it out of the file"
)
_AGAIN = "give AX_EEC.INI and NC_CEC.INI as the control saved them"


class Sinumerik(TableFormat):
    """Encoder compensation and CEC tables."""

    holds = (
        "encoder compensation for every axis (the mean of both directions), and CEC tables for what the directions are "
        "apart, for straightness, sag and squareness."
    )
    left_out = "errors that depend on two axes at once, the orientation of the tool, and the reversal of straightness."
    takes = TableFormat.takes | {"--number", "--measuring-system", "--on-top-of"}
    unstated = "across"
    points = 200  # what an 828D holds for an axis
    grid = (1e-6, float(np.radians(1e-3)))  # by the decimals that are written

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return what the files are to hold, that of the old ones added; raises TableError."""
        return options.old.under_tables(super().tables(estimate, options), estimate.machine, _POINTS, even=True)

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return the files that are needed."""
        names, encoder, cec = _names(machine, options), options.encoder - 1, cec_tables(tables)
        own = [table for table in tables if table.axis == table.over]
        lines: dict[str, list[str]] = {_ENC: [], _CEC: []}
        for table in own:
            mean, axis = _shown(table, (table.forward + table.reverse) / 2), names[table.axis]
            lines[_ENC] += [f"$AA_ENC_COMP[{encoder},{i},{axis}]={value}" for i, value in enumerate(mean)]
            lines[_ENC] += [f"$AA_ENC_COMP_{key}[{encoder},{axis}]={value}" for key, value in _span(table).items()]
        sums, slopes = (dict[str, dict[int, float]]() for _ in range(2))
        for number, table in enumerate(cec):
            direction, values = _direction(table), table.reverse if _direction(table) < 0 else table.forward
            written = _shown(table, options.sign * values)
            lines[_CEC] += [f"$AN_CEC[{number},{i}]={value}" for i, value in enumerate(written)]
            modulo = {"IS_MODULO": (keys := _span(table)).pop("IS_MODULO")}
            keys = {"INPUT_AXIS": f"({names[table.over]})", "OUTPUT_AXIS": f"({names[table.axis]})", **keys}
            keys |= {"DIRECTION": str(direction), "MULT_BY_TABLE": "0", **modulo}
            lines[_CEC] += [f"$AN_CEC_{key}[{number}]={value}" for key, value in keys.items()]
            size = float(np.max(np.abs(to_unit(values, table.value_unit()))))
            slope = 100 * float(np.max(np.abs(np.diff(values) / np.diff(table.positions))))
            for found, each in ((sums, size), (slopes, slope)):  # those of the two directions do not act at once
                ways = found.setdefault(table.axis, {1: 0.0, -1: 0.0})
                ways |= {way: ways[way] + each for way in ways if direction in (0, way)}
        units = {name: _above(max(ways.values()), 4) for name, ways in sums.items()}
        told = {
            "encoder": encoder,
            "cec": _CEC,
            "small": _SMALL,
            "sums": ", ".join(f"{most} {machine.axis(axis).unit} ({names[axis]})" for axis, most in units.items()),
            "own": own,
            "names": names,
            "points": [len(table.positions) for table in cec],
            "slopes": ", ".join(f"{_above(max(each.values()), 3)} % ({names[axis]})" for axis, each in slopes.items()),
            "turning": [names[t.axis] for t in own if t.rotary and abs(np.ptp(t.positions) - math.tau) < 1e-9],
        }
        heads = {_ENC: "%_N_AX_EEC_INI", _CEC: "%_N_NC_CEC_INI"}
        files = {n: "\n".join([heads[n], "CHANDATA(1)", *own, "M17", ""]) for n, own in lines.items() if own}
        steps = {axis.name: float(from_unit(4e-6, axis.unit)) for axis in machine.axes}
        notes = paragraphs("axiscal.tables", "sinumerik.jinja", **told)
        return Written(files, steps, notes, first=sign_said(options, _SIGN) if cec else ())

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what tables did of the chosen measuring system; raises TableError.

        A table with values that has no use here is untaken.
        """
        names, tables, untaken = _names(machine, options), list[CompensationTable](), list[InputError]()
        axes = {name + one: name for one in ("1", "") for name in names} | {own: name for name, own in names.items()}
        for file in files:
            if file.axis:
                remedy = "give it without {axis}=, and each axis its --number"
                raise TableError("this file names its axes itself", remedy, file.name, axis=file.axis)
            try:
                for place, (begin, values) in _assignments(file.text).items():
                    other = place[0] == "ENC_COMP" and int(place[1]) != options.encoder - 1
                    table = None if other else _understood(place, values, axes, machine, options.flip)
                    if table is not None:
                        tables.append(table)
                    elif any(_number(v) for key, v in values.items() if key[0] == "#"):
                        what = "the table that begins with {text!r} is of no axis or system meant here, or has no STEP"
                        untaken.append(TableError(what, _WHOSE, file.name, begin[0], text=begin[1][:60]))
            except TableError as fault:
                raise TableError(fault.what, _AGAIN, file.name) from None
        return Loaded(tuple(tables), untaken=tuple(untaken))


def _assignments(text: str) -> dict[tuple[str, ...], tuple[tuple[int, str], dict[str, str]]]:
    """Return the line where each table begins, and its values; raises TableError for a line that is no assignment."""
    tables = dict[tuple[str, ...], tuple[tuple[int, str], dict[str, str]]]()
    for number, line in enumerate((_BESIDE.sub("", each).strip() for each in text.splitlines()), 1):
        if _PASSED.fullmatch(line):
            continue
        if (found := _VALUE.fullmatch(line)) is None:
            raise TableError("SINUMERIK would not understand {text!r}", _AGAIN, text=line[:60])
        _, kind, key, first, second, third, value = found.groups()
        place: tuple[str, ...] = (kind, first) if kind == "CEC" else (kind, first, (third or second or ""))
        tables.setdefault(place, ((number, line), {}))[1][key or f"#{second}"] = value
    return tables


def _understood(
    place: tuple[str, ...], values: Mapping[str, str], axes: Mapping[str, str], machine: Machine, flip: bool
) -> CompensationTable | None:
    """Return a table, None for one that is not in use: without a step, or for axes that the machine has not.

    flip : CEC values are added as they are, instead of taken away as encoder compensation is
    """
    enc = place[0] == "ENC_COMP"
    ends = (place[2], place[2]) if enc else (values.get("INPUT_AXIS", ""), values.get("OUTPUT_AXIS", ""))
    over, moved = (axes.get(name) for name in ends)
    low, high, step = (_number(values.get(key, "0")) for key in ("MIN", "MAX", "STEP"))
    if over is None or moved is None or step <= 0:
        return None
    count = (high - low) / step + 1
    points = {int(key[1:]): _number(value) for key, value in values.items() if key[0] == "#"}
    numbers = range(round(min(count, _MOST_POINTS)))
    whole = count <= _MOST_POINTS and abs(count - round(count)) < 1e-6 and all(number in points for number in numbers)
    if not whole or any(value for number, value in points.items() if number not in numbers):
        what = "the table of {moved} has {count:g} points between its ends, and others in the file"
        raise TableError(what, _AGAIN, moved=moved, count=count)
    if int(values.get("MULT_BY_TABLE", "0")):
        raise TableError("a CEC table of {axis} is multiplied by another one", _AGAIN, axis=moved)
    units, entries = [machine.axis(name).unit for name in (over, moved)], [points[number] for number in numbers]
    taken: Array = (-1.0 if flip and not enc else 1.0) * from_unit(np.array(entries), units[1])
    at: Array = low + step * np.arange(len(entries), dtype=float)
    direction = 0 if enc else int(values.get("DIRECTION", "0"))
    forward, reverse = (taken * (direction in (0, side)) for side in (1, -1))
    return CompensationTable(moved, from_unit(at, units[0]), forward, reverse, over=over)


def _number(text: str) -> float:
    """Return a finite number; raises TableError."""
    if (value := number_or_none(text.replace("EX", "E"))) is None:
        raise TableError("{text!r} is no number", _AGAIN, text=text[:40])
    return value


def _names(machine: Machine, options: ExportOptions) -> dict[str, str]:
    """Return the machine axis identifier of each axis: AX1, AX2, …; raises TableError as `numbered`."""
    return {name: f"AX{number}" for name, number in options.numbered(machine).items()}


def cec_tables(tables: Sequence[CompensationTable]) -> tuple[CompensationTable, ...]:
    """Return the CEC tables, in the order of their numbers; raises TableError for more than there can be.

    Of an axis itself there are two, each for one direction: in the other one it has noughts.
    """
    found = list[CompensationTable]()
    for table in (table for table in tables if table.axis == table.over):
        half = (table.forward - table.reverse) / 2
        if np.any(np.round(np.asarray(to_unit(half, table.value_unit())), 6)):
            found += [replace(table, forward=half, reverse=0 * half), replace(table, forward=0 * half, reverse=-half)]
    found += [table for table in tables if table.axis != table.over]
    if len(found) > _TABLES:
        remedy = "leave axes out of the description"
        raise TableError("{count} CEC tables are needed, {most} fit", remedy, count=len(found), most=_TABLES)
    for table in found:
        table.refuse_more(_POINTS)
    return tuple(found)


def _direction(table: CompensationTable) -> int:
    """Return the direction of moving after which a CEC table acts, 0 for both."""
    return 0 if np.array_equal(table.forward, table.reverse) else 1 if np.any(table.forward) else -1


def _shown(table: CompensationTable, values: Array) -> list[str]:
    return [f"{value:.6f}" for value in np.round(np.asarray(to_unit(values, table.value_unit())), 6) + 0.0]


def _span(table: CompensationTable) -> dict[str, str]:
    shown = np.round(np.asarray(to_unit(table.positions, table.unit)), 3) + 0.0
    step = np.round(shown[1] - shown[0], 3)
    if np.max(np.abs(np.diff(shown) - step)) > 2e-3 * len(shown):
        remedy = "SINUMERIK has one distance for a table"
        raise TableError("the points of {axis} are not evenly spaced", remedy, axis=table.axis)
    modulo = int(table.rotary and abs(shown[-1] - shown[0] - 360) < 1e-6)
    ends = {"STEP": step, "MIN": shown[0], "MAX": shown[0] + step * (len(shown) - 1)}
    return {**{key: f"{value:.3f}" for key, value in ends.items()}, "IS_MODULO": str(modulo)}


def _above(value: float, decimals: int) -> str:
    """Return the least positive number of `decimals` decimals that is not below a value: a limit to set."""
    last = 10**decimals
    return f"{max(1, math.ceil(value * last - _ROUNDING)) / last:.{decimals}f}"
