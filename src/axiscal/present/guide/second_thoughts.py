"""Readings that were believed until another one came: they are named as soon as that is so."""

from __future__ import annotations

from axiscal.campaign.campaign import Campaign
from axiscal.estimation.agreement_words import agreement_words
from axiscal.language.spoken import decimals, said
from axiscal.measurement.place_texts import reading_text, reading_unit
from axiscal.units import format_quantity

_SURPRISING = 3.0
"""Standard deviations below which a reading that is believed again is not worth a sentence."""


def doubted(campaign: Campaign) -> frozenset[int]:
    """Return the indices of the readings that are doubted now."""
    return frozenset(doubt.reading for doubt in campaign.estimate().outliers)


def others_doubted(campaign: Campaign, before: frozenset[int]) -> list[str]:
    """Return sentences about what the last reading changed: earlier readings doubted or believed, and its own surprise.

    before : what was doubted before it
    """
    last, now = len(campaign.state.readings) - 1, doubted(campaign)
    doubtful = "with this one, {reading}, is no longer relied on. Read there again."
    minds = [said(doubtful, reading=_shown(campaign, index)) for index in sorted(now - before - {last})]
    minds += [said("with this one, {reading}, is believed.", reading=_shown(campaign, index)) for index in before - now]
    surprise = campaign.estimate().innovations[last]
    size = (surprise.chi_square / surprise.degrees) ** 0.5
    vouched = campaign.state.readings[last].accepted
    if last not in now and not vouched and size >= _SURPRISING:
        strange = (
            "it is {size} standard deviations from what was expected. It is believed so far; take it back and read "
            "there again if anything may have been wrong."
        )
        minds.append(said(strange, size=decimals(f"{size:.1f}")))
    return minds


def contradictions(campaign: Campaign) -> list[str]:
    """Return what is to be said of readings that contradict each other; nothing where they agree, or at the end."""
    if campaign.state.finished is not None:
        return []
    known = campaign.estimate()
    return [agreement_words(known, campaign.path)] if known.agreement.contradicts else []


def _shown(campaign: Campaign, index: int) -> str:
    reading, description = campaign.state.readings[index], campaign.description
    setup = description.setup(reading.setup)
    value = format_quantity(reading.value, reading_unit(setup))
    return f"{reading_text(description.machine.axes, setup, reading, index)}, {value}"
