"""Siemens SINUMERIK 840D sl, ONE, 828D: `$AA_ENC_COMP` for an axis over itself, `$AN_CEC` for directions and sag.

ENC_COMP has no direction: it holds the mean of both, and two CEC tables whose input is their output, one for each
direction, hold what is apart from it. CEC tables with another input hold straightness, sag and squareness.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from axiscal.compensation.effect import table_control
from axiscal.compensation.estimate import Estimate
from axiscal.compensation.lookup import Lookup, lookup_control
from axiscal.compensation.offer import Draft
from axiscal.compensation.options import Options
from axiscal.compensation.sampling import axis_tables, cross_tables
from axiscal.compensation.table import CompensationTable
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.units import from_unit, to_unit

POINTS = 200
"""What an 828D holds for an axis; an 840D holds what MD38000 and MD18342 say."""
TABLES = 128
_ENC, _CEC = "AX_EEC.INI", "NC_CEC.INI"
_STEP = 1e-6
_VALUE = re.compile(r"\$A([AN])_(ENC_COMP|CEC)(?:_([A-Z_]+))?\[(\d+)(?:,(\w+))?(?:,(\w+))?\]\s*=\s*\(?([^)\s;]+)\)?")
_HOLDS = (
    "encoder compensation for every axis (the mean of both directions), and CEC tables for what the directions are "
    "apart, for straightness, sag and squareness."
)
_LEFT = "errors that depend on two axes at once, the orientation of the tool, and the reversal of straightness."
_NOTES = (
    "Before loading: MD38000 MM_ENC_COMP_MAX_POINTS and MD18342 MM_CEC_MAX_POINTS must allow the points of each table; "
    "setting them clears the memory: save it first.",
    "To load ENC_COMP: MD32700 ENC_COMP_ENABLE = 0, load, set it to 1, NCK reset, and reference the axis.",
    "To load CEC: MD32710 CEC_ENABLE = 0, load, set it to 1 and SD41300 CEC_TABLE_ENABLE = 1 for each table. CEC is a "
    "licensed option.",
    "ENC_COMP: a positive value moves the axis in its negative direction (Siemens).",
    "CEC: no Siemens text that we know states the sign; here it is that of ENC_COMP. Check one point with a dial "
    "gauge, and export with --flip if the axis goes the wrong way.",
)


def make(estimate: Estimate, options: Options) -> Draft:
    """Return the files; raises TableError."""
    if options.unit != "mm":
        raise TableError("tables for SINUMERIK are written in mm and deg", "leave --unit out, and load them in metric")
    machine = estimate.machine
    names = axis_names(machine, options)
    grid = (_STEP, float(np.radians(1e-3)))
    own = axis_tables(estimate, options.spacing, POINTS, grid)
    over = tuple(t.averaged() for t in cross_tables(estimate, options.spacing, POINTS, _STEP))
    files = write(own, over, names, -1.0 if options.flip else 1.0)
    held = lookup_control(machine, read(files.values(), names, machine, options.flip))
    wanted = table_control(machine, (*own, *over))
    resolution = {axis.name: float(from_unit(4e-6, axis.unit)) for axis in machine.axes}
    return Draft(files, held, wanted, resolution, (*own, *over), _HOLDS, _LEFT, _NOTES, tried=False)


def axis_names(machine: Machine, options: Options) -> dict[str, str]:
    """Return the machine axis identifier of each axis: AX1, AX2, …; raises TableError for two that are the same."""
    found = {name: f"AX{number}" for name, number in options.numbered(machine).items()}
    if len(set(found.values())) < len(found):
        raise TableError("two axes have the same number", f"Give each its own: {found}")
    return found


def write(
    own: Sequence[CompensationTable], over: Sequence[CompensationTable], names: Mapping[str, str], cec_sign: float = 1.0
) -> dict[str, str]:
    """Return the files by name; raises TableError for more tables than there can be."""
    blocks = [block for table in own for block in _directions(table)] + [(t, t.forward, 0) for t in over]
    if len(blocks) > TABLES:
        raise TableError(f"{len(blocks)} CEC tables are needed, {TABLES} fit", "leave axes out of the description")
    enc = "".join(_enc(table, names[table.axis]) for table in own)
    files = {_ENC: f"%_N_AX_EEC_INI\nCHANDATA(1)\n{enc}M17\n"} if enc else {}
    cec = "".join(
        _cec(number, table, cec_sign * values, direction, names)
        for number, (table, values, direction) in enumerate(blocks)
    )
    return files | ({_CEC: f"%_N_NC_CEC_INI\nCHANDATA(1)\n{cec}M17\n"} if cec else {})


def _directions(table: CompensationTable) -> list[tuple[CompensationTable, Array, int]]:
    half = (table.forward - table.reverse) / 2
    return [] if not np.any(half) else [(table, half, 1), (table, -half, -1)]


def _enc(table: CompensationTable, name: str) -> str:
    values = np.asarray(to_unit((table.forward + table.reverse) / 2, _unit(table)))
    lines = [f"$AA_ENC_COMP[0,{i},{name}]={value:.6f}" for i, value in enumerate(values + 0.0)]
    lines += [f"$AA_ENC_COMP_{key}[0,{name}]={value}" for key, value in _span(table)]
    return "\n".join(lines) + "\n"


def _cec(number: int, table: CompensationTable, values: Array, direction: int, names: Mapping[str, str]) -> str:
    shown = np.asarray(to_unit(values, _unit(table)))
    lines = [f"$AN_CEC[{number},{i}]={value:.6f}" for i, value in enumerate(shown + 0.0)]
    lines.append(f"$AN_CEC_INPUT_AXIS[{number}]=({names[table.over]})")
    lines.append(f"$AN_CEC_OUTPUT_AXIS[{number}]=({names[table.axis]})")
    *span, modulo = _span(table)
    lines += [f"$AN_CEC_{key}[{number}]={value}" for key, value in span]
    lines += [f"$AN_CEC_DIRECTION[{number}]={direction}", f"$AN_CEC_MULT_BY_TABLE[{number}]=0"]
    lines.append(f"$AN_CEC_{modulo[0]}[{number}]={modulo[1]}")
    return "\n".join(lines) + "\n"


def _span(table: CompensationTable) -> list[tuple[str, str]]:
    shown = np.round(np.asarray(to_unit(table.positions, table.unit)), 3) + 0.0
    step = np.round(shown[1] - shown[0], 3)
    if np.max(np.abs(np.diff(shown) - step)) > 2e-3 * len(shown):
        raise TableError(f"the points of {table.axis} are not evenly spaced", "SINUMERIK has one distance for a table")
    modulo = int(table.rotary and abs(shown[-1] - shown[0] - 360) < 1e-6)
    last = shown[0] + step * (len(shown) - 1)
    return [("STEP", f"{step:.3f}"), ("MIN", f"{shown[0]:.3f}"), ("MAX", f"{last:.3f}"), ("IS_MODULO", str(modulo))]


def _unit(table: CompensationTable) -> str:
    return "deg" if table.rotary else "mm"


def read(texts: Iterable[str], names: Mapping[str, str], machine: Machine, flip: bool = False) -> list[Lookup]:
    """Return what a SINUMERIK makes of the files, by its manuals: one assignment after the other.

    flip : CEC values are added as they are, instead of taken away as encoder compensation is
    Raises TableError for a line that is none, and for tables that are not whole.
    """
    axes = {identifier: name for name, identifier in names.items()}
    tables: dict[tuple[str, ...], dict[str, str]] = {}
    for text in texts:
        for line in (each.split(";")[0].strip() for each in text.splitlines()):
            if not line or line.startswith("%_N_") or line in ("CHANDATA(1)", "M17"):
                continue
            found = _VALUE.fullmatch(line)
            if found is None:
                raise TableError(f"SINUMERIK would not understand {line[:60]!r}", "this is a defect of axiscal")
            _, kind, key, first, second, third, value = found.groups()
            place = (kind, first) if kind == "CEC" else (kind, first, (third or second or ""))
            index = key or f"#{second}"
            tables.setdefault(place, {})[index] = value
    return [_understood(place, values, axes, machine, flip) for place, values in tables.items()]


def _understood(
    place: tuple[str, ...], values: Mapping[str, str], axes: Mapping[str, str], machine: Machine, flip: bool
) -> Lookup:
    enc = place[0] == "ENC_COMP"
    over, moved = (axes[place[2]],) * 2 if enc else (axes[values["INPUT_AXIS"]], axes[values["OUTPUT_AXIS"]])
    low, high, step = (float(values[key]) for key in ("MIN", "MAX", "STEP"))
    count = (high - low) / step + 1
    entries = [float(values.get(f"#{i}", "0")) for i in range(round(count))]
    if abs(count - round(count)) > 1e-6 or f"#{round(count)}" in values:
        raise TableError(f"the table of {moved} has {count:g} points between its ends", "this is a defect of axiscal")
    units = [machine.axis(name).unit for name in (over, moved)]
    positions: Array = from_unit(np.array([low + step * i for i in range(len(entries))]), units[0])
    sign = 1.0 if flip and not enc else -1.0
    added: Array = sign * from_unit(np.array(entries), units[1])
    return Lookup(moved, over, positions, added, 0 if enc else int(values["DIRECTION"]))
