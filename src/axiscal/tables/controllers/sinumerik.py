"""All tables for a SINUMERIK 840D sl, ONE or 828D.

`$AA_ENC_COMP` has no direction: it holds the mean of both. Two `$AN_CEC` tables, one for each direction, hold the
difference to it; their input is their output. CEC tables with another input hold straightness, sag and squareness.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from axiscal.exceptions import TableError
from axiscal.language.spoken import later
from axiscal.numerics import Array
from axiscal.tables.exporter import ExportOptions, TableFormat, Written, paragraphs, sign_said
from axiscal.tables.loaded import Loaded
from axiscal.tables.table import CompensationTable
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

_VALUE = re.compile(r"\$A[AN]_(ENC_COMP|CEC)(?:_([A-Z_]+))?\[(\d+)(?:,(\w+))?(?:,(\w+))?\]=\(?([^)\s]+)\)?")


def read(text: str, names: Mapping[str, str], machine: Machine, flip: bool) -> list[CompensationTable]:
    """Return what a SINUMERIK makes of a file, by its manuals: one assignment after the other.

    names : machine axis identifiers; flip : CEC values are added as they are, instead of taken away as encoder
    compensation is.  Raises TableError for a line that is none, and for a table that is not whole.
    """
    tables = dict[tuple[str, str], dict[str, str]]()
    for line in (each for each in text.splitlines() if not each.startswith(("%_N_", "CHANDATA(")) and each != "M17"):
        found = _VALUE.fullmatch(line)
        if found is None:
            remedy = "this is a defect of axiscal"
            raise TableError("SINUMERIK would not understand {text!r}", remedy, text=line[:60])
        kind, key, first, second, third, value = found.groups()
        table = tables.setdefault((kind, first if kind == "CEC" else third or second), {})
        table[key or f"#{second}"] = value
    axes = {identifier: name for name, identifier in names.items()}
    return [_understood(kind, axis, values, axes, machine, flip) for (kind, axis), values in tables.items()]


def _understood(
    kind: str, own: str, values: Mapping[str, str], axes: Mapping[str, str], machine: Machine, flip: bool
) -> CompensationTable:
    """Return a table.  own : the axis of encoder compensation, the number of another table"""
    cec = kind == "CEC"
    over, moved = (axes[values[f"{end}_AXIS"] if cec else own] for end in ("INPUT", "OUTPUT"))
    low, high, step = (float(values[key]) for key in ("MIN", "MAX", "STEP"))
    points = {int(key[1:]): float(value) for key, value in values.items() if key[0] == "#"}
    if sorted(points) != list(range(len(points))) or abs((high - low) / step + 1 - len(points)) > 1e-6:
        what, remedy = "the table of {moved} is not whole", "this is a defect of axiscal"
        raise TableError(what, remedy, moved=moved)
    units = [machine.axis(name).unit for name in (over, moved)]
    positions: Array = from_unit(np.array([low + step * i for i in range(len(points))]), units[0])
    taken: Array = (-1.0 if flip and cec else 1.0) * from_unit(
        np.array([points[i] for i in range(len(points))]), units[1]
    )
    direction = int(values.get("DIRECTION", "0"))
    forward, reverse = (taken * (direction in (0, side)) for side in (1, -1))
    return CompensationTable(moved, positions, forward, reverse, over=over)


TABLES = 128
"""By SIEMENS' manual: CEC tables that a control holds."""
POINTS = 2000
"""Points that MD18342 allows for a CEC table."""
ENC, CEC = "AX_EEC.INI", "NC_CEC.INI"


@dataclass(frozen=True, eq=False, slots=True)
class TableBlock:
    """One CEC table: values (n,) m or rad, taken away after moving in a direction, 0 for both."""

    table: CompensationTable
    values: Array
    direction: int


