"""`axiscal serve`: the page in a browser that takes the place of the prompt."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.arguments import Language, only_record, records_here
from axiscal.cli.printing import say, tell
from axiscal.language.spoken import said, speaking
from axiscal.present.whose_language import chosen


def serve(
    record: Annotated[
        Path | None,
        typer.Argument(
            metavar="RECORD",
            default_factory=only_record,
            show_default=False,
            autocompletion=records_here,
            help="The campaign record; default: AXISCAL_RECORD, or the only one here, else the start.",
        ),
    ],
    port: Annotated[
        int, typer.Option(metavar="PORT", min=0, max=65535, show_default=False, help="Port; default: any that is free.")
    ] = 0,
    start: Annotated[
        bool, typer.Option("--start", help="Show the start, also where there is one record here.")
    ] = False,
    browser: Annotated[bool, typer.Option("--browser", help="Open the page in the browser.")] = False,
    language: Language = None,
) -> None:
    """Plan and measure on a page in the browser.

    The page is for this computer only; its address holds a token that is new at every start. Several windows may be
    open at once.

    \b
    Examples:
      axiscal serve
      axiscal serve mill.axiscal
    """
    from axiscal.web.serving import serve_page  # a server, which no prompt needs

    opened = None if start else record
    if opened is not None:
        tell(said("Looking at what is known and planned; a plan that is not made yet takes up to a minute"))

    def ready(address: str) -> None:
        say(said("Open {address}\nEnd it with Ctrl-C; every reading is kept.", address=address))
        if browser:
            webbrowser.open(address)

    with speaking(chosen(language)):
        left = serve_page(opened, port, ready)
    say(f"{said('Ended; every reading is kept.')} {left}".rstrip())
