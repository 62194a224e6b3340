"""The statement of uncertainty: what U holds for and what it is made of, so that a metrologist can redo it by hand.

u = √(Σ u_i²),    U = k u

Parts, u and k have a digit more than U, so that whoever redoes the sum finds U as it is printed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from axiscal.estimation.accuracy.expanded import LEVEL
from axiscal.estimation.case import Case
from axiscal.language.spoken import counted, later, listed, put, quoted, said
from axiscal.measurement.reading import reading_unit
from axiscal.measurement.setup import SaidOfDrift, Setup
from axiscal.present.summary import WORTH, Summary, Uncertainty
from axiscal.units import said_quantity, to_unit

_PART, _SIZE, _SHARE = "{size:.4g} um", "{size:.3g} um", "{share:.1%}"
"""A part has a digit more than U."""
_UNSEEN = 1e-6
"""Share of u² that changes none of them."""
_HOUR, _MANY = 3600.0, 3
"""s; and names in a clause, a matter of taste."""

_HEADING = (later("source"), later("type"), later("distribution"), "u", later("share of u²"))

NOT_KNOWN = later("Not known: the readings contradict each other")


def statement(summary: Summary) -> Iterator[str]:
    """Yield the statement for a terminal, a line for each; where uncertainty is withheld only what it is about."""
    found = summary.expanded
    conditions = [
        (said("Quantity"), said("length of the tool's deviation less the estimated one")),
        (said("Holds"), found.conditions.rpartition(" (")[0] or found.conditions),
        (said("Agreement"), summary.agreement_words),
        (said("Ended"), summary.stopped_because),
    ]
    lines = [f"{name}: {text}" for name, text in conditions if text]
    if not summary.answer.withheld:
        lines += [f"{name}: {text}" for name, text in _figures(summary)]
    if summary.budget and not summary.answer.withheld:
        lines += ["  ".join(part for part in source if part) for source in (map(said, _HEADING), *_sources(summary))]
        lines.append(_sum(summary))
    yield from lines


def _sources(summary: Summary) -> Iterator[list[str]]:
    """Yield each source of u: in words, type A or B, distribution, u, share of u²; those without a row as one."""
    for row in summary.budget:
        yield [row.words, row.kind, row.distribution, put(_PART, size=row.rms_um), put(_SHARE, share=row.share)]
    share = (summary.smaller_um / summary.rms_um) ** 2
    if share > _UNSEEN:
        words = said("Other sources, each less than {most:.2%} of u²", most=WORTH)
        yield [words, "", "", put(_PART, size=summary.smaller_um), put(_SHARE, share=share)]


def _figures(summary: Summary) -> Iterator[tuple[str, str]]:
    """Yield each figure with its name."""
    found, where = summary.expanded, in_space(summary.expanded)
    yield said("Standard uncertainty u, RMS over the volume"), put(_SIZE, size=summary.rms_um)
    yield said("the same at the worst place"), put(_SIZE, size=summary.worst_um)
    k = "{k:.3g}: {level:.0%} of all draws and places lie within k u"
    yield said("Factor k"), said(k, k=found.factor, level=LEVEL)
    yield said("Expanded uncertainty U {where}", where=where), put(_SIZE, size=found.space)
    for axis, value in found.ways:
        yield said("U along {way}", way=axis), put("± {size:.3g} um", size=value)
    yield said("U {where}, worst place", where=where), put(_SIZE, size=found.worst)
    if summary.unseen_rms_um > 0:
        yield said("part of u that stays open with any reading"), put(_SIZE, size=summary.unseen_rms_um)
    if summary.nonlinearity is not None:
        yield said("largest second order of a reading over its noise"), put("{size:.3g}", size=summary.nonlinearity)


def _sum(summary: Summary) -> str:
    """Return how u and U follow from the sources."""
    found = summary.expanded
    words = "u = √(sum of squares) = {u:.4g} um. U = k u = {k:.4g} · {u:.4g} um = {expanded:.3g} um."
    return said(words, u=summary.rms_um, k=found.factor, expanded=found.space)


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
        len(machine.error_names),
        tool=said_quantity(machine.tool, "mm", 4),
        volume=volume,
        assumed=listed(", ", [*alone, warm, *drift_words(setups)]),
        names=" ".join(machine.error_names),
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
