"""All files for a LinuxCNC: a `COMP_FILE` for each axis, HAL text for the axes over other axes, and notes.

Rotary axes that turn on: LinuxCNC does not repeat a table after a turn, so it holds the turns themselves.

Beyond its ends a `COMP_FILE` is constant, and a joint counts on after 360 deg, with WRAPPED_ROTARY as well.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import InputError, TableError
from axiscal.language.spoken import said
from axiscal.ports.linuxcnc.tables import cross
from axiscal.ports.linuxcnc.tables.writer import ROWS, notes, parse, resolution, write
from axiscal.tables.exporter import ExportOptions, TableFormat, Written
from axiscal.tables.loaded import Loaded, OldFile, lost_motion
from axiscal.tables.sampling import axis_tables, cross_tables, own_table
from axiscal.tables.table import CompensationTable
from axiscal.units import from_unit
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

_MOST_TURNS = 5
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
    takes = frozenset({"--spacing", "--unit", "--number", "--on-top-of"})

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return tables of axes over as many turns as they make, and curves of axes over others."""
        machine = estimate.machine
        new = tuple(_one_turn(estimate, t) for t in axis_tables(estimate, options.spacing, ROWS))
        before, over = (
            Loaded(tuple(t for t in options.old.tables if (t.axis == t.over) is own)) for own in (True, False)
        )
        own = tuple(_over_turns(t, machine) for t in before.under_tables(new, machine, ROWS))
        across = cross_tables(estimate, most=cross.POINTS, uneven=options.spacing is None)
        across = over.under_tables(across, machine, cross.POINTS, even=True)
        return (*own, *(t.averaged() for t in across))  # a lincurve has no direction

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return the files."""
        linear, joints = options.unit_of(machine), options.joints(machine)
        own, over = ([t for t in tables if (t.axis == t.over) is itself] for itself in (True, False))
        files, said, steps = dict[str, str](), dict[str, None](), defaultdict[str, float](float)
        for table in own:
            acceleration, unit = machine.axis(table.axis).acceleration, table.value_unit(linear)
            files[f"{table.axis}.comp"] = write(table, unit)
            steps[table.axis] += resolution(table, unit)
            said |= dict.fromkeys(notes(table, unit, joints[table.axis], acceleration))
        value, position = (float(from_unit(last, linear)) for last in (1e-7, 1e-6))
        for table in over:
            steps[table.axis] += value + cross.steepest(table) * position
        each = f"one COMP_FILE for each of {', '.join(table.axis for table in own)} (own positions, both directions)"
        holds = [each] if own else []
        if over:
            files[_HAL_FILE] = cross.write(over, joints, {axis.name: axis.speed for axis in machine.axes}, linear)
            holds.append("HAL text that moves linear axes over the positions of other linear axes")
            said[
                f"{_HAL_FILE} corrects axes over other axes: its first lines say how to wire it. Without it the "
                "COMP_FILEs work alone. It acts once all joints are homed, within a second, and stops acting while one "
                "is not."
            ] = None
        if any(axis.rotary for axis in machine.axes):
            acts = "COMP_FILEs act on joints: with xyzac-trt-kins and its kin they are right as well, the HAL text too."
            said[acts] = None
        return Written(files, steps, tuple(said), f"{' and '.join(holds)}.")

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what files did, by what they say alone; raises TableError."""
        joints, linear = options.joints(machine), options.unit_of(machine)
        tables, untaken = list[CompensationTable](), list[InputError]()
        for file in files:
            if file.unit not in ("", linear):
                what = "its INI file counts lengths in another unit than {new}, in which new tables would be"
                raise TableError(what, "say --unit {its}", file.name, its=file.unit, new=linear)
            if file.name.lower().endswith(".hal"):
                tables += cross.read(file, machine, linear, untaken)
                continue
            axis = _axis(file, machine, joints)
            unit = "deg" if machine.axis(axis).rotary else linear
            if file.backlash:  # half to each side, as motion adds it (control.c)
                tables += lost_motion(machine, {axis: float(from_unit(file.backlash, unit))})
            else:
                tables.append(_table(file, axis, unit, untaken))
        return Loaded(tuple(tables), untaken=tuple(untaken))


