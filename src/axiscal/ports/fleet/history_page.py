"""The machines of a shop over the years, and as a page: what campaigns found, how far off tables were between them.

What was renewed stands between.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from axiscal.errors.iso230 import words
from axiscal.errors.model import ErrorFunction
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.estimation import Estimation
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from axiscal.ports.fleet.due_dates import DueMachine, Shop, moment
from axiscal.ports.fleet.sister_records import MachineRecord, renewed_axes
from axiscal.ports.fleet.worn_machine import WornMachine
from axiscal.present.drawing.shown import shown
from axiscal.present.drawing.svg_picture import Figure
from axiscal.present.figures import axis_style, layout, line_trace, mark_trace
from axiscal.present.standalone import page_of
from axiscal.present.standard import iso230_blocks
from axiscal.units import to_unit

_HEIGHT, _WIDE_HEIGHT = 200, 300
"""Pixels; a matter of taste."""
_ISO = {"A": "var(--worst)", "E": "var(--accent)", "M": "var(--soft)"}
"""Figures of ISO 230-2 that are drawn, and how."""


@dataclass(frozen=True, slots=True)
class YearSpan:
    """Years that a machine's pictures have in common."""

    first: float
    last: float

    @property
    def axis(self) -> Figure:
        """The abscissa."""
        room = max(0.02 * (self.last - self.first), 0.01)
        return axis_style("year", range=[self.first - room, self.last + room])


def render(shop: Shop, machines: Sequence[MachineHistory]) -> str:
    """Return the page as self-contained HTML."""
    return page_of(
        "axiscal.ports.fleet",
        "history.html",
        title="Machines over the years",
        machines=[_machine(each) for each in machines],
        left_out=[{"file": each.file, "why": each.left_out} for each in shop.left_out],
        kept=_kept(shop),
    )


def _kept(shop: Shop) -> str:
    (once, once_std), (year, year_std) = shop.aging.at_once, shop.aging.yearly
    pairs = shop.aging.pairs
    source = f"learnt from machines measured again ({pairs})" if pairs else "assumed: no machine was measured again"
    return f"Kept at once {once:.2f} ± {once_std:.2f}, and in a year {year:.2f} ± {year_std:.2f} of it: {source}."


def _machine(of: MachineHistory) -> dict[str, object]:
    span = YearSpan(float(of.left[0][0, 0]), float(of.left[-1][-1, 0]))
    panels = [(_named(each), parameter_picture(each, of, span)) for each in of.parameters]
    panels += _iso_panels(of, span)
    due = "not due within 20 years" if of.due.due is None else f"due on {of.due.due.isoformat()}"
    return {
        "name": of.due.name,
        "due": due,
        "now": f"{to_unit(of.due.now, 'um'):.3g} µm",
        "target": "-" if of.due.target is None else f"{to_unit(of.due.target, 'um'):.3g} µm",
        "left": shown(left_picture(of, span), f"{of.due.name}: what is left with its tables, year by year"),
        "panels": [{"title": title, "svg": shown(drawn, title)} for title, drawn in panels],
        "rows": _rows(of),
    }


def _rows(of: MachineHistory) -> list[dict[str, str]]:
    """Return what happened to a machine, campaigns and notes, in the order of time."""
    found = [(record.begun, record.file.name, str(len(record.readings))) for record in of.records]
    found += [(note.at, note.text, "") for record in of.records for note in record.notes]
    return [
        {"day": moment(at).date().isoformat(), "what": what, "readings": readings}
        for at, what, readings in sorted(found, key=lambda row: moment(row[0]))
    ]


def _named(parameter: Parameter) -> str:
    what = "highest less lowest" if parameter.spans else "value"
    return f"{parameter.name}: {words(parameter.name)}, {what}"


