"""Pitch data of a FANUC: all axes, in the place of those of a punched file."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.language.spoken import later, said
from axiscal.numerics import Array
from axiscal.tables.exporter import ExportOptions, TableFormat, Written, paragraphs, sign_said
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.sampling import backlash, own_table
from axiscal.tables.table import CompensationTable
from axiscal.units import format_quantity, shortened
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

_EXPECTED = later(
    "punch parameters and pitch data from the control: records like N10000P0; between % and %, with N3620 to N3624 for "
    "each axis as N3620A1P100A2P200;"
)
_RECORD = re.compile(
    r"\s*N0*(\d{1,9})(?:Q\d+)?((?:(?:[A-Z]\d{0,9})?P-?[\d.]{1,20})(?:[A-Z]\d{0,9}P-?[\d.]{1,20})*)\s*;?\s*"
)
_VALUE = re.compile(r"(?:A(\d+))?P(-?[\d.]+)")

DETECTION = {False: 1e-6, True: math.radians(1e-3)}
"""Detection unit of increment system IS-B: of a linear axis, m, of a rotary one, rad."""
_BOTH, _NEGATIVE = 3605, 3626
"""Numbers of the parameters by which a control takes another set of entries for travel downwards."""
_NEEDED = range(3620, 3625)
"""By FANUC's manual: the parameters that say which points an axis has."""
_WIDEST = 1000.0
"""m or rad, of an interval: longer than any travel, so that any near would do."""
_MOST = 9999
"""Of a number of a point: those beyond have no entry, since 10000 and it name one."""
_LARGEST, _FIRST_DATA = 7, 10000
"""By FANUC's manual: an entry is a digit with its sign, -7 to +7; the number of the first point's entry."""
_FILE = "pitch.txt"
_SIGN = "the parameter manual B-63980EN, 3620 to 3624, states the points of entries and not their sign"
_WITHOUT = "{} (3624 is 0, no parameters 3620 to 3624 in the file, or a whole turn that does not begin at 0), "


class Punched:
    """A punched file and where in its text each value stands, by the record's number and the axis', 0 without one.

    Raises TableError for what a control does not punch.
    """

    def __init__(self, text: str, file: str) -> None:
        self._text, self.file, self._spans = text, file, dict[tuple[int, int], tuple[int, int]]()
        if not re.fullmatch(r"%.*%", text.strip(), re.DOTALL):
            raise TableError("this is not a punched file: it does not begin and end with %", _EXPECTED, file)
        for line in re.finditer(r"^[ \t]*N.*$", text, re.MULTILINE):
            if (record := _RECORD.fullmatch(text, *line.span())) is None:
                number, shown = text.count("\n", 0, line.start()) + 1, line[0].strip()[:40]
                raise TableError("{text!r} is not a record", _EXPECTED, file, number, text=shown)
            for value in _VALUE.finditer(text, *record.span(2)):
                self._spans[int(record[1]), int(value[1] or 0)] = value.span(2)

    def value(self, record: int, axis: int = 0) -> str | None:
        """Return a value as it stands there, None where there is none."""
        span = self._spans.get((record, axis))
        return None if span is None else self._text[slice(*span)]

    def entries(self, records: Iterable[int]) -> list[float]:
        """Return the values of records without an axis; raises TableError for one that is not there."""
        found = {record: self.value(record) for record in records}
        if missing := [record for record, value in found.items() if value is None]:
            raise TableError("there is no row N{row}", _EXPECTED, self.file, row=missing[0])
        return [float(value or 0) for value in found.values()]

    def filled(self, wanted: Mapping[int, int]) -> str:
        """Return the text with other values of records without an axis; raises TableError as `entries`."""
        self.entries(sorted(wanted))
        text = self._text
        for (start, stop), value in sorted(((self._spans[row, 0], new) for row, new in wanted.items()), reverse=True):
            text = f"{text[:start]}{value}{text[stop:]}"
        return text