def blocks_of(own: Sequence[CompensationTable], over: Sequence[CompensationTable]) -> tuple[TableBlock, ...]:
    """Return the CEC tables, in the order of their numbers; raises TableError for more than there can be."""
    apart = [block for table in own for block in _directions(table)]
    blocks = (*apart, *(TableBlock(table, table.forward, 0) for table in over))
    if len(blocks) > TABLES:
        remedy = "leave axes out of the description"
        raise TableError("{count} CEC tables are needed, {most} fit", remedy, count=len(blocks), most=TABLES)
    for block in blocks:
        if len(block.values) > POINTS:
            what = "the CEC table of {axis} has {count} points, MD18342 allows {most}"
            remedy = "set the points further apart"
            raise TableError(what, remedy, axis=block.table.axis, count=len(block.values), most=POINTS)
    return blocks


def write(
    own: Sequence[CompensationTable],
    blocks: Sequence[TableBlock],
    names: Mapping[str, str],
    cec_sign: float = 1.0,
    encoder: int = 0,
) -> dict[str, str]:
    """Return the files by name.  names : machine axis identifiers; encoder : 0 or 1, index of the measuring system."""
    enc = "".join(_enc_text(table, names[table.axis], encoder) for table in own)
    files = {ENC: f"%_N_AX_EEC_INI\nCHANDATA(1)\n{enc}M17\n"} if enc else {}
    cec = "".join(_cec_text(number, block, cec_sign, names) for number, block in enumerate(blocks))
    return files | ({CEC: f"%_N_NC_CEC_INI\nCHANDATA(1)\n{cec}M17\n"} if cec else {})


def _directions(table: CompensationTable) -> list[TableBlock]:
    half = (table.forward - table.reverse) / 2
    seen = np.round(np.asarray(to_unit(half, table.value_unit())), 6)
    return [] if not np.any(seen) else [TableBlock(table, half, 1), TableBlock(table, -half, -1)]


def _enc_text(table: CompensationTable, name: str, encoder: int) -> str:
    values = np.asarray(to_unit((table.forward + table.reverse) / 2, table.value_unit()))
    lines = [f"$AA_ENC_COMP[{encoder},{i},{name}]={value:.6f}" for i, value in enumerate(np.round(values, 6) + 0.0)]
    lines += [f"$AA_ENC_COMP_{key}[{encoder},{name}]={value}" for key, value in _span(table)]
    return "\n".join(lines) + "\n"


def _cec_text(number: int, block: TableBlock, sign: float, names: Mapping[str, str]) -> str:
    table = block.table
    shown = np.asarray(to_unit(sign * block.values, table.value_unit()))
    lines = [f"$AN_CEC[{number},{i}]={value:.6f}" for i, value in enumerate(np.round(shown, 6) + 0.0)]
    lines.append(f"$AN_CEC_INPUT_AXIS[{number}]=({names[table.over]})")
    lines.append(f"$AN_CEC_OUTPUT_AXIS[{number}]=({names[table.axis]})")
    *span, modulo = _span(table)
    lines += [f"$AN_CEC_{key}[{number}]={value}" for key, value in span]
    lines += [f"$AN_CEC_DIRECTION[{number}]={block.direction}", f"$AN_CEC_MULT_BY_TABLE[{number}]=0"]
    lines.append(f"$AN_CEC_{modulo[0]}[{number}]={modulo[1]}")
    return "\n".join(lines) + "\n"


def _span(table: CompensationTable) -> list[tuple[str, str]]:
    shown = np.round(np.asarray(to_unit(table.positions, table.unit)), 3) + 0.0
    step = np.round(shown[1] - shown[0], 3)
    if np.max(np.abs(np.diff(shown) - step)) > 2e-3 * len(shown):
        remedy = "SINUMERIK has one distance for a table"
        raise TableError("the points of {axis} are not evenly spaced", remedy, axis=table.axis)
    modulo = int(table.rotary and abs(shown[-1] - shown[0] - 360) < 1e-6)
    last = shown[0] + step * (len(shown) - 1)
    return [("STEP", f"{step:.3f}"), ("MIN", f"{shown[0]:.3f}"), ("MAX", f"{last:.3f}"), ("IS_MODULO", str(modulo))]


_ROUNDING = 1e-6
"""Of the last decimal of a limit: what lies over it through rounding alone raises it by no digit."""
_SMALL = (8, 200)
"""Tables, and points of each, that an 828D has."""

