"""The pitch data of all axes, in the place of those of a punched file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from axiscal.compensation.controllers.fanuc.data import FIRST_DATA, fill, increments, read
from axiscal.compensation.controllers.fanuc.pitch import PitchParameters, read_plans
from axiscal.compensation.controllers.fanuc.records import read_records
from axiscal.compensation.effect import table_control
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.lookup import lookup_control
from axiscal.compensation.offer import Draft
from axiscal.compensation.sampling import own_table
from axiscal.compensation.table import CompensationTable
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.units import format_quantity

_FILE = "pitch.txt"
_HOLDS = "the positioning error of axes as increments: {}."
_LEFT = "straightness, squareness and the angular errors of linear axes"
_TURNING = "{} (no parameters 3620 to 3624 in the file, or a whole turn that does not begin at 0), "
_BACKLASH = ", and the reversal of {} (enter it as backlash, parameter 1851, or give 3605#0, 3626 and 3627)"


def make(estimate: Estimate, options: ExportOptions) -> Draft:
    """Return the template with its pitch data replaced; raises TableError."""
    machine, text, name = estimate.machine, options.template, options.template_name
    if text is None:
        raise TableError("FANUC files are made from one of your control", "give it: --template FILE")
    numbers = options.numbered(machine)
    plans = read_plans(read_records(text, name), name, machine, numbers)
    new = [_table(estimate, axis, plan) for axis, plan in plans.items()]
    whole = options.old.under_tables(new, machine, 0, even=True)
    tables = {table.axis: _zeroed(table, plans[table.axis]) for table in whole if table.axis in plans}
    sign = -1 if options.flip else 1
    found = {axis: increments(table, plans[axis], sign) for axis, table in tables.items()}
    filled = fill(text, plans, found, numbers, name)
    held = lookup_control(machine, read(read_records(filled, name), plans, numbers, sign))
    wanted = table_control(machine, list(tables.values()))
    resolution = {axis: 0.5 * plan.step + _apart(plan) + 1e-12 for axis, plan in plans.items()}
    holds, left = _said(plans, machine)
    notes = _notes(plans)
    return Draft({_FILE: filled}, held, wanted, resolution, tuple(tables.values()), holds, left, notes, tried=False)


def _table(estimate: Estimate, name: str, plan: PitchParameters) -> CompensationTable:
    """Return the deviation at the ends of the sections; raises TableError where they do not cover the volume."""
    axis = estimate.machine.index(name)
    low, high = estimate.box[axis]
    needed = plan.covering(low, high)
    if plan.first > needed[0] or plan.last < needed[1]:
        shown = " to ".join(
            format_quantity(float(value), "deg" if plan.rotary else "mm") for value in plan.positions[[0, -1]]
        )
        what = f"the points of {name} reach from {shown}, the volume goes beyond"
        raise TableError(what, f"3621 = {needed[0]} and 3622 = {needed[1]} would cover it")
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