def left_picture(of: MachineHistory, span: YearSpan) -> Figure:
    """Return RMS of what is left over the years: campaigns as marks, the target dashed, renewals dotted upright."""
    pieces = [[(year, to_unit(rms, "um")) for year, rms in piece.tolist()] for piece in of.left]
    targets = [] if of.due.target is None else [to_unit(of.due.target, "um")]
    top = 1.1 * max([*targets, *(value for piece in pieces for _, value in piece)])
    data = [line_trace([span.first, span.last], [each, each], "var(--truth)", 1.4, "dash") for each in targets]
    data += _uprights(of, 0.0, top)
    data += [line_trace([x for x, _ in piece], [y for _, y in piece], "var(--accent)", 2.2) for piece in pieces]
    starts = {year_of(moment(record.begun)) for record in of.records}
    marks = [piece[0] for piece in pieces if piece[0][0] in starts]
    data.append(mark_trace([x for x, _ in marks], [y for _, y in marks], "var(--accent)", 7))
    y = axis_style("RMS with its tables, µm", range=[0.0, top])
    return {"data": data, "layout": layout(span.axis, y, _WIDE_HEIGHT), "wide": True}


def parameter_picture(parameter: Parameter, of: MachineHistory, span: YearSpan) -> Figure:
    """Return one error over the years: means with 95 % whiskers, renewals dotted upright."""
    unit = "urad" if parameter.angular else "um"
    x = [each.year for each in parameter.found]
    mean, reach = (
        [to_unit(value, unit) for value in values]
        for values in ([each.mean for each in parameter.found], [BAND * each.std for each in parameter.found])
    )
    low = min(m - r for m, r in zip(mean, reach, strict=True))
    high = max(m + r for m, r in zip(mean, reach, strict=True))
    room = 0.08 * max(high - low, 1e-3)
    data = _uprights(of, low - room, high + room)
    data += [
        line_trace([at, at], [m - r, m + r], "var(--accent)", 1.2) for at, m, r in zip(x, mean, reach, strict=True)
    ]
    data += [line_trace(x, mean, "var(--accent)", 1.0, "dot"), mark_trace(x, mean, "var(--accent)", 7)]
    y = axis_style(unit.replace("u", "µ", 1), range=[low - room, high + room])
    return {"data": data, "layout": layout(span.axis, y, _HEIGHT)}


def _iso_panels(of: MachineHistory, span: YearSpan) -> list[tuple[str, Figure]]:
    """Return the figures of ISO 230-2 over the years, of axes whose readings are such a test."""
    found = dict[tuple[str, str], dict[str, list[tuple[float, float]]]]()
    for record in of.records:
        for block in iso230_blocks(record.description, record.readings):
            figures = found.setdefault((block.axis, block.value_unit), {})
            for name in _ISO:
                value = block.figures.get(name)
                if value is not None:
                    figures.setdefault(name, []).append((year_of(moment(record.begun)), value))
    return [
        (f"{axis}: ISO 230-2, {', '.join(figures)} from the top", _iso_picture(figures, unit, of, span))
        for (axis, unit), figures in found.items()
        if figures
    ]


def _iso_picture(
    figures: dict[str, list[tuple[float, float]]], unit: str, of: MachineHistory, span: YearSpan
) -> Figure:
    top = 1.1 * max(value for points in figures.values() for _, value in points)
    data = _uprights(of, 0.0, top)
    for name, points in figures.items():
        x, y = [at for at, _ in points], [value for _, value in points]
        data += [line_trace(x, y, _ISO[name], 1.4), mark_trace(x, y, _ISO[name], 7)]
    axis = axis_style(unit.replace("um", "µm"), range=[0.0, top])
    return {"data": data, "layout": layout(span.axis, axis, _HEIGHT)}


def _uprights(of: MachineHistory, low: float, high: float) -> list[Figure]:
    return [
        line_trace([each.year, each.year], [low, high], "var(--worst)", 1.2, "dot")
        for each in of.happened
        if each.renewed
    ]


_STEPS, _PLACES = 40, 61
"""Points of a curve between two campaigns, and of an error along its axis; a matter of taste."""
_AHEAD = 0.25
"""Years that are drawn beyond the day on which a machine is due; a matter of taste."""
_FAR = 2.0
"""Years that are drawn beyond today where it is never due."""


@dataclass(frozen=True, slots=True)
class Found:
    """One figure of an error in one campaign: its year, such as 2026.4, mean and standard deviation, m or rad."""

    year: float
    mean: float
    std: float


@dataclass(frozen=True, slots=True)
class Parameter:
    """Estimates of one error, campaign by campaign.

    spans : the figure is the range of a curve, its highest less its lowest value; else the value of a constant
    """

    name: str
    angular: bool
    spans: bool
    found: tuple[Found, ...]


