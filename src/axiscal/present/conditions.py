"""What an expanded uncertainty holds for, in words."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.estimation.case import Case
from axiscal.language.spoken import WORDS, counted, later, listed, put, quoted, said
from axiscal.measurement.reading import reading_unit
from axiscal.measurement.setup import Setup
from axiscal.units import said_quantity, to_unit

_HOUR, _MANY = 3600.0, 3
"""s; and names in a clause, a matter of taste."""

NOT_KNOWN = later("Not known: the readings contradict each other")


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
        len(machine.stated),
        tool=said_quantity(machine.tool_length, "mm", 4),
        volume=volume,
        assumed=listed(", ", [*alone, warm, *drift_words(setups)]),
        names=" ".join(error.name for error in machine.stated),
    )


def counted_along(case: Case) -> str:
    """Return the directions in which deviations of the tool point count, such as "xyz", or "z" of a bed."""
    return "".join(way for way, counts in zip("xyz", case.description.target.counted, strict=True) if counts)


def drift_words(setups: Sequence[Setup]) -> list[str]:
    """Return clauses: which zeros wander as is usual, or as stated, and where it was said that nothing drifts."""
    if all(setup.drift_said == "denied" for setup in setups):
        return [said("as if nothing drifted: you said that nothing drifts")]
    found = []
    for kind, words in WORDS["drift"].items():
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
