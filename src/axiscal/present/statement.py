"""The statement of uncertainty: what U holds for and what it is made of, so that a metrologist can redo it by hand.

u = √(Σ u_i²),    U = k u

Parts, u and k have a digit more than U, so that whoever redoes the sum finds U as it is printed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from axiscal.answers.answer import AnswerLine
from axiscal.answers.answer_words import AnswerText, answer_text
from axiscal.answers.row_words import row_names, signed_text
from axiscal.estimation.accuracy.expanded import BAND, LEVEL
from axiscal.estimation.case import Case
from axiscal.language.spoken import counted, later, listed, put, quoted, said
from axiscal.measurement.reading import reading_unit
from axiscal.measurement.setup import SaidOfDrift, Setup
from axiscal.present.result_set import RECORD
from axiscal.present.sentences import coordinate, figure, percent, quantity, root_mean_square, spelt
from axiscal.present.summary import WORTH, BudgetRow, ConstantSummary, CurveSummary, Summary, Uncertainty
from axiscal.present.volume_error import PlaneSummary
from axiscal.units import digits, said_quantity, to_unit

_PARTS = 4
"""Digits: one more than of U."""
_UNSEEN = 1e-6
"""Share of u² that changes none of them."""
_HOUR, _MANY = 3600.0, 3
"""s; and names in a clause, a matter of taste."""

_HEADINGS = (
    (later("row"), later("where"), later("read"), later("largest found"), later("known before"), later("at best")),
    (later("error"), later("code"), later("before, 95 %"), later("now, 95 %")),
    (later("source"), later("type"), later("distribution"), "u", later("share of u²")),
)
"""Of rows, errors and sources on a terminal."""

NOT_KNOWN = later("Not known: the readings contradict each other")


class Statement(NamedTuple):
    """Texts and cells: what U holds for, its figures, each source of u, their sum, each error, and each row.

    sources : in words, type A or B, distribution, u, share of u²
    errors : in words, code, ± before the first reading, ± now
    rows : row, where it holds, places read, found at most, ± before, ± at best
    """

    conditions: list[tuple[str, str]]
    figures: list[tuple[str, str]]
    sources: list[list[str]]
    sum: str
    errors: list[list[str]]
    rows: list[list[str]]

    @property
    def lines(self) -> Iterator[str]:
        """The statement for a terminal, a line for each, with units as terminals have them."""
        pairs = (f"{name}: {text}" for name, text in (*self.conditions, *self.figures))
        tables = zip(_HEADINGS, (self.rows, self.errors, self.sources), strict=True)
        each = (line for heading, lines in tables if lines for line in ([*map(said, heading)], *lines))
        cells = ("  ".join(part for part in line if part) for line in each)
        for line in (*pairs, *cells, *([self.sum] if self.sum else [])):
            yield line.replace("µ", "u").replace("\xa0", " ")


def statement(summary: Summary) -> Statement:
    """Return the statement in the language that is spoken; where uncertainty is withheld only what it is about."""
    found = summary.expanded
    conditions = [
        (said("Quantity"), said("length of the tool's deviation less the estimated one")),
        (said("Holds"), found.conditions.rpartition(" (")[0] or found.conditions),
        (said("Agreement"), summary.agreement_words),
        (said("Ended"), summary.stopped_because),
    ]
    named = [(name, spelt(text)) for name, text in conditions if text]
    if summary.answer.withheld:
        return Statement(named, [], [], "", [], [])
    constants = [each for each in summary.constants if ": " not in each.name]  # none of set-ups
    errors = [
        *(_error(each.caption, each, each.value_unit) for each in (*summary.curves, *summary.reversals)),
        *(_error(each.caption, each, each.value_unit) for each in summary.planes),
        *(_error(spelt(each.words), each, each.unit) for each in constants),
    ]
    total = _sum(summary) if summary.budget else ""
    return Statement(named, list(_figures(summary)), list(_sources(summary)), total, errors, list(_rows(summary)))


def _sources(summary: Summary) -> Iterator[list[str]]:
    """Yield each source of u, those too small for a row as one: their squares add up to u²."""
    yield from map(_source, summary.budget)
    share = (summary.smaller_um / summary.rms_um) ** 2 if summary.budget else 0.0
    if share > _UNSEEN:
        words = said("Other sources, each less than {most:.2%} of u²", most=WORTH)
        yield [spelt(words), "", "", quantity(summary.smaller_um, "um", _PARTS), percent(share)]


def _source(row: BudgetRow) -> list[str]:
    distribution = said(row.distribution) if row.distribution else ""
    return [spelt(row.words), row.kind, distribution, quantity(row.rms_um, "um", _PARTS), percent(row.share)]


def answered(summary: Summary) -> AnswerText:
    """Return the answer of a report in words."""
    record = RECORD if summary.record is None or summary.tables else summary.record.file  # with tables come copies
    signed = "" if summary.record is None else summary.record.signed
    return answer_text(summary.answer, summary.agreement_words, record, evidence=signed)


def _figures(summary: Summary) -> Iterator[tuple[str, str]]:
    """Yield each figure with its name."""
    found, where = summary.expanded, in_space(summary.expanded)
    yield said("Standard uncertainty u, RMS over the volume"), quantity(summary.rms_um, "um")
    yield said("the same at the worst place"), quantity(summary.worst_um, "um")
    k = said("{k}: {level:.0%} of all draws and places lie within k u", k=figure(found.factor), level=LEVEL)
    yield said("Factor k"), spelt(k)
    yield said("Expanded uncertainty U {where}", where=where), quantity(found.space, "um")
    for axis, value in found.ways:
        yield said("U along {way}", way=axis), put("± {size}", size=quantity(value, "um"))
    yield said("U {where}, worst place", where=where), quantity(found.worst, "um")
    if summary.unseen_rms_um > 0:
        yield said("part of u that stays open with any reading"), quantity(summary.unseen_rms_um, "um")
    if summary.nonlinearity is not None:
        yield said("largest second order of a reading over its noise"), figure(summary.nonlinearity)


def _sum(summary: Summary) -> str:
    """Return how u and U follow from the sources."""
    u, found = quantity(summary.rms_um, "um", _PARTS), summary.expanded
    words = "u = √(sum of squares) = {u}. U = k u = {k} · {u} = {expanded}."
    return said(words, u=u, k=figure(found.factor, _PARTS), expanded=quantity(found.space, "um"))


def _error(caption: str, error: CurveSummary | PlaneSummary | ConstantSummary, unit: str) -> list[str]:
    """Return an error with ± before measuring and now, 95 %, RMS over its positions."""
    return [
        caption,
        error.name,
        *(f"± {quantity(BAND * root_mean_square(std), unit)}" for std in (error.prior_std, error.std)),
    ]


def _rows(summary: Summary) -> Iterator[list[str]]:
    """Yield where each row holds, how it was read, and how well it was known and can be."""
    for row in summary.answer.rows:
        largest, before, best = (f"{digits(size)} {row.unit}" for size in (row.largest, row.known_before, row.floor))
        found, *sizes = map(spelt, (signed_text([row]) or largest, before, best))
        where = list[str]()
        for line in row.lines:
            low, high = map(coordinate, line.ends)
            along = said("{axis} {low} to {high}", axis=line.axis, low=low, high=high)
            others = ", ".join(f"{axis} {coordinate(value)}" for axis, value in line.at.items())
            where.append(said("{along} at {others}", along=along, others=others) if others else along)
        places = said(" and ").join(_places(line) for line in row.lines)
        if row.measured and row.lines and not any(line.read for line in row.lines):
            places = "–"  # readings of several numbers, or of several axes, are no places of a line
        yield [row_names([row]), "; ".join(where), places, found, *(f"± {size}" for size in sizes)]


def _places(line: AnswerLine) -> str:
    both = line.places["both"]
    if both:
        return counted("{count} place, {both} from both sides", "{count} places, {both} from both sides", line.read,
                       both=both)  # fmt: skip
    return counted("{count} place", "{count} places", line.read)


def conditions(case: Case) -> str:
    """Return what an expanded uncertainty holds for: tool, volume, temperature, and the errors that are described."""
    machine, setups = case.description.machine, case.description.setups
    volume = said("the part") if case.description.target.part is not None else said("the volume")
    if machine.only is not None and len(machine.axes) > 1:
        volume = said("the line of {axis} that was read", axis=machine.axes[machine.only].name)
    along = counted_along(case)
    alone = [] if along == "xyz" else [said("counted along {way} alone", way=listed(" ", list(along)))]
    at_20 = case.description.target.refers_to == "20 degC"
    warm = said("at 20 degC") if at_20 else said("as warm as when it was read")
    return counted(
        "for a tool of {tool}, over {volume}, {assumed}, of the one error that is described ({names})",
        "for a tool of {tool}, over {volume}, {assumed}, of the {count} errors that are described ({names})",
        len([each.name for each in machine.stated]),
        tool=said_quantity(machine.tool_length, "mm", 4),
        volume=volume,
        assumed=listed(", ", [*alone, warm, *drift_words(setups)]),
        names=" ".join([each.name for each in machine.stated]),
    )


def counted_along(case: Case) -> str:
    """Return the directions in which deviations of the tool point count, such as "xyz", or "z" of a bed."""
    return "".join(way for way, counts in zip("xyz", case.description.target.counted, strict=True) if counts)


def in_space(found: Uncertainty) -> str:
    """Return in words of which distance U is."""
    return said("in space") if found.along == "xyz" else said("along {way} alone", way=listed(" ", list(found.along)))


def drift_words(setups: Sequence[Setup]) -> list[str]:
    """Return clauses: which zeros wander as is usual, or as stated, and where it was said that nothing drifts."""
    if all(setup.drift_said == "denied" for setup in setups):
        return [said("as if nothing drifted: you said that nothing drifts")]
    known: dict[SaidOfDrift, str] = {
        "usual": later("with zeros that wander as is usual, {these}"),
        "stated": later("with zeros that wander as stated, {these}"),
        "denied": later("as if the zero of {these} did not drift: you said that it does not"),
    }
    found = []
    for kind, words in known.items():
        mine = [setup for setup in setups if setup.drift_said == kind]
        if mine:
            these = [quoted(setup.name) if kind == "denied" else _rate(setup) for setup in mine]
            many = kind == "denied" and len(mine) > _MANY
            named = said("{count} set-ups", count=len(mine)) if many else listed(said(" and "), [*dict.fromkeys(these)])
            found.append(said(words, these=named))
    return found


def _rate(setup: Setup) -> str:
    unit = reading_unit(setup)
    return put("{rate:.3g} {unit}/h", rate=float(to_unit(setup.drift * _HOUR, unit)), unit=unit)
