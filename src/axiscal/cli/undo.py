"""`axiscal step undo`."""

from __future__ import annotations

from axiscal.cli.arguments import Json, OwnRecord
from axiscal.cli.opened import opened_to_write
from axiscal.cli.printing import say, say_document
from axiscal.present.guide.taking_back import take_back


def undo(record: OwnRecord, json: Json = False) -> None:
    """Take back the last reading, skip, accepted mistake or end.

    Its question is open again. The record still shows that it happened.

    \b
    Example:
      axiscal step undo mill.axiscal
    """

    with opened_to_write(record) as campaign:
        taken = take_back(campaign)
    if json:
        document = {"undone": taken.kind, "reading": taken.number, "readings": taken.left}
        say_document({"schema": "axiscal-undo/1", **document})
    else:
        say(taken.sentence)