def _one_turn(estimate: Estimate, table: CompensationTable) -> CompensationTable:
    """Return the table of a full-turn axis on as few points that all its turns fit; any other table as it is."""
    axis = estimate.machine.axis(table.axis)
    fits = (ROWS - 1) // (sum(_turns(axis)) + 1)
    if not axis.cyclic or len(table.positions) - 1 <= fits:
        return table
    return own_table(estimate, estimate.machine.index(axis.name), np.linspace(*axis.travel, fits + 1), uneven=True)


def _over_turns(table: CompensationTable, machine: Machine) -> CompensationTable:
    """Return a table of one turn repeated over the turns that its axis may make; any other table as it is.

    The end of one turn is the beginning of the next.
    """
    axis, count = machine.axis(table.axis), len(table.positions)
    if not (axis.cyclic and np.allclose(table.positions[[0, -1]], axis.travel)):
        return table
    below, above = _turns(axis)
    shifts = 2 * np.pi * np.arange(-below, above + 1)
    again = np.append(np.tile(np.arange(count - 1), len(shifts)), count - 1)
    at = np.append((shifts[:, None] + table.positions[:-1]).ravel(), shifts[-1] + table.positions[-1])
    sides = {name: getattr(table, name)[again] for name in ("forward", "reverse", "std", "prior_only")}
    return replace(table, positions=at, **sides)


def _turns(axis: Axis) -> tuple[int, int]:
    """Return the turns below and above the travel that a table holds: two each where nobody said, never over five."""
    below, above = axis.turns or (_MOST_TURNS // 2, _MOST_TURNS // 2)
    spare = _MOST_TURNS - 1
    low = min(below, max(spare // 2, spare - above))
    return low, min(above, spare - low)


def _axis(file: OldFile, machine: Machine, joints: Mapping[str, Sequence[int]]) -> str:
    """Return the axis that a file is for: as said, by its joint, or by its name, X.comp or joint0.comp."""
    if file.axis:
        return machine.axis(file.axis).name
    stem = Path(file.name).stem
    numbered = re.search(r"joint_?(\d+)", stem, re.IGNORECASE)
    number = int(numbered[1]) if file.joint is None and numbered else file.joint
    owners = [axis for axis, numbers in joints.items() if number in numbers]
    words = {word.casefold() for word in re.split(r"[^A-Za-z0-9]+", stem)}
    owners += [axis.name for axis in machine.axes if axis.name.casefold() in words]
    if not owners:
        remedy = "write --on-top-of X={path}"
        raise TableError("nothing says which axis this table is for", remedy, file.name, path=file.name)
    return owners[0]


def _table(file: OldFile, axis: str, unit: str, untaken: list[InputError]) -> CompensationTable:
    """Return the table of a file as LinuxCNC keeps it.

    COMP_FILE_TYPE is found from the values where nobody said: those of Type 0 go with the nominal ones.
    """
    kept = parse(file.text, 1 if file.file_type is None else file.file_type)
    if file.file_type is None and not (len(kept.nominal) > 1 and np.ptp(kept.forward) <= 0.5 * np.ptp(kept.nominal)):
        kept = parse(file.text, 0)
    if not len(kept.nominal):
        raise TableError("LinuxCNC reads no row of this file", "name a COMP_FILE", file.name)
    lines, remedy = file.text.split("\n"), said("take it out, or mend it: rows increase, 256 of them at most")
    for number in kept.skipped:
        text = lines[number - 1].strip()[:40]
        untaken.append(TableError("LinuxCNC skips this row: {text!r}", remedy, file.name, number, text=text))
    at, forward, reverse = (from_unit(values, unit) for values in (kept.nominal, kept.forward, kept.reverse))
    return CompensationTable(axis, at, -forward, -reverse)
