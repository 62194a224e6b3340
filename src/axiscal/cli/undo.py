"""`axiscal step undo`."""

from __future__ import annotations

from axiscal.cli.arguments import Json, OwnRecord
from axiscal.cli.opened import opened_to_write
from axiscal.cli.printing import say_either
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
    document = {"undone": taken.kind, "reading": taken.number, "readings": taken.left}
    say_either(json, "axiscal-undo/1", document, [taken.sentence])