@dataclass(frozen=True, slots=True)
class Happened:
    """What a person noted: when, what, and which axes were renewed."""

    year: float
    text: str
    renewed: tuple[str, ...]


@dataclass(frozen=True, eq=False, slots=True)
class MachineHistory:
    """A machine over the years.

    due : as `axiscal due` has it; records : in the order of time
    left : pieces of (year, RMS of what is left with the tables of the last campaign, m), (k, 2) each
    """

    due: DueMachine
    records: tuple[MachineRecord, ...]
    parameters: tuple[Parameter, ...]
    happened: tuple[Happened, ...]
    left: tuple[Array, ...]


@one_thread()
def histories(shop: Shop, today: datetime) -> tuple[MachineHistory, ...]:
    """Return the history of each machine of a shop, those first that are due first."""
    return tuple(_history(machine, shop, today) for machine in shop.machines)


def year_of(at: datetime) -> float:
    """Return a time as a year with its fraction."""
    begin = datetime(at.year, 1, 1, tzinfo=UTC)
    length = datetime(at.year + 1, 1, 1, tzinfo=UTC) - begin
    return float(at.year + (at.astimezone(UTC) - begin) / length)


def _history(machine: DueMachine, shop: Shop, today: datetime) -> MachineHistory:
    records = tuple(shop.histories[machine.digest])
    happened = tuple(
        Happened(year_of(moment(note.at)), note.text, renewed_axes([note.text]))
        for record in records
        for note in record.notes
    )
    begun = [year_of(moment(record.begun)) for record in records]
    until = max(year_of(today), begun[-1]) + _FAR
    if machine.due is not None:
        until = max(year_of(datetime(*machine.due.timetuple()[:3], tzinfo=UTC)) + _AHEAD, year_of(today))
    pieces = list[Array]()
    for record, start, end in zip(records, begun, [*begun[1:], until], strict=True):
        pieces += _left(record, shop, start, end)
    return MachineHistory(machine, records, _parameters(records, shop, begun), happened, tuple(pieces))


def _left(record: MachineRecord, shop: Shop, start: float, end: float) -> list[Array]:
    """Return what is left with the tables of a campaign until the next one, in a piece for each renewal."""
    later = [note for note in record.notes if note.after >= len(record.readings) and renewed_axes([note.text])]
    turns = [(start, list[str]())]
    for note in later:
        turns.append((max(start, year_of(moment(note.at))), [*turns[-1][1], note.text]))
    ends = [at for at, _ in turns[1:]] + [end]
    pieces = list[Array]()
    for (begin, texts), stop in zip(turns, ends, strict=True):
        machine = WornMachine(shop.known[record.digest], shop.aging, renewed_axes(texts))
        years = np.linspace(begin, min(max(stop, begin), end), _STEPS)
        pieces.append(np.array([[year, machine.rms(year - start)] for year in years.tolist()]))
    return pieces


def _parameters(records: Sequence[MachineRecord], shop: Shop, begun: Sequence[float]) -> tuple[Parameter, ...]:
    found = dict[str, tuple[ErrorFunction, list[Found]]]()
    for record, year in zip(records, begun, strict=True):
        known = shop.known[record.digest]
        for name, function in known.case.errors.names.items():
            mean, std = _figure(known, function)
            found.setdefault(name, (function, []))[1].append(Found(year, mean, std))
    return tuple(
        Parameter(name, function.angular, function.basis.size > 1, tuple(each))
        for name, (function, each) in found.items()
    )


def _figure(known: Estimation, function: ErrorFunction) -> tuple[float, float]:
    """Return the value of a constant, or the range of a curve, with its standard deviation where it was found."""
    belief = known.printed.belief
    mean, factor = belief.mean[function.columns], belief.factor[function.columns]
    if function.basis.size == 1:
        row = function.rows(np.zeros(1))[0]
    else:
        low, high = (float(function.basis.knots[end]) for end in (0, -1))
        rows = function.rows(np.linspace(low, high, _PLACES))
        curve = rows @ mean
        row = rows[int(np.argmax(curve))] - rows[int(np.argmin(curve))]
    return float(row @ mean), float(np.linalg.norm(row @ factor))
