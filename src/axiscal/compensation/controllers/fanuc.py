"""FANUC pitch error compensation, into a file that the user's own control has punched.

The file must hold the parameters of the compensation (3620 number of the reference point, 3621 and 3622 the last points
on either side, 3623 magnification, 3624 interval) and the pitch data from N10000. Their rows are replaced; everything
else stays as it is. Entries are increments from point to point, small whole numbers times the magnification times the
detection unit; the sum from the reference point is what is added to the command.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.compensation.effect import table_control
from axiscal.compensation.estimate import Estimate
from axiscal.compensation.lookup import Lookup, lookup_control
from axiscal.compensation.offer import Draft
from axiscal.compensation.options import Options
from axiscal.compensation.sampling import own_table
from axiscal.compensation.table import CompensationTable
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.units import format_quantity

DETECTION = 1e-6
"""Detection unit of increment system IS-B, m."""
LARGEST = 7
FIRST_DATA = 10000
_FILE = "pitch.txt"
_RECORD = re.compile(r"N0*(\d+)(Q\d+)?((?:[A-Z]\d*)?P-?[\d.]+(?:[A-Z]\d*P-?[\d.]+)*)(\s*;?)")
_VALUE = re.compile(r"(?:A(\d+))?P(-?[\d.]+)")
_EXPECTED = (
    "punch parameters and pitch data from the control: records like N10000P0; between % and %, with N3620 to N3624 for "
    "each axis as N3620A1P100A2P200;"
)
_HOLDS = "the positioning error of the linear axes, the mean of both directions, as increments."
_LEFT = "rotary axes, reversal (enter it as backlash, parameter 1851), straightness, squareness and angular errors."


@dataclass(frozen=True, slots=True)
class Plan:
    """What the parameters say of one axis.

    reference, first, last : numbers of points; magnification : multiplies each entry; interval : m
    """

    reference: int
    first: int
    last: int
    magnification: int
    interval: float

    @property
    def positions(self) -> Array:
        """Where the points lie, m; the reference point is the machine's zero."""
        numbers = np.arange(self.first, self.last + 1, dtype=float)
        at: Array = (numbers - self.reference) * self.interval
        return at

    @property
    def step(self) -> float:
        """What an entry of 1 moves, m."""
        return self.magnification * DETECTION


def make(estimate: Estimate, options: Options) -> Draft:
    """Return the template with its pitch data replaced; raises TableError."""
    machine, text = estimate.machine, options.template
    if text is None:
        raise TableError("FANUC files are made from one of your control", "give it: --template FILE")
    plans = read_plans(text, options.template_name, linear_numbers(machine, options))
    tables = [_table(estimate, name, plan) for name, plan in plans.items()]
    sign = -1 if options.flip else 1
    found = {t.axis: sign * entries(t, plans[t.axis]) for t in tables}
    filled = fill(text, [(plans[axis], values) for axis, values in found.items()], options.template_name)
    held = lookup_control(machine, read(filled, options.template_name, machine, options))
    wanted = table_control(machine, [_flat(table) for table in tables])
    resolution = {axis: 0.5 * plan.step + 1e-12 for axis, plan in plans.items()}
    return Draft({_FILE: filled}, held, wanted, resolution, tuple(tables), _HOLDS, _LEFT, _notes(plans), tried=False)


def linear_numbers(machine: Machine, options: Options) -> dict[str, int]:
    """Return the controlled-axis number of each linear axis."""
    return {name: n for name, n in options.numbered(machine).items() if not machine.axis(name).rotary}


def read_plans(text: str, file: str, numbers: Mapping[str, int]) -> dict[str, Plan]:
    """Return what the parameters say; axes without a positive interval are left out.  Raises TableError."""
    records = _records(text, file)
    plans = {}
    for name, number in numbers.items():
        values = [records.get(key, {}).get(number) for key in range(3620, 3625)]
        missing = [key for key, value in zip(range(3620, 3625), values, strict=True) if value is None]
        if missing:
            shown = ", ".join(map(str, missing))
            raise TableError(f"there are no parameters {shown} for {name} (axis {number})", _EXPECTED, file)
        reference, first, last, magnification, interval = (value or "0" for value in values)
        width = float(interval) * (1e-3 if "." in interval else DETECTION)
        if width > 0:
            plans[name] = Plan(int(reference), int(first), int(last), max(1, int(magnification)), width)
            _refuse_order(name, plans[name], file)
    if not plans:
        raise TableError("no axis has an interval of compensation (3624)", "set it on the control first", file)
    return plans


