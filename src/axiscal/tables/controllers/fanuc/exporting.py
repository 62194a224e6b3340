"""Pitch data of a FANUC: all axes, in the place of those of a punched file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.language.spoken import said
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.tables.controllers.fanuc.pitch import (
    APART,
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
_BACKLASH = ", and the reversal of {} (enter it as backlash, parameter 1851, or give 3605#0, 3626 and 3627)"


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
        plans, numbers = _template(options, machine), options.numbered(machine)
        found = {table.axis: increments(table, plans[table.axis], _sign(options)) for table in tables}
        filled = fill(options.template or "", plans, found, numbers, options.template_name)
        steps = {axis: 0.5 * plan.step + _apart(plan) + 1e-12 for axis, plan in plans.items()}
        return Written({_FILE: filled}, steps, _notes(plans), *_said(plans, machine))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the control makes of punched files; raises TableError."""
        numbers, lookups = options.numbered(machine), list[Lookup]()
        for file in files:
            records = read_records(file.text, file.name)
            lookups += read(records, read_plans(records, file.name, machine, numbers), numbers, _sign(options))
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
    """Return the table as the control holds it: nothing at the reference point, one curve without a second set."""
    if plan.negative is None:
        table = table.averaged()
    home = (table.reverse if plan.downwards else table.forward)[plan.origin]
    return replace(table, forward=table.forward - home, reverse=table.reverse - home)


def _apart(plan: PitchParameters) -> float:
    """Return what rounding leaves of the distance between two sets, m or rad."""
    return 0.0 if plan.negative is None else 0.5 * plan.detection


def _said(plans: Mapping[str, PitchParameters], machine: Machine) -> tuple[str, str]:
    """Return what the file holds, and what it leaves out."""
    both = [axis for axis, plan in plans.items() if plan.negative is not None]
    mean = [axis for axis, plan in plans.items() if plan.negative is None]
    parts = [f"both directions of {', '.join(both)}"] if both else []
    parts += [f"the mean of both directions of {', '.join(mean)}"] if mean else []
    without = [axis.name for axis in machine.axes if axis.rotary and axis.name not in plans]
    turning = _TURNING.format(", ".join(without)) if without else ""
    back = _BACKLASH.format(", ".join(mean)) if mean else ""
    return _HOLDS.format(" and ".join(parts)), f"{turning}{_LEFT}{back}."


