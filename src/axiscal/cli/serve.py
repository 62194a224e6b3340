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
            help="The campaign record; AXISCAL_RECORD, or the only one here, where it is left out; else the start.",
        ),
    ],
    port: Annotated[
        int, typer.Option(metavar="PORT", min=0, max=65535, show_default=False, help="Port; default: any that is free.")
    ] = 0,
    start: Annotated[
        bool, typer.Option("--start", help="Show the start, also where there is one record here.")
    ] = False,
    browser: Annotated[bool, typer.Option("--browser", help="Open the page in the browser.")] = False,
    shop: Annotated[bool, typer.Option("--shop", help="Let tablets of the shop in, too, by codes to scan.")] = False,
    person: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="With --shop: who measures; once for each. Default: you.")
    ] = None,
    at: Annotated[
        str | None, typer.Option(metavar="ADDRESS:PORT", help="With --shop: of this computer. Default port: 8470.")
    ] = None,
    language: Language = None,
) -> None:
    """Plan and measure on a page in the browser.

    The page is for this computer only; its address holds a token that is new at every start. Several windows, and
    `axiscal measure`, may be open at once. With --shop tablets scan a code, and their readings bear a name.

    \b
    Examples:
      axiscal serve
      axiscal serve mill.axiscal
      axiscal serve --shop --person Anna
    """
    from axiscal.web.serving import serve_page  # a server, which no prompt needs
    from axiscal.web.shop import ShopDoor

    if not shop and (at or person):
        raise typer.BadParameter(said("Only devices of the shop need it: say --shop as well"))
    door = ShopDoor(at) if shop else None
    opened = None if start else record
    if opened is not None:
        tell(said("Looking at what is known and planned; a plan that is not made yet takes up to a minute"))

    def ready(address: str) -> None:
        say(said("Open {address}\nEnd it with Ctrl-C; every reading is kept.", address=address))
        if door is not None:
            say(door.invitation(person or []))
        if browser:
            webbrowser.open(address)

    with speaking(chosen(language)):
        left = serve_page(opened, port, ready, door)
    say(f"{said('Ended; every reading is kept.')} {left}".rstrip())
