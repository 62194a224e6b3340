"""Why a campaign has ended, in the language that is spoken; the record keeps it in English."""

from __future__ import annotations

import re

from axiscal.campaign.ending import ALL_REACHED, BUDGET, CONTRADICT, OUT_OF_REACH
from axiscal.language.spoken import counted, said

ENDINGS = (
    ALL_REACHED,
    BUDGET,
    CONTRADICT,
    OUT_OF_REACH,
    "nothing is left to measure",
    "ended by the operator",
    "all readings evaluated",
    "not finished",
)
"""Those that are whole sentences."""
_TAKEN = re.compile(r"([0-9]+) readings? taken")
_REACHED = re.compile(r"(rms|worst|U) target reached")
_UNREACHED = re.compile(r"(.+) cannot be reached with these set-ups")
_BEYOND = re.compile(
    r"(rms|worst|U) target cannot be reached: endless readings would leave ([0-9.e+-]+) um, these leave ([0-9.e+-]+) um"
)


def because_text(because: str) -> str:
    """Return the reason in the language that is spoken; one that is not known here stays English."""
    if (taken := _TAKEN.fullmatch(because)) is not None:
        return counted("{count} reading taken", "{count} readings taken", int(taken[1]))
    if (reached := _REACHED.fullmatch(because)) is not None:
        return said("{name} target reached", name=reached[1])
    if (unreached := _UNREACHED.fullmatch(because)) is not None:
        return said("{rows} cannot be reached with these set-ups", rows=unreached[1])
    if (beyond := _BEYOND.fullmatch(because)) is not None:
        words = (
            "{name} target cannot be reached: endless readings would leave {floor:.3g} um, these leave {left:.3g} um"
        )
        return said(words, name=beyond[1], floor=float(beyond[2]), left=float(beyond[3]))
    return said(because) if because in ENDINGS else because