@dataclass(frozen=True, slots=True)
class PitchParameters:
    """The points of one axis.

    reference, first, last : numbers of points; magnification : multiplies each entry; interval : m or rad
    rotary : its coordinate is an angle; turn : it is a whole turn, whose end is its beginning

    A point holds the section that ends at it: the first one begins an interval below it (B-63980EN, parameter 3620). On
    a whole turn the first point is the reference point and has the same value as the last one.
    """

    reference: int
    first: int
    last: int
    magnification: int
    interval: float
    rotary: bool
    turn: bool

    @property
    def begin(self) -> int:
        """Number of the point at which the first section begins."""
        return self.first if self.turn else self.first - 1

    @property
    def records(self) -> range:
        """The records of the entries of all sections."""
        return range(_FIRST_DATA + self.begin + 1, _FIRST_DATA + self.last + 1)

    @property
    def positions(self) -> Array:
        """The ends of the sections and the first beginning, m or rad; the reference point is the machine's zero."""
        return (np.arange(self.begin, self.last + 1, dtype=float) - self.reference) * self.interval

    @property
    def step(self) -> float:
        """The motion that an entry of 1 makes, m or rad."""
        return self.magnification * DETECTION[self.rotary]

    def from_reference(self, values: Array) -> Array:
        """Return values at the positions less that at the reference point."""
        less: Array = values - values[self.reference - self.begin]
        return less

    def covering(self, low: float, high: float) -> tuple[int, int]:
        """Return the numbers of the first and last point that a travel needs, by FANUC's formula."""
        if self.turn:
            return self.reference, self.reference + round(math.tau / self.interval)
        below, above = np.floor(low / self.interval + 1e-6), np.ceil(high / self.interval - 1e-6)
        return self.reference + int(below) + 1, self.reference + int(above)


def _plans(punched: Punched, machine: Machine, numbers: Mapping[str, int]) -> dict[str, PitchParameters]:
    """Return what the parameters say; axes without a positive interval are left out.

    So are rotary axes without parameters, and whole turns that do not begin at zero.
    numbers : of the controlled axes by name.  Raises TableError.
    """
    plans, owner = dict[str, PitchParameters](), dict[int, str]()
    for name, number in numbers.items():
        axis = machine.axis(name)
        from_zero = not axis.cyclic or abs(axis.travel[0]) < DETECTION[True]
        has = from_zero and all(punched.value(key, number) for key in _NEEDED)
        if (not axis.rotary or has) and (plan := _plan(punched, axis, number)) is not None:
            plans[name] = plan
    if not plans:
        raise TableError("no axis has an interval of compensation (3624)", "set it on the control first", punched.file)
    for name, plan in plans.items():
        for point in range(plan.first, plan.last + 1):
            if (other := owner.setdefault(point, name)) != name:
                what = "point {number} belongs to {other} and to {name}"
                remedy = "give each axis points of its own: 3620 to 3622"
                raise TableError(what, remedy, punched.file, number=point, other=other, name=name)
    return plans


def _plan(punched: Punched, axis: Axis, number: int) -> PitchParameters | None:
    """Return the points of an axis, None without an interval; raises TableError."""
    values = {key: punched.value(key, number) for key in _NEEDED}
    told: dict[str, Any] = {"name": axis.name, "number": number}
    if missing := ", ".join(str(key) for key, value in values.items() if value is None):
        what = "there are no parameters {shown} for {name} (axis {number})"
        raise TableError(what, _EXPECTED, punched.file, shown=missing, **told)
    reference, first, last, magnification, interval = (value or "0" for value in values.values())
    width = float(interval) * DETECTION[axis.rotary] * (1e3 if "." in interval else 1.0)
    if width <= 0:
        return None
    at, begin, end, times = (min(int(each), _MOST + 1) for each in (reference, first, last, magnification))
    plan = PitchParameters(at, begin, end, max(1, times), width, axis.rotary, axis.cyclic)
    low, high = plan.covering(0.0, math.tau)
    whole = abs((high - low) * width - math.tau) < DETECTION[True] and (begin, end) == (low, high)
    inside = plan.begin <= at <= end and begin != end and begin >= 0
    if (punched.value(_NEGATIVE, number) or "").strip("0+-") and (punched.value(_BOTH, number) or "1").endswith("1"):
        what = "{name} (axis {number}) has entries of its own for the way down (3626)"
        remedy = "set 3605#0 to 0, so that one set serves both ways, and enter the reversal as backlash (1851)"
    elif not inside or max(end, times) > _MOST or width > _WIDEST:
        what = "{name} has points {first} to {last}, reference {reference}, magnification {times}, interval {interval}"
        remedy = "the reference point lies between the others, none is above {most}, and 3624 with a point is mm or deg"
    elif plan.turn and not whole:  # B-63980EN: 3621 = 3620, a turn further
        what = "{name} is a whole turn and has points {first} to {last}"
        remedy = "3621 = 3620 = {low} and 3622 = {high} hold a turn, with an interval that divides 360 deg"
    else:
        return plan
    texts = {"first": first, "last": last, "reference": reference, "times": magnification, "interval": interval}
    told |= {"most": _MOST, "low": low, "high": high} | {key: shortened(text) for key, text in texts.items()}
    raise TableError(what, remedy, punched.file, **told)


