"""In words, whether a machine is like its sisters, and if not, what is least like theirs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.errors.model import Term
from axiscal.estimation.estimation import Estimation
from axiscal.language.spoken import later, said
from axiscal.numerics import Array

STRANGE = 0.5
"""Below this it is likelier a stranger than a sister."""
_STRANGER = later("this machine is not like its sisters (P = {chance:.2g})")
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
        if member.count == 1:
            return said("the first reading fits the sisters (P = {chance:.2g})", chance=float(member.sister))
        many = "readings up to {count} fit the sisters (P = {chance:.2g})"
        return said(many, count=member.count, chance=float(member.sister))
    found, strange = farthest(known), said(_STRANGER, chance=float(member.sister))
    if found is None:
        return strange
    most = "{strange}: {name} is {away:.1f} of their standard deviations away"
    return said(most, strange=strange, name=found.name, away=float(found.away))


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
