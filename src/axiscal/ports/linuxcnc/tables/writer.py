"""A `COMP_FILE` of Type 0: rows `nominal actual_forward actual_reverse` in machine units.

How it reads, which checks nothing that LinuxCNC does not check:

- usrmotLoadComp: fgets of 254 bytes, sscanf "%lf %lf %lf"; the first line that does not match ends the file
- EMCMOT_SET_JOINT_COMP: rows must increase, 256 of them
- compute_screw_comp: linear between, constant outside, trims and slopes in 32 bits
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.exceptions import TableError
from axiscal.numerics import Array
from axiscal.tables.exporter import paragraphs
from axiscal.tables.table import CompensationTable
from axiscal.units import format_quantity, from_unit, to_unit

ROWS = 256
"""By LinuxCNC's source (usrmotintf.cc): rows that are kept."""
_CHUNK = 254
"""By LinuxCNC's source (usrmotintf.cc): characters that fgets takes at once."""
_TRIPLET = re.compile(rb"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?![\w.])" * 3)
"""What scanf takes as well; what it takes besides, such as 0x10, inf or 1e, ends the file here."""


@dataclass(frozen=True, slots=True, eq=False)
class LinuxcncTable:
    """A file as LinuxCNC keeps it, in machine units.

    nominal : (n,); forward, reverse : (n,) trims, nominal minus actual, that are added to the command
    skipped : lines that it does not keep: behind its end or its last row, or not above the row before
    """

    nominal: Array
    forward: Array
    reverse: Array
    skipped: tuple[int, ...] = ()


def parse(text: str, file_type: int = 0) -> LinuxcncTable:
    """Read a file as LinuxCNC does; whatever the text is, LinuxCNC starts with some table, and so it is given here.

    file_type : COMP_FILE_TYPE; 0 holds actual positions, any other number the trims themselves
    """
    rows, skipped, found = list[tuple[float, float, float]](), list[int](), _TRIPLET.match(b"0 0 0")
    for line, chunk in _chunks(text.encode("utf-8", "surrogatepass")):
        found = found and _TRIPLET.match(chunk)
        nominal, forward, reverse = map(float, found.groups()) if found else (-math.inf,) * 3
        if len(rows) < ROWS and nominal > (rows[-1][0] if rows else -np.finfo(np.float64).max):
            rows.append((nominal, forward, reverse) if file_type else (nominal, nominal - forward, nominal - reverse))
        elif chunk.strip() and not chunk.lstrip().startswith(b"#"):
            skipped.append(line)
    columns = np.array(rows, dtype=np.float64).reshape(-1, 3).T
    with np.errstate(over="ignore"):
        trims = columns[1:].astype(np.float32).astype(np.float64)
    return LinuxcncTable(columns[0], trims[0], trims[1], tuple(dict.fromkeys(skipped)))


def _chunks(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the line and the bytes of each fgets, cut at a zero byte as C strings are."""
    for number, line in enumerate(re.findall(rb"[^\n]*\n|[^\n]+", data), 1):
        for start in range(0, len(line), _CHUNK):
            yield number, line[start : start + _CHUNK].partition(b"\0")[0]


_SERVO_PERIOD = 1e-3
"""s, as LinuxCNC's own configurations have it."""
STEEPEST = 0.5
"""Largest slope: LinuxCNC adds at most half of the axis' speed for the correction (control.c, compute_screw_comp)."""


def write(table: CompensationTable, unit: str) -> str:
    """Return the text; `unit` is the machine's, mm or in, deg.  Raises TableError if it does not fit."""
    table.refuse_more(ROWS)
    steps, sides = np.diff(table.positions), (table.forward, table.reverse)
    slopes = np.max([np.abs(np.diff(side)) for side in sides], axis=0) / steps
    if np.any(slopes > STEEPEST):
        where = format_quantity(float(table.positions[int(np.argmax(slopes))]), table.unit)
        what = "the deviation of {axis} after {where} changes by more than {most} of the way"
        remedy = "LinuxCNC cannot follow that; check the units of the readings"
        raise TableError(what, remedy, axis=table.axis, where=where, most=f"{STEEPEST:.0%}")
    nominal = to_unit(table.positions, unit)
    columns = np.round(np.array([nominal, *(nominal + to_unit(side, unit) for side in sides)]), 6) + 0.0
    if np.any(equal := np.diff(columns[0]) <= 0):
        what = "two points of {axis} at {position:.6f} {unit} are one in the six decimals of the file"
        remedy, position = "set the points at least {step:.6f} {unit} apart", columns[0][int(np.argmax(equal))]
        raise TableError(what, remedy, axis=table.axis, position=position, unit=unit, step=1e-6)
    return "".join("{:.6f} {:.6f} {:.6f}\n".format(*row) for row in columns.T)


def resolution(table: CompensationTable, unit: str) -> float:
    """Return what rounding may leave, m or rad: six decimals in both columns, trims kept in 32 bits."""
    largest = max(float(np.max(np.abs(table.forward))), float(np.max(np.abs(table.reverse))))
    return float(from_unit(2e-6, unit)) + 3e-7 * largest


def notes(table: CompensationTable, unit: str, joints: Sequence[int], acceleration: float) -> tuple[str, ...]:
    """Return the sentences for whoever loads the file.

    unit : of the machine, mm or in, deg; joints : numbers of the axis' joints in the INI file
    acceleration : MAX_ACCELERATION of the joint, m/s² or rad/s²
    """
    smallest, largest = table.reversal
    low, high = dead_band(acceleration, _SERVO_PERIOD)
    return paragraphs(
        "axiscal.ports.linuxcnc",
        "comp_notes.jinja",
        table=table,
        joints=joints,
        largest=largest,
        carried_out=largest <= low or smallest > high,
        step=" to ".join(dict.fromkeys(map(table.shown, table.reversal))),
        band=[table.shown(low), table.shown(high)],
        ends=[f"{to_unit(float(end), unit):.6g}" for end in table.positions[[0, -1]]],
        unit=unit,
        turns=float(np.ptp(table.positions)) / math.tau,
    )


def dead_band(acceleration: float, servo_period: float) -> tuple[float, float]:
    """Return between which steps (m or rad) LinuxCNC at rest does not carry out a reversal: low < step <= high.

    acceleration : MAX_ACCELERATION of the joint, m/s² or rad/s²; servo_period : s
    """
    unit_step = acceleration * servo_period**2
    return 0.25 * unit_step, 0.5 * unit_step
