"""As found and as left side by side, and what a page says once of many files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.language.spoken import later, said
from axiscal.report.headline import in_space
from axiscal.report.sentences import quantity
from axiscal.report.summary import Summary, TableEffect, TableOffer

_UNKNOWN = later("not known")


@dataclass(frozen=True, slots=True)
class FoundAndLeft:
    """One figure of the tool point as found, and as left by the tables of each control."""

    words: str
    found: str
    left: Sequence[str]


@dataclass(frozen=True, slots=True)
class FilesOfControl:
    """The files of one control, and what they leave, in a sentence."""

    controller: str
    sentence: str
    files: Sequence[str]


def effects(summary: Summary) -> dict[str, TableEffect]:
    """Return what the files of each control do."""
    return {offer.controller: offer.effect for offer in summary.tables if offer.effect is not None}


def sides(summary: Summary) -> list[FoundAndLeft]:
    """Return the figures as found and as left; none where no table was written."""
    found, known = effects(summary), not summary.withheld
    if not found:
        return []
    expanded, factor, unknown = summary.expanded, summary.expanded.factor, said(_UNKNOWN)
    before = next(quantity(each.before, "um") for each in found.values())
    return [
        FoundAndLeft(said("Error of the tool point as estimated, RMS over the volume"), before,
             [quantity(each.after, "um") for each in found.values()]),
        FoundAndLeft(said("Standard uncertainty, what is left included, RMS"), quantity(summary.rms_um, "um"),
             [quantity(each.expected, "um") for each in found.values()]),
        FoundAndLeft(said("U {where}, 95 %, what is left included", where=in_space(expanded)),
             quantity(expanded.space, "um") if known else unknown,
             [quantity(factor * each.expected, "um") if known else unknown for each in found.values()]),
    ]  # fmt: skip


def axis_rows(summary: Summary) -> list[tuple[str, str]]:
    """Return U along each axis, in space, and at the worst place."""
    if summary.withheld:
        return []
    found = summary.expanded
    along = [
        (said("along {way}", way=name), quantity(value, "um")) for name, value in zip("xyz", found.axes, strict=True)
    ]
    space, worst = quantity(found.space, "um"), quantity(found.worst, "um")
    where = in_space(found)
    return [*along, (where, space), (said("{where}, worst place", where=where), worst)]


def files_of_controls(offers: Sequence[TableOffer]) -> list[FilesOfControl]:
    """Return the files of each control under one sentence."""
    found: dict[tuple[str, str], list[str]] = {}
    for offer in offers:
        found.setdefault((offer.controller, offer.left_out), []).append(offer.file)
    return [FilesOfControl(name, left or said("They leave nothing."), files) for (name, left), files in found.items()]
