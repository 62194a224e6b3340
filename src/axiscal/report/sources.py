"""The budget of the uncertainty in words: where what is not known comes from."""

from __future__ import annotations

from axiscal.estimation.budget import BudgetShare, budget
from axiscal.estimation.estimation import Estimation
from axiscal.report.summary import BudgetRow
from axiscal.units import to_unit

_WORDS = {
    "set-up": "Set-ups: zeros, slopes and places of the instruments, which are estimated along with the machine",
    "drift": "Drift: zeros that wander while it is read",
    "temperature": "Temperature of the measured material and its expansion",
    "artefact": "Artefacts: calibrated lengths, and where they stand",
    "detail": "Detail of the machine that the curves do not follow",
    "prior": "What these readings leave of the machine's errors, as large as they were stated beforehand",
    "unseen": "What no reading with the allowed set-ups can see",
    "sizes": "That sizes were learnt from the readings, and that the model may be wrong",
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
    return f'Instrument: noise of the readings of "{share.setup}"' if share.kind == "instrument" else _WORDS[share.kind]
