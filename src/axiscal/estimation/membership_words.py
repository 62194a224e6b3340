"""In words, whether a machine is like its sisters, and if not, what is least like theirs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.error_model.model import Term
from axiscal.estimation.estimation import Estimation
from axiscal.numerics import Array

STRANGE = 0.5
"""Below this it is likelier a stranger than a sister."""
_TOLD = 0.5
"""Share of the type's variance below which readings have told an error."""
_FAR = 2.5
"""Standard deviations from which an error is named as unlike: of many errors one is 2 away by chance."""


class Unlike(NamedTuple):
    """An error and how many of its sisters' standard deviations it is from what is expected of them."""

    name: str
    away: float


def membership_words(known: Estimation) -> str:
    """Return a sentence on a machine with sisters; "" for one without, or before the first reading."""
    member = known.membership
    if member is None or member.count == 0:
        return ""
    if member.sister >= STRANGE:
        some = f"readings up to {member.count} fit" if member.count > 1 else "the first reading fits"
        return f"{some} the sisters (P = {member.sister:.2g})"
    found = farthest(known)
    most = f": {found.name} is {found.away:.1f} of their standard deviations away" if found is not None else ""
    return f"this machine is not like its sisters (P = {member.sister:.2g}){most}"


def farthest(known: Estimation) -> Unlike | None:
    """Return the error that is least like those of the sisters, of those that readings have told."""
    member = known.membership
    if member is None:
        return None
    sisters, belief = member.rivals[0].belief, known.banded.knowledge.belief
    covariance = belief.covariance

    def unlike(term: Term) -> Unlike:
        before, after = (np.diagonal(each)[term.columns] for each in (sisters.covariance, covariance))
        away = np.abs(belief.mean[term.columns] - sisters.mean[term.columns]) / np.sqrt(before)
        told: Array = np.where(after < _TOLD * before, away, 0.0)
        return Unlike(term.name, float(told.max()))

    most = max((unlike(term) for term in known.case.errors.terms), key=lambda each: each.away)
    return most if most.away >= _FAR else None
