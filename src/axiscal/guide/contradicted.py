"""Whether the readings of a campaign contradict its model, said after every reading."""

from __future__ import annotations

import math

from axiscal.campaign.campaign import Campaign
from axiscal.inference.contradiction import SURE, Explanation
from axiscal.language.spoken import said

_MOST = 15
"""Powers of ten of the odds: more are said as so many."""


def contradicted_words(campaign: Campaign) -> list[str]:
    """Return by which odds readings contradict the model at whatever time one looks, and what explains them best.

    None where they do not, or the campaign has ended.
    """
    if campaign.state.finished is not None:
        return []
    found = campaign.watched()
    if found.highest < SURE:
        return []
    power = min(math.floor(math.log10(found.highest)), _MOST)
    what = "The readings contradict the model, by odds of 10^{power} to 1 at least. Likeliest: {cause}."
    return [said(what, power=power, cause=cause_words(found.explanations[0]))]


def cause_words(found: Explanation) -> str:
    """Return in words what explains readings best."""
    words = {
        "drift": said('the zero of "{owner}" drifts', owner=found.owner),
        "levelling": said('the zero of "{owner}" drifts and levels off', owner=found.owner),
        "excursion": said('the zero of "{owner}" comes and goes', owner=found.owner),
        "growth": said("{owner} grows and shrinks again", owner=found.owner),
        "jump": said('the zero of "{owner}" jumped', owner=found.owner),
        "step": said("{owner} steps", owner=found.owner),
        "pitch": said("{owner} repeats along its axis", owner=found.owner),
        "bump": said("{owner} has a detail that its knots do not follow", owner=found.owner),
        "detail": said("{owner} has a detail that is narrower than its knots are apart", owner=found.owner),
        "reversal": said("{owner} is not the same everywhere", owner=found.owner),
        "scale": said("{owner} is linear, as by temperature or a wrong scale", owner=found.owner),
        "together": said("{owner}: two axes do together what no sum of their curves holds", owner=found.owner),
        "bad": said('one reading of "{owner}" is wrong', owner=found.owner),
    }
    return words[found.family]
