"""`axiscal data reproduce`."""

from __future__ import annotations

import json as json_text
from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.arguments import Json
from axiscal.cli.printing import say, say_document, tell
from axiscal.document.durable import write_whole
from axiscal.ports.paper.beyond import beyond, lines
from axiscal.ports.paper.beyond import numbers as numbers_beyond
from axiscal.ports.paper.experiment import document, run, table
from axiscal.ports.paper.paper_page import render

Folder = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Folder for reproduce.html and its numbers.")]


def reproduce(out: Folder = None, json: Json = False) -> None:
    """Simulate the source paper again and draw its figures 4 to 7.

    Then figures 6 and 7 again where a joint turns far, two joints act together, or a station is unknown.

    \b
    Example:
      axiscal data reproduce --out paper
    """

    experiment, found = run(), beyond()
    numbers = {**document(experiment), "beyond": numbers_beyond(found)}
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        page = out / "reproduce.html"
        write_whole(page, render(experiment, found).encode())
        write_whole(out / "reproduce.json", f"{json_text.dumps(numbers, indent=2, allow_nan=False)}\n".encode())
        tell(f"The figures are in {page}.")
    if json:
        say_document(numbers)
    else:
        say("\n".join([table(experiment), "", *lines(found)]))