_SIGN = "K3 of the Function Manual Extended Functions (6FC5397-1BP40) states the sign of ENC_COMP and not that of CEC"
_STEP = 1e-6
"""The grid of positions, m: the decimals that are written."""


class Sinumerik(TableFormat):
    """Encoder compensation and CEC tables."""

    holds = (
        "encoder compensation for every axis (the mean of both directions), and CEC tables for what the directions are "
        "apart, for straightness, sag and squareness."
    )
    left_out = "errors that depend on two axes at once, the orientation of the tool, and the reversal of straightness."
    takes = TableFormat.takes | {"--number", "--measuring-system"}
    unstated = "across"
    instead: ClassVar = {"--unit": later("leave it out: the tables are in mm and deg, load them in metric")}
    points = 200  # what an 828D holds for an axis
    grid = (_STEP, float(np.radians(1e-3)))

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return the files that are needed."""
        names, encoder = _names(machine, options), options.encoder - 1
        own, over = ([t for t in tables if (t.axis == t.over) is itself] for itself in (True, False))
        blocks = blocks_of(own, over)
        files = write(own, blocks, names, options.sign, encoder)
        steps = {axis.name: float(from_unit(4e-6, axis.unit)) for axis in machine.axes}
        first = sign_said(options, _SIGN) if blocks else ()
        return Written(files, steps, notes(own, blocks, names, encoder), first=first)

    def load(self, files: Mapping[str, str], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the control makes of the files; raises TableError."""
        names = _names(machine, options)
        return Loaded(tuple(one for text in files.values() for one in read(text, names, machine, options.flip)))


def _names(machine: Machine, options: ExportOptions) -> dict[str, str]:
    """Return the machine axis identifier of each axis: AX1, AX2, …; raises TableError as `numbered`."""
    return {name: f"AX{number}" for name, number in options.numbered(machine).items()}


def notes(
    own: Sequence[CompensationTable], blocks: Sequence[TableBlock], names: Mapping[str, str], encoder: int
) -> tuple[str, ...]:
    """Return the sentences; arguments as for `write`."""
    turning = [names[t.axis] for t in own if t.rotary and abs(np.ptp(t.positions) - 2 * np.pi) < 1e-9]
    return paragraphs(
        "axiscal.tables",
        "sinumerik.jinja",
        own=own,
        names=names,
        encoder=encoder,
        cec=CEC,
        points=[len(block.table.positions) for block in blocks],
        small=_SMALL,
        sums=_sums(blocks, names),
        slopes=_slopes(blocks, names),
        turning=turning,
    )


def _by_axis(blocks: Sequence[TableBlock], sizes: Sequence[float]) -> dict[str, float]:
    """Return the sum over the tables of each axis that act at once: those of the two directions do not."""
    found: dict[str, float] = {}
    for direction in (1, -1):
        one: dict[str, float] = {}
        for block, size in zip(blocks, sizes, strict=True):
            if block.direction in (0, direction):
                one[block.table.axis] = one.get(block.table.axis, 0.0) + size
        found |= {axis: max(size, found.get(axis, 0.0)) for axis, size in one.items()}
    return found


def _sums(blocks: Sequence[TableBlock], names: Mapping[str, str]) -> str:
    sums = _by_axis(blocks, [float(np.max(np.abs(block.values))) for block in blocks])
    units = {block.table.axis: block.table.value_unit() for block in blocks}
    shown = {axis: _above(to_unit(size, units[axis]), 4) for axis, size in sums.items()}
    return ", ".join(f"{size} {units[axis]} ({names[axis]})" for axis, size in shown.items())


def _slopes(blocks: Sequence[TableBlock], names: Mapping[str, str]) -> str:
    slopes = (np.diff(block.values) / np.diff(block.table.positions) for block in blocks)
    steepest = [float(np.max(np.abs(each))) for each in slopes]
    return ", ".join(
        f"{_above(100 * slope, 3)} % ({names[axis]})" for axis, slope in _by_axis(blocks, steepest).items()
    )


def _above(value: float, decimals: int) -> str:
    """Return the least positive number of `decimals` decimals that is not below a value: a limit to set."""
    last = 10**decimals
    return f"{max(1, math.ceil(value * last - _ROUNDING)) / last:.{decimals}f}"
