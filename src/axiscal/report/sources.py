"""The budget of the uncertainty in words: where what is not known comes from."""

from __future__ import annotations

from axiscal.estimation.budget import BudgetShare, budget
from axiscal.estimation.estimation import Estimation
from axiscal.language.spoken import later, said
from axiscal.report.summary import BudgetRow
from axiscal.units import said_quantity, to_unit

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
_TYPE_B = {
    "scale": later("Scale of the {owner}"),
    "air": later("Refraction of air"),
    "cosine": later("Beam aslant"),
    "dead_path": later("Dead path in air"),
    "temperature": later("Temperature of the measured material"),
    "expansion": later("Expansion of the measured material"),
    "length": later("Length of the ball bar"),
    "square": later("Angle of the straightedge as a square"),
    "bow": later("Bow of the straightedge"),
    "gain": later("Gain of the {owner}"),
    "radius": later("Radius of ball and stylus"),
    "pre_travel": later("Pre-travel of the probe"),
}
"""What no reading shows, by name; see `promise.type_b`."""
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
    if share.cause is not None:
        row, owner = share.cause.row, share.cause.owner
        what = said(_TYPE_B[row.name], owner=said(owner) if owner else "")
        if share.cause.stated:
            return said("{what}, as stated", what=what)
        return said("{what}, {size} as is usual", what=what, size=said_quantity(row.size, row.unit))
    return said(_WORDS[share.kind])
