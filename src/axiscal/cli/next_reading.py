"""`axiscal step next`."""

from __future__ import annotations

from typing import Annotated

import typer

from axiscal.cli.arguments import Json, OwnRecord
from axiscal.cli.opened import opened_to_write
from axiscal.cli.printing import say, say_document
from axiscal.cli.texts import next_text, question_document


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
