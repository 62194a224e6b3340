"""What the figures of a report take for granted of zeros that wander, in words."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.language.spoken import later, listed, put, said
from axiscal.measurement.place_texts import reading_unit
from axiscal.measurement.setup import SaidOfDrift, Setup
from axiscal.units import to_unit

_HOUR, _MANY = 3600.0, 3
"""s; and names in a clause, a matter of taste."""


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
            found.append(said(words, these=_named(mine) if kind == "denied" else _rates(mine)))
    return found


def _named(setups: Sequence[Setup]) -> str:
    if len(setups) > _MANY:
        return said("{count} set-ups", count=len(setups))
    return listed(said(" and "), [f'"{setup.name}"' for setup in setups])


def _rates(setups: Sequence[Setup]) -> str:
    return listed(said(" and "), list(dict.fromkeys(map(_rate, setups))))


def _rate(setup: Setup) -> str:
    unit = reading_unit(setup)
    return put("{rate:.3g} {unit}/h", rate=float(to_unit(setup.drift * _HOUR, unit)), unit=unit)
