"""The first lines: how well the tool point is known, what for, and what the files for a control will reach of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from axiscal.accuracy.expanded import LEVEL
from axiscal.estimation.case import Case
from axiscal.language.spoken import counted, later, listed, resaid, said, spoken_now
from axiscal.report.drift_words import drift_words
from axiscal.report.promises import Uncertainty
from axiscal.report.sentences import figure, quantity, short
from axiscal.report.summary import Summary, TableEffect
from axiscal.units import said_quantity

NOT_KNOWN = later("Not known: the readings contradict each other")
_MANY = 12
"""Names in a sentence; a matter of taste."""


def conditions(case: Case) -> str:
    """Return what an expanded uncertainty holds for: tool, volume, temperature, and the errors that are described."""
    machine, setups = case.description.machine, case.description.setups
    volume = said("the part") if case.description.target.part is not None else said("the volume")
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


def expanded_words(summary: Summary) -> str:
    """Return in a sentence what U is, along which axes how much, and what for."""
    found = summary.expanded
    between = "; " if spoken_now() == "de" else ", "
    along = between.join(f"{axis} {figure(value)}" for axis, value in zip("xyz", found.axes, strict=True))
    named = errors_named(summary)
    linear = "".join(f" {line}" for line in linear_lines(summary))
    meant = found.conditions.replace(f" ({named})", "") if named else found.conditions
    what = said(
        "Expanded uncertainty, {level:.0%}, k = {k:.2f}, {conditions}", level=LEVEL, k=found.factor, conditions=meant
    )
    ways = said("Along {along}; in the worst place {worst}.", along=along, worst=quantity(found.worst, "um"))
    return f"{what.rstrip(', ')}. {ways}{linear}"


class Targets(NamedTuple):
    """What became of each target in words, "" of those that were not set."""

    u: str
    rms: str
    worst: str


def targets(summary: Summary) -> Targets:
    """Return whether the targets are reached by the figures that are printed: the same in every document."""
    return Targets(
        _target(summary, summary.expanded.space, summary.target_u_um),
        _target(summary, summary.rms_um, summary.target_rms_um),
        _target(summary, summary.worst_um, summary.target_worst_um),
    )


def _target(summary: Summary, value: float, wanted: float | None) -> str:
    """Return "target 5 um: reached".  value, wanted : um"""
    if wanted is None:
        return ""
    if summary.withheld or value > wanted:
        return said("target {size} um: not reached", size=short(wanted))
    return said("target {size} um: reached", size=short(wanted))


def target_lines(summary: Summary) -> Sequence[str]:
    """Return the targets in a line for a terminal; none where none was set."""
    found = targets(summary)
    named = (("U", found.u), (said("RMS"), found.rms), (said("worst place"), found.worst))
    text = "; ".join(f"{name}, {words}" for name, words in named if words)
    return [f"{text}."] if text else []


def standard_words(summary: Summary) -> str:
    """Return in a sentence the standard uncertainty with its targets."""
    found = targets(summary)
    rms, worst = (f" ({words})" if words else "" for words in (found.rms, found.worst))
    size = said("Standard uncertainty {size} RMS over the volume", size=quantity(summary.rms_um, "um"))
    place = said("{size} in the worst place", size=quantity(summary.worst_um, "um")) if worst else ""
    return f"{size}{rms}, {place}{worst}." if worst else f"{size}{rms}."


def errors_named(summary: Summary) -> str:
    """Return the errors for which U holds where there are so many that a sentence cannot hold them, else nothing."""
    names = summary.expanded.conditions.rpartition(" (")[2].removesuffix(")")
    return names if len(names.split()) > _MANY else ""


def table_lines(summary: Summary) -> Sequence[str]:
    """Return for each control what is to be expected with its files loaded."""
    if summary.withheld:
        return []
    effects = {offer.controller: offer.effect for offer in summary.tables if offer.effect is not None}
    return [effect_words(name, effect, summary.expanded.factor) for name, effect in effects.items()]


def linear_lines(summary: Summary) -> Sequence[str]:
    """Return how far the first order can be off."""
    return [] if summary.linear is None else [summary.linear.words]


def effect_words(controller: str, effect: TableEffect, factor: float) -> str:
    """Return what is to be expected with all files of a control loaded.  factor : k"""
    return said(
        "With the files for {controller} U = {expanded:.3g} um is to be expected: of {before:.3g} um RMS as estimated "
        "they leave {after:.3g} um.",
        controller=controller,
        expanded=factor * effect.expected,
        before=effect.before,
        after=effect.after,
    )


def first_lines(summary: Summary) -> str:
    """Return the same for a terminal, in the language that is spoken."""
    summary = resaid(summary)
    if summary.withheld:
        return "\n".join([said(NOT_KNOWN), *summary.agreement.sentences, *target_lines(summary)])
    found = summary.expanded
    x, y, z = found.axes
    known = said(
        "U = {space} um {where} ({level:.0%}, k = {k:.2f}), {conditions}.",
        where=in_space(found),
        space=figure(found.space),
        level=LEVEL,
        k=found.factor,
        conditions=found.conditions,
    )
    along = said(
        "Along x, y, z {x:.3g}, {y:.3g}, {z:.3g} um; worst place {worst:.3g} um. Standard uncertainty {rms:.3g} um "
        "RMS, {worst_rms:.3g} um in the worst place.",
        x=x,
        y=y,
        z=z,
        worst=found.worst,
        rms=summary.rms_um,
        worst_rms=summary.worst_um,
    )
    lines = [known, *target_lines(summary), along, *linear_lines(summary), *summary.agreement.sentences]
    return "\n".join([*lines, *table_lines(summary)])
