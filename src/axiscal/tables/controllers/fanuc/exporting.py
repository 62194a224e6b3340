"""Pitch data of a FANUC: all axes, in the place of those of a punched file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.language.spoken import said
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.tables.controllers.fanuc.pitch import (
    EXPECTED,
    PitchParameters,
    Records,
    read_plans,
    read_records,
    replace_values,
)
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.exporter import TableFormat, Written
from axiscal.tables.loaded import Loaded, Lookup
from axiscal.tables.old_files import OldFile
from axiscal.tables.sampling import own_table
from axiscal.tables.table import CompensationTable
from axiscal.units import format_quantity

LARGEST = 7
"""By FANUC's manual: an entry is a digit with its sign, -7 to +7."""
FIRST_DATA = 10000
"""By FANUC's manual: the number of the first point's entry."""

_FILE = "pitch.txt"
_HOLDS = "the positioning error of axes as increments: {}."
_LEFT = "straightness, squareness and the angular errors of linear axes"
_TURNING = "{} (no parameters 3620 to 3624 in the file, or a whole turn that does not begin at 0), "
_BACKLASH = ", and the reversal of {} (enter it as backlash, parameter 1851)"


class Fanuc(TableFormat):
    """Pitch data in the place of those of a punched file."""

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return the deviation at the points that the parameters of the template name."""
        plans = _template(options, estimate.machine)
        new = [_table(estimate, axis, plan) for axis, plan in plans.items()]
        whole = options.old.under_tables(new, estimate.machine, 0, even=True)
        return tuple(_zeroed(table, plans[table.axis]) for table in whole if table.axis in plans)

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return the template with its pitch data replaced."""
        plans = _template(options, machine)
        found = {table.axis: increments(table, plans[table.axis], _sign(options)) for table in tables}
        filled = fill(options.template or "", plans, found, options.template_name)
        steps = {axis: 0.5 * plan.step + 1e-12 for axis, plan in plans.items()}
        return Written({_FILE: filled}, steps, _notes(plans), *_said(plans, machine))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the control makes of punched files; raises TableError."""
        numbers, lookups = options.numbered(machine), list[Lookup]()
        for file in files:
            records = read_records(file.text, file.name)
            lookups += read(records, read_plans(records, file.name, machine, numbers), _sign(options))
        return Loaded(tuple(lookups))


def _template(options: ExportOptions, machine: Machine) -> dict[str, PitchParameters]:
    """Return what the parameters of the template say; raises TableError where there is none."""
    if options.template is None:
        raise TableError("FANUC files are made from one of your control", "give it: --template FILE")
    records = read_records(options.template, options.template_name)
    return read_plans(records, options.template_name, machine, options.numbered(machine))


def _sign(options: ExportOptions) -> int:
    """Return -1 for a control that takes its entries away."""
    return -1 if options.flip else 1


def _table(estimate: Estimate, name: str, plan: PitchParameters) -> CompensationTable:
    """Return the deviation at the ends of the sections; raises TableError where they do not cover the volume."""
    axis = estimate.machine.index(name)
    low, high = estimate.box[axis]
    needed = plan.covering(low, high)
    if plan.first > needed[0] or plan.last < needed[1]:
        unit = "deg" if plan.rotary else "mm"
        first, last = (format_quantity(float(value), unit) for value in plan.positions[[0, -1]])
        what, shown = (
            "the points of {name} reach from {shown}, the volume goes beyond",
            said("{low} to {high}", low=first, high=last),
        )
        remedy = "3621 = {first} and 3622 = {second} would cover it"
        raise TableError(what, remedy, name=name, shown=shown, first=needed[0], second=needed[1])
    return own_table(estimate, axis, plan.positions)


def _zeroed(table: CompensationTable, plan: PitchParameters) -> CompensationTable:
    """Return the table as the control holds it: one curve for both ways, nothing at the reference point."""
    table = table.averaged()
    home = table.forward[plan.origin]
    return replace(table, forward=table.forward - home, reverse=table.reverse - home)


def _said(plans: Mapping[str, PitchParameters], machine: Machine) -> tuple[str, str]:
    """Return what the file holds, and what it leaves out."""
    axes = ", ".join(plans)
    without = [axis.name for axis in machine.axes if axis.rotary and axis.name not in plans]
    turning = _TURNING.format(", ".join(without)) if without else ""
    return _HOLDS.format(f"the mean of both directions of {axes}"), f"{turning}{_LEFT}{_BACKLASH.format(axes)}."


def _notes(plans: Mapping[str, PitchParameters]) -> tuple[str, ...]:
    parts = [f"{axis} from N{FIRST_DATA + plan.first} to N{FIRST_DATA + plan.last}" for axis, plan in plans.items()]
    return (
        f"Replaced in your file: {', '.join(parts)}. Everything else is as it was.",
        "Supposed: increment system IS-B (detection unit 0.001 mm, 0.001 deg), the reference point at machine zero.",
        "The entry of a point is added over the section that ends at it, so the first one begins an interval below "
        "3621: FANUC's formula, 3621 = 3620 - stroke / interval + 1.",
        *_turn_notes(plans),
        "Power off and on, then return to the reference point. Check one point with a dial gauge, and export with "
        "--flip if the axis goes the wrong way.",
        "The control adds a step at each point where this program supposes a line between: up to half an entry more.",
    )


def _turn_notes(plans: Mapping[str, PitchParameters]) -> tuple[str, ...]:
    turns, parts = (
        ", ".join(axis for axis, plan in plans.items() if plan.rotary and plan.turn is whole) for whole in (True, False)
    )
    whole = f"{turns}: a rotary axis of type A (1006#0 = 1, #1 = 0) and 3625 = 360.0; the entries of a turn sum to 0, "
    whole += "and its first point has the entry of its last."
    part = f"{parts}: supposed of type B (1006#0 = #1 = 1), whose points lie as those of a linear axis, in deg."
    return (*((whole,) if turns else ()), *((part,) if parts else ()))


def increments(table: CompensationTable, plan: PitchParameters, sign: int = 1) -> Array:
    """Return the entries, whole numbers from the first point on: the sums are rounded, so that nothing adds up.

    sign : -1 for a control that takes them away.  Raises TableError where one is larger than the format holds.
    """
    deviation = (table.forward + table.reverse) / 2
    sums = np.round((deviation[plan.origin] - deviation) / plan.step).astype(int)
    entries: Array = np.diff(sums)
    entries = np.concatenate([entries[-1:], entries]) if plan.turn else entries
    worst = int(np.max(np.abs(entries)))
    if worst > LARGEST:
        needed = int(np.ceil(worst * plan.magnification / LARGEST))
        what = "{axis} needs an increment of {worst}, an entry holds {most}"
        remedy = "magnification 3623 = {needed} would fit, or a shorter interval 3624"
        raise TableError(what, remedy, axis=table.axis, worst=worst, most=LARGEST, needed=needed)
    return sign * entries


def fill(text: str, plans: Mapping[str, PitchParameters], found: Mapping[str, Array], file: str) -> str:
    """Return the text with the pitch data of the axes replaced; raises TableError for points that it has no row for."""
    wanted = {
        (FIRST_DATA + point, 0): int(entry)
        for name, entries in found.items()
        for point, entry in zip(plans[name].numbers, entries, strict=True)
    }
    return replace_values(text, wanted, file)


def read(records: Records, plans: Mapping[str, PitchParameters], sign: int = 1) -> list[Lookup]:
    """Return what the control adds: entries add up from the reference point, times the magnification.

    sign : -1 for a control that takes them away
    """
    return [Lookup(axis, axis, plan.positions, sign * _sums(records, plan)) for axis, plan in plans.items()]


def _sums(records: Records, plan: PitchParameters) -> Array:
    rows = [FIRST_DATA + n for n in (plan.numbers[1:] if plan.turn else plan.numbers)]
    if missing := next((row for row in rows if 0 not in records.get(row, {})), None):
        raise TableError("there is no row N{row}", EXPECTED, row=missing)
    steps = np.array([float(records[row][0]) for row in rows])
    sums = np.concatenate([np.zeros(1), np.cumsum(steps)])
    added: Array = (sums - sums[plan.origin]) * plan.step
    return added
