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
_PASSED = ("%_N_", "CHANDATA(", "$MA_ENC_COMP_ENABLE", "$MA_CEC_ENABLE", "$SN_CEC_TABLE_ENABLE", "NEWCONF", "STOPRE")
_VALUE = re.compile(r"\$A([AN])_(ENC_COMP|CEC)(?:_([A-Z_]+))?\[(\d+)(?:,(\w+))?(?:,(\w+))?\]\s*=\s*\(?([^)\s;]+)\)?")

_MOST_POINTS = 100_000
"""Of a table; controls hold a few thousand."""


def read(
    text: str,
    names: Mapping[str, str],
    machine: Machine,
    flip: bool,
    encoder: int,
    untaken: list[InputError],
) -> list[CompensationTable]:
    """Return what a SINUMERIK makes of a file, by its manuals: one assignment after the other.

    flip : CEC values are added as they are, instead of taken away as encoder compensation is
    encoder : 0 or 1, the measuring system that is looked at
    untaken : takes a failure for each table with values that has no use here
    Raises TableError for a line that is none, for tables that are not whole, and for one that is multiplied by another.
    """
    own = {f"{name}1": name for name in names} | {name: name for name in names}
    axes = own | {identifier: name for name, identifier in names.items()}
    tables, begins = dict[tuple[str, ...], dict[str, str]](), dict[tuple[str, ...], tuple[int, str]]()
    for number, line in enumerate((_BESIDE.sub("", each).strip() for each in text.splitlines()), 1):
        if not line or line.startswith(_PASSED) or line in ("M17", "M30"):
            continue
        found = _VALUE.fullmatch(line)
        if found is None:
            remedy = "this is a defect of axiscal"
            raise TableError("SINUMERIK would not understand {text!r}", remedy, text=line[:60])
        _, kind, key, first, second, third, value = found.groups()
        place: tuple[str, ...] = (kind, first) if kind == "CEC" else (kind, first, (third or second or ""))
        index = key or f"#{second}"
        tables.setdefault(place, {})[index] = value
        begins.setdefault(place, (number, line))
    found_ones = list[CompensationTable]()
    for place, values in tables.items():
        other = place[0] == "ENC_COMP" and encoder != int(place[1])
        table = None if other else _understood(place, values, axes, machine, flip)
        found_ones += [] if table is None else [table]
        if table is None and any(_number(v) for key, v in values.items() if key[0] == "#"):
            what = "the table that begins with {text!r} is for no axis that is known here, or has no STEP"
            remedy = "Say whose it is: --number X=1 for AX1, or --on-top-of X=FILE; else take it out of the file"
            if other:
                what, remedy = "{text!r} is of another measuring system", "Say --measuring-system 2, or take it out"
            untaken.append(TableError(what, remedy, None, begins[place][0], text=begins[place][1][:60]))
    return found_ones


def _understood(
    place: tuple[str, ...], values: Mapping[str, str], axes: Mapping[str, str], machine: Machine, flip: bool
) -> CompensationTable | None:
    """Return a table, None for one that is not in use: without a step, or for axes that the machine has not."""
    enc = place[0] == "ENC_COMP"
    ends = (place[2], place[2]) if enc else (values.get("INPUT_AXIS", ""), values.get("OUTPUT_AXIS", ""))
    over, moved = (axes.get(name) for name in ends)
    low, high, step = (_number(values.get(key, "0")) for key in ("MIN", "MAX", "STEP"))
    if over is None or moved is None or step <= 0:
        return None
    count = (high - low) / step + 1
    points = {int(key[1:]): _number(value) for key, value in values.items() if key[0] == "#"}
    whole = count <= _MOST_POINTS and abs(count - round(count)) < 1e-6
    if not whole or any(value for number, value in points.items() if number >= round(count)):
        what = "the table of {moved} has {count:g} points between its ends"
        remedy = "write a STEP that divides MAX - MIN into {most:,} parts at most, and no values beyond"
        raise TableError(what, remedy, moved=moved, count=count, most=_MOST_POINTS)
    if int(values.get("MULT_BY_TABLE", "0")):
        what = "a CEC table of {axis} is multiplied by another one"
        raise TableError(what, "leave MULT_BY_TABLE at 0", axis=moved)
    if lacking := [number for number in range(round(count)) if number not in points]:
        what, remedy = "point {number} of the table of {moved} is not there", "give the files as the control saved them"
        raise TableError(what, remedy, moved=moved, number=lacking[0])
    entries = [points[number] for number in range(round(count))]
    units = [machine.axis(name).unit for name in (over, moved)]
    positions: Array = from_unit(np.array([low + step * i for i in range(len(entries))]), units[0])
    taken: Array = (-1.0 if flip and not enc else 1.0) * from_unit(np.array(entries), units[1])
    direction = 0 if enc else int(values.get("DIRECTION", "0"))
    forward, reverse = (taken * (direction in (0, side)) for side in (1, -1))
    return CompensationTable(moved, positions, forward, reverse, over=over)


def _number(text: str) -> float:
    """Return a finite number; raises TableError."""
    if (value := number_or_none(text.replace("EX", "E"))) is None:
        raise TableError("{text!r} is no number", "write digits with a decimal point", text=text[:40])
    return value


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
            remedy = "export without --on-top-of, or give coarser tables to it"
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
    takes = TableFormat.takes | {"--number", "--measuring-system", "--on-top-of"}
    unstated = "across"
    instead: ClassVar = {"--unit": later("leave it out: the tables are in mm and deg, load them in metric")}
    points = 200  # what an 828D holds for an axis
    grid = (_STEP, float(np.radians(1e-3)))

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return what the files are to hold, that of the old ones added; raises TableError."""
        return options.old.under_tables(super().tables(estimate, options), estimate.machine, POINTS, even=True)

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return the files that are needed."""
        names, encoder = _names(machine, options), options.encoder - 1
        own, over = ([t for t in tables if (t.axis == t.over) is itself] for itself in (True, False))
        blocks = blocks_of(own, over)
        files = write(own, blocks, names, options.sign, encoder)
        steps = {axis.name: float(from_unit(4e-6, axis.unit)) for axis in machine.axes}
        first = sign_said(options, _SIGN) if blocks else ()
        return Written(files, steps, notes(own, blocks, names, encoder), first=first)

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what tables did of the chosen measuring system; raises TableError."""
        names, tables, untaken = _names(machine, options), list[CompensationTable](), list[InputError]()
        for file in files:
            own = {machine.axis(file.axis).name: _only_axis(file)} if file.axis else names
            left = list[InputError]()
            try:
                tables += read(file.text, own, machine, options.flip, options.encoder - 1, left)
            except TableError as fault:
                remedy = "give AX_EEC.INI and NC_CEC.INI as the control saved them"
                raise TableError(fault.what, remedy, file.name) from None
            untaken += [fault.placed(file.name, fault.line) for fault in left]
        return Loaded(tuple(tables), untaken=tuple(untaken))


def _only_axis(file: OldFile) -> str:
    """Return the axis that a file of one axis is for, as it writes it; raises TableError for several."""
    found = {third or second for _, kind, _, _, second, third, _ in _VALUE.findall(file.text) if kind == "ENC_COMP"}
    found = {name for name in found if not name.isdigit()}
    if len(found) != 1:
        what, remedy = "this file has tables of {known}", "give it without AXIS=, and each axis its --number"
        raise TableError(what, remedy, file.name, known=", ".join(sorted(found)) or "-")
    return str(found.pop())


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
