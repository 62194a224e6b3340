"""A `COMP_FILE` of Type 0: rows `nominal actual_forward actual_reverse` in machine units."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from axiscal.compensation.controllers.linuxcnc.notes import notes
from axiscal.compensation.controllers.linuxcnc.reader import ROWS, LinuxcncTable, correction, parse
from axiscal.compensation.table import CompensationTable, TableFile
from axiscal.exceptions import TableError
from axiscal.numerics import Array
from axiscal.units import format_quantity, from_unit, to_unit

STEEPEST = 0.5
"""Largest slope: LinuxCNC adds at most half of the axis' speed for the correction (control.c, compute_screw_comp)."""


def write(table: CompensationTable, unit: str | None = None) -> str:
    """Return the text; `unit` is the machine's, mm (default) or in, deg.  Raises TableError if it does not fit."""
    unit = _machine_unit(table, unit)
    _refuse_what_it_cannot_hold(table)
    nominal = to_unit(table.positions, unit)
    forward, reverse = (nominal + to_unit(side, unit) for side in (table.forward, table.reverse))
    columns = np.round(np.array([nominal, forward, reverse]), 6) + 0.0
    _refuse_equal_positions(table, columns[0], unit)
    return "".join("{:.6f} {:.6f} {:.6f}\n".format(*row) for row in columns.T)


def verify(text: str, table: CompensationTable, unit: str | None = None) -> float:
    """Return the largest error (m or rad) that LinuxCNC would leave of the table; raises TableError if it is too large.

    Both are piecewise linear: the largest difference is at a point of one of them, or just before it, since LinuxCNC's
    slopes have 32 bits and do not quite lead to the next point.
    """
    unit = _machine_unit(table, unit)
    parsed = parse(text)
    finite = bool(np.all(np.isfinite([parsed.nominal, parsed.forward, parsed.reverse])))
    if parsed.errors or parsed.unread is not None or not finite or len(parsed.nominal) != len(table.positions):
        trouble = "; ".join(parsed.errors) or f"it keeps {len(parsed.nominal)} of {len(table.positions)} rows"
        trouble = trouble if finite else "it holds numbers that are not finite"
        raise TableError(f"LinuxCNC would not read the table of {table.axis} as meant: {trouble}", _REPORT)
    points = np.union1d(parsed.nominal, to_unit(table.positions, unit))
    points = np.r_[points, np.nextafter(points, -np.inf)]
    worst = max(float(np.max(np.abs(_left(parsed, table, points, side, unit)))) for side in (1, -1))
    if not worst <= resolution(table, unit):
        what = f"LinuxCNC would leave {table.shown(worst)} of the deviation of {table.axis} with this file"
        raise TableError(what, _REPORT)
    return worst


def offer(
    table: CompensationTable,
    *,
    unit: str | None = None,
    joints: Sequence[int] = (),
    acceleration: float | None = None,
    servo_period: float = 1e-3,
) -> TableFile:
    """Return the file with its notes, read back and applied; raises TableError when it would not correct the axis.

    unit : of the machine, mm (default) or in, deg; joints : numbers of the axis' joints in the INI file, if known
    acceleration : MAX_ACCELERATION of the joint, m/s² or rad/s²; servo_period : s
    """
    text = write(table, unit)
    residual = verify(text, table, unit)
    unit = _machine_unit(table, unit)
    said = notes(table, unit, joints, acceleration, servo_period)
    return TableFile(f"{table.axis}.comp", text, said, resolution(table, unit), residual)


def resolution(table: CompensationTable, unit: str) -> float:
    """Return what rounding may leave, m or rad: six decimals in both columns, trims kept in 32 bits."""
    largest = max(float(np.max(np.abs(table.forward))), float(np.max(np.abs(table.reverse))))
    return float(from_unit(2e-6, unit)) + 3e-7 * largest


_REPORT = "do not load it: this is a defect of axiscal, please report it"


def _machine_unit(table: CompensationTable, unit: str | None) -> str:
    known = ("deg",) if table.rotary else ("mm", "in")
    unit = unit or known[0]
    if unit not in known:
        raise TableError(
            f"{table.axis} has no table in {unit!r}", f"the unit of the machine can be {' or '.join(known)}"
        )
    return unit


def _left(parsed: LinuxcncTable, table: CompensationTable, points: Array, side: int, unit: str) -> Array:
    """What is left of the deviation, m or rad (m,), at points in machine units when the correction is added."""
    return table.deviation(from_unit(points, unit), side) + from_unit(correction(parsed, points, side), unit)


def _refuse_what_it_cannot_hold(table: CompensationTable) -> None:
    n = len(table.positions)
    span = float(table.positions[-1] - table.positions[0])
    if n > ROWS:
        fits = format_quantity(math.ceil(span / (ROWS - 1) * 1e6) / 1e6, table.unit)
        remedy = f"{ROWS} points fit: over this travel one every {fits} or wider"
        raise TableError(f"the table of {table.axis} has {n} points, a LinuxCNC COMP_FILE holds {ROWS}", remedy)
    for values in (table.forward, table.reverse):
        slopes = np.abs(np.diff(values)) / np.diff(table.positions)
        if np.any(slopes > STEEPEST):
            where = format_quantity(float(table.positions[int(np.argmax(slopes))]), table.unit)
            what = f"the deviation of {table.axis} after {where} changes by more than {STEEPEST:.0%} of the way"
            raise TableError(what, "LinuxCNC cannot follow that; check the units of the readings")


def _refuse_equal_positions(table: CompensationTable, nominal: Array, unit: str) -> None:
    equal = np.flatnonzero(np.diff(nominal) <= 0)
    if equal.size:
        what = f"two points of {table.axis} at {nominal[equal[0]]:.6f} {unit} are one in the six decimals of the file"
        raise TableError(what, f"set the points at least {1e-6:.6f} {unit} apart")
