"""`axiscal serve`: the page in a browser that takes the place of the prompt."""

from __future__ import annotations

import os
import webbrowser
from pathlib import Path

from axiscal.cli.printing import say, tell
from axiscal.language.spoken import said, speaking
from axiscal.present.whose_language import chosen


def serve(
    record: Path | None, port: int = 0, start: bool = False, browser: bool = False, language: str | None = None
) -> None:
    """Plan and measure on a page in the browser."""
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
    if left:
        os._exit(0)  # a thread that computes is waited for by no other end
