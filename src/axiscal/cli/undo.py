"""`axiscal undo`."""

from __future__ import annotations

from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import Json, OwnRecord
from axiscal.cli.opened import opened_to_write
from axiscal.cli.printing import say, say_document
from axiscal.cli.texts import asked_text, count_text
from axiscal.measurement.place_texts import reading_text
from axiscal.record.events import Recorded, Skipped


def undo(record: OwnRecord, json: Json = False) -> None:
    """Take back the last reading, skip or finish.

    Its question is open again. The record still shows that it happened.

    \b
    Example:
      axiscal undo mill.axiscal
    """

    with opened_to_write(record) as campaign:
        said, document = taken_back(campaign)
    if json:
        say_document({"schema": "axiscal-undo/1", **document})
    else:
        say(said)


def taken_back(campaign: Campaign) -> tuple[str, dict[str, object]]:
    """Take back the last reading, skip or finish, and return that in words and as a document."""
    what, number = _last(campaign)
    undone = type(campaign.undo().event).__name__.lower()
    left = len(campaign.state.readings)
    said = f"Took back {what}; {count_text(left, 'reading')} {'is' if left == 1 else 'are'} kept."
    return said, {"undone": undone, "reading": number, "readings": left}


def _last(campaign: Campaign) -> tuple[str, int | None]:
    """Return what would be taken back, and the number of its reading."""
    state, description = campaign.state, campaign.description
    event = state.undo[-1].event if state.undo else None
    if isinstance(event, Recorded):
        index, reading = len(state.readings) - 1, state.readings[-1]
        setup = description.setup(reading.setup)
        return reading_text(description.machine.axes, setup, reading, index), reading.number
    if isinstance(event, Skipped):
        asked = state.skipped[-1].asked
        return f"the skip of {asked_text(campaign, asked)}", asked.reading
    return "the end", None
