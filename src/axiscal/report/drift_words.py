"""What the figures of a report take for granted of zeros that wander, in words."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.measurement.place_texts import reading_unit
from axiscal.measurement.setup import SaidOfDrift, Setup
from axiscal.units import to_unit

_HOUR, _MANY = 3600.0, 3
"""s; and names in a clause, a matter of taste."""


def drift_words(setups: Sequence[Setup]) -> list[str]:
    """Return clauses: which zeros wander as is usual, or as stated, and where it was said that nothing drifts."""
    if all(setup.drift_said == "denied" for setup in setups):
        return ["as if nothing drifted: you said that nothing drifts"]
    known: dict[SaidOfDrift, str] = {
        "usual": "with zeros that wander as is usual, {}",
        "stated": "with zeros that wander as stated, {}",
        "denied": "as if the zero of {} did not drift: you said that it does not",
    }
    found = []
    for said, words in known.items():
        mine = [setup for setup in setups if setup.drift_said == said]
        if mine:
            found.append(words.format(_named(mine) if said == "denied" else _rates(mine)))
    return found


def _named(setups: Sequence[Setup]) -> str:
    names = " and ".join(f'"{setup.name}"' for setup in setups)
    return names if len(setups) <= _MANY else f"{len(setups)} set-ups"


def _rates(setups: Sequence[Setup]) -> str:
    return " and ".join(dict.fromkeys(map(_rate, setups)))


def _rate(setup: Setup) -> str:
    unit = reading_unit(setup)
    return f"{to_unit(setup.drift * _HOUR, unit):.3g} {unit}/h"
