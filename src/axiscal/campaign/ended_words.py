"""Why a campaign has ended, in the language that is spoken; the record keeps it in English."""

from __future__ import annotations

import re

from axiscal.campaign.ending import BUDGET, DOES_NOT_FIT, NOT_VOUCHED, ONLY_STATED, OUT_OF_REACH
from axiscal.language.spoken import Said, counted, said

ENDINGS = (
    BUDGET,
    DOES_NOT_FIT,
    NOT_VOUCHED,
    ONLY_STATED,
    OUT_OF_REACH,
    "nothing is left to measure",
    "ended by the operator",
    "all readings evaluated",
    "not finished",
)
"""Those that are whole sentences."""
_TAKEN = re.compile(r"([0-9]+) readings? taken")
_REACHED = re.compile(r"(rms|worst|U) target reached")
_SEEN = re.compile(_REACHED.pattern + r" in what readings can tell; with what they cannot tell it is ([0-9.e+-]+) um")

_AS_SEEN = (
    "{name} target not reached: {size:.3g} um are left; no allowed reading can take away what is above the target"
)


def because_text(because: str) -> str:
    """Return the reason in the language that is spoken; one that is not known here stays English."""
    if (taken := _TAKEN.fullmatch(because)) is not None:
        return counted("{count} reading taken", "{count} readings taken", int(taken[1]))
    if (reached := _REACHED.fullmatch(because)) is not None:
        return said("{name} target reached", name=reached[1])
    if (seen := _SEEN.fullmatch(because)) is not None:
        return said(_AS_SEEN, name=seen[1], size=float(seen[2]))
    return said(because) if because in ENDINGS else because


def reached_as_seen(because: str) -> str:
    """Return which accuracy was reached in what readings can tell alone, "" where none was.  because : as it is said"""
    return str(because.values["name"]) if isinstance(because, Said) and because.forms == (_AS_SEEN,) else ""
