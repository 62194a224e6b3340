"""Which reading decides between two causes that compete, in words for whoever is to take it."""

from __future__ import annotations

from axiscal.campaign.campaign import Campaign
from axiscal.guide.contradicted import cause_words
from axiscal.language.spoken import said
from axiscal.measurement.place_texts import reading_unit
from axiscal.record.events import Asked
from axiscal.units import to_unit


def deciding_text(campaign: Campaign, asked: Asked) -> str:
    """Return between which causes a reading decides, and what each lets it show; empty where it decides nothing."""
    found = campaign.contest()
    if found is None or found.place != asked.place:
        return ""
    unit = reading_unit(campaign.description.setup(asked.place.setup))
    first, second = (f"{to_unit(each, unit):.3g} {unit}" for each in found.expected)
    what = (
        "this reading decides between two causes of what contradicts the model: {first}, then it shows about "
        "{shows}; or {second}, then {other}"
    )
    causes = {"first": cause_words(found.first), "second": cause_words(found.second)}
    return said(what, **causes, shows=first, other=second)
