"""All files for a LinuxCNC: a `COMP_FILE` for each axis, HAL text for the axes over other axes, and notes.

Rotary axes that turn on: LinuxCNC does not repeat a table after a turn, so it holds the turns themselves.

Beyond its ends a `COMP_FILE` is constant, and a joint counts on after 360 deg, with WRAPPED_ROTARY as well.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from axiscal.document.file import number_or_none
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import InputError, TableError
from axiscal.language.spoken import said
from axiscal.ports.linuxcnc.tables import cross
from axiscal.ports.linuxcnc.tables.writer import ROWS, LinuxcncTable, notes, parse, resolution, write
from axiscal.tables.exporter import ExportOptions, TableFormat, Written, summed
from axiscal.tables.loaded import Loaded, OldFile, lost_motion
from axiscal.tables.sampling import axis_tables, cross_tables, own_table
from axiscal.tables.table import CompensationTable
from axiscal.units import from_unit
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

_CURVE = re.compile(r"setp\s+\S*?\b([a-z][0-9]?)-([a-z][0-9]?)\.([xy])-val-(\d+)\s+(\S+)")

_POINT = re.compile(r"\s*setp\s+\S*[xy]-val-\d+\s")
_LARGEST = 1e6
"""In the machine's unit: a kilometre in millimetres, which no table corrects."""

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
    takes = frozenset({"--spacing", "--unit", "--number", "--on-top-of"})

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return tables of axes over as many turns as they make, and curves of axes over others."""
        machine = estimate.machine
        new = tuple(one_turn(estimate, t) for t in axis_tables(estimate, options.spacing, ROWS))
        own = tuple(over_turns(t, machine) for t in options.old.alone(within=True).under_tables(new, machine, ROWS))
        across = cross_tables(estimate, most=cross.POINTS, uneven=options.spacing is None)
        across = options.old.alone(within=False).under_tables(across, machine, cross.POINTS, even=True)
        return (*own, *(t.averaged() for t in across))  # a lincurve has no direction

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

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what files did, by what they say alone; raises TableError."""
        joints, unit = options.joints(machine), options.unit_of(machine)
        tables, untaken = list[CompensationTable](), list[InputError]()
        for file in files:
            if file.unit not in ("", unit):
                what = "its INI file counts lengths in another unit than {new}, in which new tables would be"
                raise TableError(what, "say --unit {its}", file.name, its=file.unit, new=unit)
            if file.name.lower().endswith(".hal"):
                tables += _curves(file, machine, unit, untaken)
            elif file.backlash:
                axis = _axis(file, machine, joints)
                lost = float(from_unit(file.backlash, "deg" if machine.axis(axis).rotary else unit))
                tables += lost_motion(machine, {axis: lost})  # half to each side, as motion adds it (control.c)
            else:
                tables += _table(file, _axis(file, machine, joints), machine, unit, untaken)
        return Loaded(tuple(tables), untaken=tuple(untaken))


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


def _axis(file: OldFile, machine: Machine, joints: Mapping[str, Sequence[int]]) -> str:
    """Return the axis that a file is for: as said, by its joint, or by its name, X.comp or joint0.comp."""
    names = {axis.name.casefold(): axis.name for axis in machine.axes}
    if file.axis:
        return machine.axis(file.axis).name
    number = file.joint
    if number is None and (numbered := re.search(r"joint_?(\d+)", file.stem, re.IGNORECASE)):
        number = int(numbered[1])
    owners = [axis for axis, numbers in joints.items() if number in numbers]
    if owners:
        return owners[0]
    for word in re.split(r"[^A-Za-z0-9]+", file.stem):
        if word.casefold() in names:
            return names[word.casefold()]
    remedy = "write --on-top-of X={path}"
    raise TableError("nothing says which axis this table is for", remedy, file.name, path=file.name)


def _table(
    file: OldFile, axis: str, machine: Machine, machine_unit: str, untaken: list[InputError]
) -> list[CompensationTable]:
    kept = _parsed(file, _type(file))
    if not len(kept.nominal):
        raise TableError("LinuxCNC reads no row of this file", "name a COMP_FILE", file.name)
    lines, remedy = file.text.split("\n"), said("take it out, or mend it: rows increase, 256 of them at most")
    skipped = {number: lines[number - 1].strip()[:40] for number in kept.skipped}
    whats = {text: said("LinuxCNC skips this row: {text!r}", text=text) for text in set(skipped.values())}
    untaken += [TableError(whats[text], remedy, file.name, number) for number, text in skipped.items()]
    unit = "deg" if machine.axis(axis).rotary else machine_unit
    at, forward, reverse = (from_unit(values, unit) for values in (kept.nominal, kept.forward, kept.reverse))
    return [CompensationTable(axis, at, -forward, -reverse)]


def _parsed(file: OldFile, file_type: int) -> LinuxcncTable:
    kept = parse(file.text, file_type=file_type)
    if not all(np.all(np.abs(column) < _LARGEST) for column in (kept.nominal, kept.forward, kept.reverse)):
        remedy = "give the file as the control loads it"
        raise TableError("it has a number that is too large for a machine", remedy, file.name)
    return kept


def _type(file: OldFile) -> int:
    """Return COMP_FILE_TYPE, found from the values where nobody said: those of Type 0 go with the nominal ones."""
    if file.file_type is not None:
        return file.file_type
    rows = _parsed(file, 1)
    if len(rows.nominal) < 2:
        return 0
    slope = np.ptp(rows.forward) / np.ptp(rows.nominal)
    return 0 if slope > 0.5 else 1


def _curves(file: OldFile, machine: Machine, unit: str, untaken: list[InputError]) -> list[CompensationTable]:
    """Return the curves of axes over other axes."""
    found: dict[tuple[str, str], dict[str, dict[int, float]]] = {}
    for line, text in enumerate(file.text.splitlines(), 1):
        if _POINT.match(text) and not _CURVE.search(text):
            what, remedy = "{text!r} names no axis over another one", "name the curve as in setp y-x.x-val-00 0"
            untaken.append(TableError(what, remedy, file.name, line, text=text.strip()[:60]))
    for moved, over, side, place, value in _CURVE.findall(file.text):
        if (number := number_or_none(value)) is None:
            remedy = "give the HAL file as it is"
            raise TableError("{text!r} is no number of a curve", remedy, file.name, text=value[:40])
        found.setdefault((moved.upper(), over.upper()), {"x": {}, "y": {}})[side][int(place)] = number
    tables = []
    for (moved, over), sides in found.items():
        x, y = (np.array([sides[side][i] for i in sorted(sides[side])]) for side in "xy")
        if len(x) != len(y) or np.any(np.diff(x) <= 0):
            remedy = "give the HAL file as it is"
            raise TableError("the curve of {moved} over {over} is not whole", remedy, file.name, moved=moved, over=over)
        units = ["deg" if machine.axis(name).rotary else unit for name in (over, moved)]
        taken = -from_unit(y, units[1])
        tables.append(CompensationTable(moved, from_unit(x, units[0]), taken, taken, over=over))
    return tables