class Fanuc(TableFormat):
    """Pitch data in the place of those of a punched file."""

    takes = frozenset({"--template", "--number"})
    unstated = "own"

    def make(self, estimate: Estimate, options: ExportOptions) -> Written:
        """Return the file, with what to enter as backlash; raises TableError."""
        draft, rotary = super().make(estimate, options), {axis.name: axis.rotary for axis in estimate.machine.axes}
        units = {name: round(lost / DETECTION[rotary[name]]) for name, lost in backlash(estimate).items()}
        shown = ", ".join(f"{name} {count:+d}" for name, count in units.items() if count)
        note = (
            f"The file holds no reversal. Add to parameter 1851 (backlash): {shown}, in 0.001 mm or 0.001 deg. It is "
            "positive where an axis stops short after it has turned round."
        )
        return replace(draft, notes=(*draft.notes, note)) if shown else draft

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return the deviation at the points of the template: one for both ways, nothing at the reference point.

        Raises TableError where they do not cover the volume.
        """
        tables = []
        for name, plan in _template(options, estimate.machine)[1].items():
            axis = estimate.machine.index(name)
            needed = plan.covering(*estimate.box[axis])
            if plan.first > needed[0] or plan.last < needed[1]:
                low, high = (
                    format_quantity(float(end), "deg" if plan.rotary else "mm") for end in plan.positions[[0, -1]]
                )
                what = "the points of {name} reach from {shown}, the volume goes beyond"
                remedy = "3621 = {first} and 3622 = {second} would cover it"
                shown = said("{low} to {high}", low=low, high=high)
                raise TableError(what, remedy, name=name, shown=shown, first=needed[0], second=needed[1])
            table = own_table(estimate, axis, plan.positions).averaged()
            values = plan.from_reference(table.forward)
            tables.append(replace(table, forward=values, reverse=values))
        return tuple(tables)

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return the template with its pitch data replaced; raises TableError for entries that are too large.

        The sums of the entries are rounded, so that nothing adds up.
        """
        (punched, plans), wanted = _template(options, machine), dict[int, int]()
        for table, plan in ((table, plans[table.axis]) for table in tables):
            entries: Array = np.diff(np.round(plan.from_reference(-table.forward) / plan.step).astype(int))
            if (worst := int(np.max(np.abs(entries)))) > _LARGEST:
                what = "{axis} needs an increment of {worst}, an entry holds {most}"
                remedy = "magnification 3623 = {needed} would fit, or a shorter interval 3624"
                needed = math.ceil(worst * plan.magnification / _LARGEST)
                raise TableError(what, remedy, axis=table.axis, worst=worst, most=_LARGEST, needed=needed)
            wanted |= zip(plan.records, (options.sign * entries).tolist(), strict=True)
            wanted[_FIRST_DATA + plan.first] = wanted[plan.records[-1 if plan.turn else 0]]
        steps = {axis: 0.5 * plan.step + 1e-12 for axis, plan in plans.items()}
        without = ", ".join(axis.name for axis in machine.axes if axis.name not in plans)
        holds = f"the positioning error of axes as increments: the mean of both directions of {', '.join(plans)}."
        left_out = "straightness, squareness and the angular errors of linear axes, and the reversal."
        left_out = f"{_WITHOUT.format(without) if without else ''}{left_out}"
        notes = paragraphs("axiscal.tables", "fanuc.jinja", plans=plans, first_data=_FIRST_DATA)
        return Written({_FILE: punched.filled(wanted)}, steps, notes, holds, left_out, sign_said(options, _SIGN))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the control makes of punched files; raises TableError.

        Entries add up from the reference point, times the magnification.
        """
        tables = list[CompensationTable]()
        for punched in (Punched(file.text, file.name) for file in files):
            for name, plan in _plans(punched, machine, options.numbered(machine)).items():
                sums = np.cumsum([0.0, *punched.entries(plan.records)])
                values = -options.sign * plan.from_reference(sums) * plan.step
                tables.append(CompensationTable(name, plan.positions, values, values))
        return Loaded(tuple(tables))


def _template(options: ExportOptions, machine: Machine) -> tuple[Punched, dict[str, PitchParameters]]:
    """Return the template and what its parameters say; raises TableError where there is none."""
    punched = Punched(options.saved("FANUC"), options.template_name)
    return punched, _plans(punched, machine, options.numbered(machine))
