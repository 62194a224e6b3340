"""What `undo` would take back or has taken back, and which readings are no longer believed since the last, in words."""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.campaign.campaign import Campaign
from axiscal.estimation.agreement_words import agreement_words, change_words
from axiscal.language.spoken import counted, decimals, said
from axiscal.measurement.reading import reading_text, reading_unit
from axiscal.planning.next_readings import rejected
from axiscal.present.guide.question import asked_text
from axiscal.record.accepted import Accepted
from axiscal.record.events import Recorded, Skipped
from axiscal.units import format_quantity


@dataclass(frozen=True, slots=True)
class TakenBack:
    """What was taken back.

    kind : "recorded", "skipped", "accepted" or "finished"; what : the same in words
    number : of the reading; left : readings
    """

    kind: str
    what: str
    number: int | None
    left: int

    @property
    def sentence(self) -> str:
        """What was taken back and what is kept."""
        kept = counted("{count} reading is kept", "{count} readings are kept", self.left)
        return said("Took back {what}; {kept}.", what=self.what, kept=kept)


def take_back(campaign: Campaign) -> TakenBack:
    """Take back the last reading, skip, accepted mistake or finish, and return it; raises RecordError for none."""
    what, number = last_step(campaign)
    kind = type(campaign.undo().event).__name__.lower()
    return TakenBack(kind, what, number, len(campaign.state.readings))


def last_step(campaign: Campaign) -> tuple[str, int | None]:
    """Return what would be taken back, "" where there is nothing, and the number of its reading."""
    state, description = campaign.state, campaign.description
    if not state.undo:
        return "", None
    event = state.undo[-1].event
    if isinstance(event, Recorded):
        index, reading = len(state.readings) - 1, state.readings[-1]
        setup = description.setup(reading.setup)
        return reading_text(description.machine.axes, setup, reading, index), reading.number
    if isinstance(event, Skipped):
        asked = state.skipped[-1].asked
        return said("the skip of {reading}", reading=asked_text(campaign, asked)), asked.reading
    if isinstance(event, Accepted):
        return said("what was accepted: {change}", change=change_words(event)), None
    return said("the end"), None


_SURPRISING = 3.0
"""Standard deviations below which a reading that is believed again is not worth a sentence."""


def doubted(campaign: Campaign) -> frozenset[int]:
    """Return the indices of the readings that are doubted now: where a plan's question is open, those it names."""
    state = campaign.state
    if state.pending is not None and not state.renew:
        return rejected(state.plan_basis)
    return campaign.estimate().left_out


def others_doubted(campaign: Campaign, before: frozenset[int]) -> list[str]:
    """Return sentences about what the last reading changed: earlier readings doubted or believed, and its own surprise.

    before : what was doubted before it
    """
    last, now = len(campaign.state.readings) - 1, doubted(campaign)
    doubtful = "with this one, {reading}, is no longer relied on. Read there again."
    minds = [said(doubtful, reading=_shown(campaign, index)) for index in sorted(now - before - {last})]
    minds += [said("with this one, {reading}, is believed.", reading=_shown(campaign, index)) for index in before - now]
    surprise = campaign.estimate().absorbed.innovations[last]
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