def entries(table: CompensationTable, plan: Plan) -> Array:
    """Return the increments, whole numbers: the sums, not the increments, are rounded, so that nothing adds up.

    Raises TableError where an increment is larger than the format holds.
    """
    mean = (table.forward + table.reverse) / 2
    at_reference = np.interp(0.0, table.positions, mean)
    sums = np.round((at_reference - mean) / plan.step).astype(int)
    increments = np.diff(sums, prepend=sums[0])
    increments[0] = 0
    worst = int(np.max(np.abs(increments)))
    if worst > LARGEST:
        needed = int(np.ceil(worst * plan.magnification / LARGEST))
        what = f"{table.axis} needs an increment of {worst}, an entry holds {LARGEST}"
        raise TableError(what, f"magnification 3623 = {needed} would fit, or a shorter interval 3624")
    return increments


def fill(text: str, data: Sequence[tuple[Plan, Array]], file: str) -> str:
    """Return the text with the pitch data of the axes replaced; raises TableError for points that it has no row for."""
    rows = {FIRST_DATA + plan.first + i: int(v) for plan, values in data for i, v in enumerate(values)}
    seen: set[int] = set()

    def replaced(match: re.Match[str]) -> str:
        number = int(match[1])
        if number not in rows:
            return match[0]
        seen.add(number)
        head = match[0][: match.start(3) - match.start()]
        return f"{head}P{rows[number]}{match[4]}"

    filled = _RECORD.sub(replaced, text)
    if missing := sorted(rows.keys() - seen):
        what = f"there is no row N{missing[0]}" + (f" and {len(missing) - 1} more" if len(missing) > 1 else "")
        raise TableError(what, _EXPECTED, file)
    return filled


def read(text: str, file: str, machine: Machine, options: Options) -> list[Lookup]:
    """Return what the control makes of the file: entries add up from the reference point, times the magnification."""
    records = _records(text, file)
    lookups = []
    for axis, plan in read_plans(text, file, linear_numbers(machine, options)).items():
        numbers = range(plan.first, plan.last + 1)
        steps = np.array([float(records[FIRST_DATA + n][0]) for n in numbers])
        sums = np.cumsum(steps)
        added = (sums - sums[plan.reference - plan.first]) * plan.step * (-1 if options.flip else 1)
        lookups.append(Lookup(axis, axis, plan.positions, added))
    return lookups


def _records(text: str, file: str) -> dict[int, dict[int, str]]:
    """Return the values of each record by axis number; 0 where there is none.  Raises TableError."""
    body = text.strip()
    if not (body.startswith("%") and body.endswith("%") and len(body) > 1):
        raise TableError("this is not a punched file: it does not begin and end with %", _EXPECTED, file)
    found: dict[int, dict[int, str]] = {}
    for number, line in enumerate(text.splitlines(), 1):
        plain = line.strip()
        if not plain or plain.startswith("%") or not plain.startswith("N"):
            continue
        match = _RECORD.fullmatch(plain)
        if match is None:
            raise TableError(f"{plain[:40]!r} is not a record", _EXPECTED, file, number)
        found.setdefault(int(match[1]), {}).update({int(a or 0): v for a, v in _VALUE.findall(match[3])})
    return found


def _refuse_order(name: str, plan: Plan, file: str) -> None:
    if not plan.first <= plan.reference <= plan.last or plan.first == plan.last:
        what = f"{name} has points {plan.first} to {plan.last} and the reference point {plan.reference}"
        raise TableError(what, "the reference point lies between the others", file)


def _table(estimate: Estimate, name: str, plan: Plan) -> CompensationTable:
    axis = estimate.machine.index(name)
    low, high = estimate.box[axis]
    at = plan.positions
    if at[0] > low + plan.interval or at[-1] < high - plan.interval:
        shown = " to ".join(format_quantity(float(value), "mm") for value in (at[0], at[-1]))
        ends = np.floor(low / plan.interval), np.ceil(high / plan.interval)
        needed = [plan.reference + int(end) for end in ends]
        what = f"the points of {name} reach from {shown}, the volume goes beyond"
        raise TableError(what, f"3621 = {needed[0]} and 3622 = {needed[1]} would cover it")
    return own_table(estimate, axis, at)


def _flat(table: CompensationTable) -> CompensationTable:
    """Return the table without reversal, zero at the reference point."""
    mean = table.averaged().forward
    mean = mean - np.interp(0.0, table.positions, mean)
    return replace(table, forward=mean, reverse=mean)


def _notes(plans: Mapping[str, Plan]) -> tuple[str, ...]:
    parts = [f"{axis} from N{FIRST_DATA + plan.first} to N{FIRST_DATA + plan.last}" for axis, plan in plans.items()]
    return (
        f"Replaced in your file: {', '.join(parts)}. Everything else is as it was.",
        "Supposed: increment system IS-B (detection unit 0.001 mm), the reference point at machine zero, 3605#0 = 0.",
        "Power off and on, then return to the reference point. Check one point with a dial gauge, and export with "
        "--flip if the axis goes the wrong way.",
        "The control adds a step at each point where this program supposes a line between: up to half an entry more.",
    )
