"""The first lines: how well the tool point is known, what for, and what the files for a control will reach of it."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.accuracy.expanded import LEVEL
from axiscal.estimation.case import Case
from axiscal.report.drift_words import drift_words
from axiscal.report.sentences import figure, quantity
from axiscal.report.summary import Summary, TableEffect
from axiscal.units import format_quantity

_AS_GOOD = 1.02
"""A standard uncertainty that is larger by a fiftieth is printed alike."""
_MANY = 12
"""Names in a sentence; a matter of taste."""


def conditions(case: Case) -> str:
    """Return what an expanded uncertainty holds for: tool, volume, temperature, and the errors that are described."""
    machine, setups = case.description.machine, case.description.setups
    volume = "the part" if case.description.target.part is not None else "the volume"
    stated = any(setup.growth for setup in setups)
    warm = "at 20 degC where a set-up states its temperature" if stated else "as warm as when it was read"
    count, names = len(machine.error_names), " ".join(machine.error_names)
    tool = format_quantity(machine.tool, "mm", 4)
    assumed = "".join(f"{words}, " for words in drift_words(setups))
    return f"for a tool of {tool}, over {volume}, {warm}, {assumed}of the {count} errors that are described ({names})"


def expanded_words(summary: Summary) -> str:
    """Return in a sentence what U is, along which axes how much, and what for."""
    found = summary.expanded
    along = ", ".join(f"{axis} {figure(value)}" for axis, value in zip("xyz", found.axes, strict=True))
    named = errors_named(summary)
    linear = "".join(f" {line}" for line in linear_lines(summary))
    meant = found.conditions.replace(f" ({named})", "") if named else found.conditions
    what = f"Expanded uncertainty, {LEVEL:.0%}, k = {found.k:.2f}, {meant}".rstrip(", ")
    mixed = "".join(f" {line}".replace(" um", "\u00a0µm") for line in mixed_lines(summary))
    return f"{what}. Along {along}; in the worst place {quantity(found.worst, 'um')}.{mixed}{linear}"


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


def mixed_lines(summary: Summary) -> Sequence[str]:
    """Return the standard uncertainty that U is of, where that is more than the model's."""
    standard = summary.expanded.standard
    if standard is None or standard <= _AS_GOOD * summary.rms_um:
        return []
    mixed = f"U is of a standard uncertainty of {standard:.3g} um RMS"
    return [f"{mixed}: what else could explain the readings counts in it; the model alone promises the other."]


def checked_lines(summary: Summary) -> Sequence[str]:
    """Return what check readings say of the promise."""
    return [] if summary.checks is None else [summary.checks.words]


def linear_lines(summary: Summary) -> Sequence[str]:
    """Return how far the first order can be off."""
    return [] if summary.linear is None else [summary.linear.words]


def effect_words(controller: str, effect: TableEffect, factor: float) -> str:
    """Return what is to be expected with all files of a control loaded.  factor : k"""
    expanded, before, after = (f"{each:.3g} um" for each in (factor * effect.expected, effect.before, effect.after))
    expected = f"With the files for {controller} U = {expanded} is to be expected"
    return f"{expected}: of {before} RMS as estimated they leave {after}."


def first_lines(summary: Summary) -> str:
    """Return the same for a terminal."""
    if summary.withheld:
        return summary.verdict_words
    found = summary.expanded
    lines = [
        f"U = {found.space:.3g} um in space ({LEVEL:.0%}, k = {found.k:.2f}), {found.conditions}.",
        f"Along x, y, z {', '.join(f'{each:.3g}' for each in found.axes)} um; worst place {found.worst:.3g} um. "
        f"Standard uncertainty {summary.rms_um:.3g} um RMS, {summary.worst_um:.3g} um in the worst place."
        + "".join(f" {line}" for line in mixed_lines(summary)),
    ]
    said = [*linear_lines(summary), summary.verdict_words, *checked_lines(summary), summary.vouched.words]
    return "\n".join([*lines, *said, *table_lines(summary)])
