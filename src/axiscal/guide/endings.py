"""Why a campaign has ended, in the language that is spoken; the record keeps it in English."""

from __future__ import annotations

import re

from axiscal.campaign.ending import BUDGET
from axiscal.guide.language import counted, said

ENDINGS = (BUDGET, "nothing is left to measure", "ended by the operator")
"""Those that are whole sentences."""
_TAKEN = re.compile(r"([0-9]+) readings? taken")
_REACHED = re.compile(r"(rms|worst|U) target reached")


def because_text(because: str) -> str:
    """Return the reason in the language that is spoken; one that is not known here stays English."""
    if (taken := _TAKEN.fullmatch(because)) is not None:
        return counted("{count} reading taken", "{count} readings taken", int(taken[1]))
    if (reached := _REACHED.fullmatch(because)) is not None:
        return said("{name} target reached", name=reached[1])
    return said(because) if because in ENDINGS else because
