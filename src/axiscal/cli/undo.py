"""`axiscal undo`."""

from __future__ import annotations

from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.printing import say, say_document
from axiscal.cli.texts import count_text
from axiscal.record.events import Finished, Recorded


def undo(record: RecordFile, json: Json = False) -> None:
    """Take back the last reading, skip or finish.

    Its question is open again. The record still shows that it happened.

    \b
    Example:
      axiscal undo mill.axiscal
    """

    with Campaign.open(record) as campaign:
        event = campaign.undo().event
        left = len(campaign.state.readings)
    what = "the reading" if isinstance(event, Recorded) else "the end" if isinstance(event, Finished) else "the skip"
    if json:
        say_document({"schema": "axiscal-undo/1", "undone": type(event).__name__.lower(), "readings": left})
    else:
        say(f"Took back {what}; {count_text(left, 'reading')} {'is' if left == 1 else 'are'} kept.")
