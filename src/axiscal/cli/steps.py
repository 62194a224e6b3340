"""`axiscal step next`, `undo` and `note`."""

from __future__ import annotations

from typing import Annotated

import typer

from axiscal.cli.arguments import Json, OwnRecord, RecordFile
from axiscal.cli.opened import opened_to_write
from axiscal.cli.printing import say, say_document, say_either
from axiscal.cli.texts import next_text, question_document
from axiscal.language.spoken import said
from axiscal.present.guide.taking_back import take_back


def next_reading(
    record: OwnRecord,
    beyond: Annotated[bool, typer.Option("--beyond", help="Ask for one more although a target is reached.")] = False,
    json: Json = False,
) -> None:
    """Say which reading to take next.

    The same question comes until it is answered by `record` or skipped.

    \b
    Example:
      axiscal step next mill.axiscal
    """

    with opened_to_write(record) as campaign:
        asked = campaign.next(beyond=beyond)
        if json:
            say_document(question_document(campaign, asked))
        else:
            say(next_text(campaign, asked))


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


def note(
    record: RecordFile,
    text: Annotated[list[str], typer.Argument(metavar="TEXT", help="What is to be kept.")],
    renewed: Annotated[
        list[str] | None,
        typer.Option(metavar="AXIS", help="An axis of which nothing is as it was found, for `axiscal shop due`."),
    ] = None,
    json: Json = False,
) -> None:
    """Keep a sentence in the record.

    Such as who measured, how warm it was, or what was repaired. It changes nothing that is computed, is shown by
    `axiscal step status`, and may come after the end of the campaign.

    \b
    Example:
      axiscal step note mill.axiscal "new ball screw X" --renewed X
    """
    with opened_to_write(record) as campaign:
        for axis in renewed or ():
            campaign.description.machine.index(axis)  # raises for one that the machine does not have
        campaign.note(" ".join(text) + (f" (renewed: {', '.join(renewed)})" if renewed else ""))
        kept = campaign.state.notes
    document = {"note": kept[-1].text, "at": kept[-1].at, "notes": len(kept)}
    say_either(json, "axiscal-note/1", document, [said("Noted; it is on the disk.")])
