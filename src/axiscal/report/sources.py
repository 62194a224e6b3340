"""The budget of the uncertainty in words: where what is not known comes from."""

from __future__ import annotations

from axiscal.estimation.budget import BudgetShare, budget
from axiscal.estimation.estimation import Estimation
from axiscal.language.spoken import later, said
from axiscal.report.summary import BudgetRow
from axiscal.units import to_unit

_WORDS = {
    "set-up": later("Set-ups: zeros, slopes and places of the instruments, which are estimated along with the machine"),
    "drift": later("Drift: zeros that wander while it is read"),
    "temperature": later("Temperature of the measured material and its expansion"),
    "artefact": later("Artefacts: calibrated lengths, and where they stand"),
    "detail": later("Detail of the machine that the curves do not follow"),
    "prior": later("What these readings leave of the machine's errors, as large as they were stated beforehand"),
    "unseen": later("What no reading with the allowed set-ups can see"),
    "sizes": later("That sizes were learnt from the readings, and that the model may be wrong"),
}
_WORTH = 5e-4
"""Shares below are left out: they show as nought."""


def budget_rows(known: Estimation) -> list[BudgetRow]:
    """Return the sources of the standard uncertainty, the largest first; those that are nought are left out."""
    shares = budget(known)
    whole = sum(share.rms**2 for share in shares) or 1.0
    rows = [BudgetRow(_words(share), to_unit(share.rms, "um"), share.rms**2 / whole) for share in shares]
    return sorted((row for row in rows if row.share >= _WORTH), key=lambda row: -row.share)


def _words(share: BudgetShare) -> str:
    if share.kind == "instrument":
        return said('Instrument: noise of the readings of "{setup}"', setup=share.setup)
    return said(_WORDS[share.kind])
