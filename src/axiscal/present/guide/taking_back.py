"""The entry that `undo` would take back, and the one that it has taken back, in words."""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.campaign.campaign import Campaign
from axiscal.estimation.accepting import change_words
from axiscal.language.spoken import counted, said
from axiscal.measurement.place_texts import reading_text
from axiscal.present.guide.question import asked_text
from axiscal.record.accepted import Accepted
from axiscal.record.events import Recorded, Skipped


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
