"""`axiscal serve`."""

from __future__ import annotations

from typing import Annotated

import typer

from axiscal.cli.arguments import Language, OwnRecord
from axiscal.cli.printing import say, tell
from axiscal.language.spoken import said, speaking
from axiscal.present.whose_language import chosen
from axiscal.web.serving import serve_record


def serve(
    record: OwnRecord,
    port: Annotated[
        int, typer.Option(min=0, max=65535, show_default=False, help="Port; default: any that is free.")
    ] = 0,
    language: Language = None,
) -> None:
    """Take the readings of a campaign on a page in the browser.

    The page is for this computer only; its address holds a token that is new at every start. Several windows, and
    `axiscal measure` beside them, may be open at once: each reading is on the disk before the next one is asked for.

    \b
    Example:
      axiscal serve mill.axiscal
    """
    tell("Looking at what is known and planned; a plan that is not made yet takes up to a minute")
    with speaking(chosen(language)):
        left = serve_record(
            record,
            port,
            lambda address: say(said("Open {address}\nEnd it with Ctrl-C; every reading is kept.", address=address)),
        )
    say(f"{said('Ended; every reading is kept.')} {left}".rstrip())