def _notes(plans: Mapping[str, PitchParameters]) -> tuple[str, ...]:
    parts = [
        f"{axis} from N{FIRST_DATA + points[0]} to N{FIRST_DATA + points[-1]}"
        for axis, plan in plans.items()
        for points in plan.numbers
    ]
    return (
        f"Replaced in your file: {', '.join(parts)}. Everything else is as it was.",
        "Supposed: increment system IS-B (detection unit 0.001 mm, 0.001 deg), the reference point at machine zero.",
        "The entry of a point is added over the section that ends at it, so the first one begins an interval below "
        "3621: FANUC's formula, 3621 = 3620 - stroke / interval + 1.",
        *_turn_notes(plans),
        *_both_notes(plans),
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


def _both_notes(plans: Mapping[str, PitchParameters]) -> tuple[str, ...]:
    both = [axis for axis, plan in plans.items() if plan.negative is not None]
    if not both:
        return ()
    ways = ", ".join(f"{axis} {'downwards' if plans[axis].downwards else 'upwards'}" for axis in both)
    return (
        f"Two sets for {', '.join(both)}: 3605#0 must be 1, and backlash (1851, 1852) of these axes 0. The second set "
        "is written as it is seen from below, as the first one is, and 3627 in detection units.",
        f"Supposed: the reference point is come to {ways} (1006#5). 3627 is what is added there the other way.",
    )


@dataclass(frozen=True, eq=False, slots=True)
class Increments:
    """Entries of one axis, whole numbers from its first point on.

    up : (n,) for travel upwards, or for both ways; down : (n,), None without a second set
    apart : parameter 3627, what is added at the reference point when it is approached the other way, detection units
    """

    up: Array
    down: Array | None = None
    apart: int = 0


def increments(table: CompensationTable, plan: PitchParameters, sign: int = 1) -> Increments:
    """Return the entries: the sums, not the increments, are rounded, so that nothing adds up.

    sign : -1 for a control that takes them away.  Raises TableError where one is larger than the format holds.
    """
    if plan.negative is None:
        return Increments(sign * _entries(table.axis, (table.forward + table.reverse) / 2, plan))
    apart = round(float(_added(table, plan, not plan.downwards)[plan.origin]) / plan.detection)
    sides = [_entries(table.axis, values, plan) for values in (table.forward, table.reverse)]
    return Increments(sign * sides[0], sign * sides[1], sign * apart)


def _added(table: CompensationTable, plan: PitchParameters, downwards: bool) -> Array:
    """Return what is to be added at the ends of the sections, nothing at the reference point as it is returned to."""
    home = table.reverse if plan.downwards else table.forward
    added: Array = home[plan.origin] - (table.reverse if downwards else table.forward)
    return added


def _entries(axis: str, deviation: Array, plan: PitchParameters) -> Array:
    sums = np.round((deviation[plan.origin] - deviation) / plan.step).astype(int)
    entries: Array = np.diff(sums)
    entries = np.concatenate([entries[-1:], entries]) if plan.turn else entries
    worst = int(np.max(np.abs(entries)))
    if worst > LARGEST:
        needed = int(np.ceil(worst * plan.magnification / LARGEST))
        what = "{axis} needs an increment of {worst}, an entry holds {most}"
        remedy = "magnification 3623 = {needed} would fit, or a shorter interval 3624"
        raise TableError(what, remedy, axis=axis, worst=worst, most=LARGEST, needed=needed)
    return entries


def fill(
    text: str,
    plans: Mapping[str, PitchParameters],
    found: Mapping[str, Increments],
    numbers: Mapping[str, int],
    file: str,
) -> str:
    """Return the text with the pitch data of the axes replaced; raises TableError for points that it has no row for.

    numbers : of the controlled axes by name
    """
    wanted: dict[tuple[int, int], int] = {}
    for name, made in found.items():
        sides = [made.up] if made.down is None else [made.up, made.down]
        for points, entries in zip(plans[name].numbers, sides, strict=True):
            wanted |= {(FIRST_DATA + n, 0): int(v) for n, v in zip(points, entries, strict=True)}
        if made.down is not None:
            wanted[APART, numbers[name]] = made.apart
    return replace_values(text, wanted, file)


def read(
    records: Records, plans: Mapping[str, PitchParameters], numbers: Mapping[str, int], sign: int = 1
) -> list[Lookup]:
    """Return what the control adds: entries add up from the reference point, times the magnification.

    sign : -1 for a control that takes them away
    """
    lookups = []
    for axis, plan in plans.items():
        ups, *downs = (_sums(records, points, plan) for points in plan.numbers)
        if not downs:
            lookups.append(Lookup(axis, axis, plan.positions, sign * ups))
            continue
        apart = float(records[APART][numbers[axis]]) * plan.detection
        ups, down = (ups + apart, downs[0]) if plan.downwards else (ups, downs[0] + apart)
        lookups.append(Lookup(axis, axis, plan.positions, sign * ups, 1))
        lookups.append(Lookup(axis, axis, plan.positions, sign * down, -1))
    return lookups


def _sums(records: Records, points: range, plan: PitchParameters) -> Array:
    rows = [FIRST_DATA + n for n in (points[1:] if plan.turn else points)]
    if missing := next((row for row in rows if 0 not in records.get(row, {})), None):
        raise TableError("there is no row N{row}", EXPECTED, row=missing)
    steps = np.array([float(records[row][0]) for row in rows])
    sums = np.concatenate([np.zeros(1), np.cumsum(steps)])
    added: Array = (sums - sums[plan.origin]) * plan.step
    return added
