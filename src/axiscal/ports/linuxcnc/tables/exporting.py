"""All files for a LinuxCNC: a `COMP_FILE` for each axis, HAL text for the axes over other axes, and notes.

Rotary axes that turn on: LinuxCNC does not repeat a table after a turn, so it holds the turns themselves.

Beyond its ends a `COMP_FILE` is constant, and a joint counts on after 360 deg, with WRAPPED_ROTARY as well.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.ports.linuxcnc.tables import cross
from axiscal.ports.linuxcnc.tables.writer import ROWS, notes, parse, resolution, write
from axiscal.tables.exporter import ExportOptions, TableFormat, Written, summed
from axiscal.tables.loaded import Loaded
from axiscal.tables.sampling import axis_tables, cross_tables, own_table
from axiscal.tables.table import CompensationTable
from axiscal.units import from_unit
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

_CURVE = re.compile(r"setp\s+\S*?\b([a-z][0-9]?)-([a-z][0-9]?)\.([xy])-val-\d+\s+(\S+)")

MOST_TURNS = 5
"""256 rows hold five turns of 51 points."""

_HAL_FILE = "axiscal-cross.hal"


class Linuxcnc(TableFormat):
    """A `COMP_FILE` for each axis, and HAL text that moves axes over others."""

    holds = ""  # the files decide
    left_out = (
        "errors that depend on two axes at once (angular errors times a lever that changes), the orientation of the "
        "tool, and the reversal of straightness."
    )
    tried = True
    takes = frozenset({"--spacing", "--unit", "--number"})

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return tables of axes over as many turns as they make, and curves of axes over others."""
        machine = estimate.machine
        own = (one_turn(estimate, t) for t in axis_tables(estimate, options.spacing, ROWS))
        new = (over_turns(table, machine) for table in own)
        across = cross_tables(estimate, most=cross.POINTS, uneven=options.spacing is None)
        return (*new, *(t.averaged() for t in across))  # a lincurve has no direction

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return the files."""
        speeds, linear = {axis.name: axis.speed for axis in machine.axes}, options.unit_of(machine)
        wiring = cross.Wiring(options.joints(machine), speeds, linear)
        own, over = ([t for t in tables if (t.axis == t.over) is itself] for itself in (True, False))
        files, said = dict[str, str](), dict[str, None]()
        for table in own:
            axis, unit = machine.axis(table.axis), table.value_unit(linear)
            files[f"{table.axis}.comp"] = write(table, unit)
            said |= dict.fromkeys(notes(table, unit, wiring.joints[table.axis], axis.acceleration))
        files |= {_HAL_FILE: cross.write(over, wiring)} if over else {}
        each = f"one COMP_FILE for each of {', '.join(table.axis for table in own)} (own positions, both directions)"
        moves = "HAL text that moves linear axes over the positions of other linear axes"
        holds = f"{' and '.join([*([each] if own else []), *([moves] if over else [])])}."
        return Written(files, _resolution(own, over, linear), (*said, *_hal_notes(machine, over)), holds)

    def load(self, files: Mapping[str, str], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what LinuxCNC makes of the files, by what they say alone; raises TableError."""
        unit, tables = options.unit_of(machine), list[CompensationTable]()
        for name, text in files.items():
            hal = name.endswith(".hal")
            tables += _curves(text, machine, unit) if hal else [_table(text, machine.axis(Path(name).stem), unit)]
        return Loaded(tuple(tables))


def _resolution(own: Sequence[CompensationTable], over: Sequence[CompensationTable], linear: str) -> dict[str, float]:
    value, position = (float(from_unit(last, linear)) for last in (1e-7, 1e-6))
    alone = [(table.axis, resolution(table, table.value_unit(linear))) for table in own]
    slopes = ((t.axis, float(np.max(np.abs(np.diff(t.forward) / np.diff(t.positions))))) for t in over)
    return summed([*alone, *((axis, value + steepest * position) for axis, steepest in slopes)])


def _hal_notes(machine: Machine, over: Sequence[CompensationTable]) -> tuple[str, ...]:
    notes = []
    if over:
        notes.append(
            f"{_HAL_FILE} corrects axes over other axes: its first lines say how to wire it. Without it the COMP_FILEs "
            "work alone. It acts once all joints are homed, within a second, and stops acting while one is not."
        )
    if any(axis.rotary for axis in machine.axes):
        notes.append(
            "COMP_FILEs act on joints: with xyzac-trt-kins and its kin they are right as well, the HAL text too."
        )
    return tuple(notes)


def one_turn(estimate: Estimate, table: CompensationTable) -> CompensationTable:
    """Return the table of a full-turn axis on as few points that all its turns fit; any other table as it is."""
    axis = estimate.machine.axis(table.axis)
    fits = (ROWS - 1) // (sum(turns(axis)) + 1)
    if not axis.cyclic or len(table.positions) - 1 <= fits:
        return table
    return own_table(estimate, estimate.machine.index(axis.name), np.linspace(*axis.travel, fits + 1), uneven=True)


def over_turns(table: CompensationTable, machine: Machine) -> CompensationTable:
    """Return a table of one turn repeated over the turns that its axis may make; any other table as it is.

    The end of one turn is the beginning of the next.
    """
    axis, count = machine.axis(table.axis), len(table.positions)
    if not (axis.cyclic and np.allclose(table.positions[[0, -1]], axis.travel)):
        return table
    below, above = turns(axis)
    shifts = 2 * np.pi * np.arange(-below, above + 1)
    again = np.append(np.tile(np.arange(count - 1), len(shifts)), count - 1)
    at = np.append((shifts[:, None] + table.positions[:-1]).ravel(), shifts[-1] + table.positions[-1])
    forward, reverse, std = (values[again] for values in (table.forward, table.reverse, table.std))
    return replace(table, positions=at, forward=forward, reverse=reverse, std=std, prior_only=table.prior_only[again])


def turns(axis: Axis) -> tuple[int, int]:
    """Return the turns below and above the travel that a table holds: two each where nobody said, never over five."""
    below, above = axis.turns or (MOST_TURNS // 2, MOST_TURNS // 2)
    spare = MOST_TURNS - 1
    low = min(below, max(spare // 2, spare - above))
    return low, min(above, spare - low)


def _table(text: str, axis: Axis, linear: str) -> CompensationTable:
    kept, unit = parse(text), "deg" if axis.rotary else linear
    at, forward, reverse = (from_unit(values, unit) for values in (kept.nominal, kept.forward, kept.reverse))
    return CompensationTable(axis.name, at, -forward, -reverse)


def _curves(text: str, machine: Machine, unit: str) -> list[CompensationTable]:
    """Return the curves of axes over other axes."""
    found: dict[tuple[str, str], dict[str, list[float]]] = {}
    for moved, over, side, value in _CURVE.findall(text):
        found.setdefault((moved.upper(), over.upper()), {"x": [], "y": []})[side].append(float(value))
    tables = []
    for (moved, over), sides in found.items():
        at, added = (from_unit(np.array(sides[side]), unit) for side in "xy")
        tables.append(CompensationTable(moved, at, -added, -added, over=over))
    return tables
