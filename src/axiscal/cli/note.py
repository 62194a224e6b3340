"""`axiscal step note`."""

from __future__ import annotations

from typing import Annotated

import typer

from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.opened import opened_to_write
from axiscal.cli.printing import say_either
from axiscal.language.spoken import said


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
