"""`axiscal data reproduce`."""

from __future__ import annotations

import json as json_text
from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.arguments import Json
from axiscal.cli.printing import say, say_document, tell
from axiscal.document.durable import write_whole
from axiscal.ports.paper.paper_page import render
from axiscal.ports.paper.stack import document, run, table

Folder = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Folder for reproduce.html and its numbers.")]


def reproduce(out: Folder = None, json: Json = False) -> None:
    """Simulate the source paper again and draw its figures 4 to 7.

    \b
    Example:
      axiscal data reproduce --out paper
    """

    experiment = run()
    numbers = document(experiment)
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        page = out / "reproduce.html"
        write_whole(page, render(experiment).encode())
        write_whole(out / "reproduce.json", f"{json_text.dumps(numbers, indent=2, allow_nan=False)}\n".encode())
        tell(f"The figures are in {page}.")
    if json:
        say_document(numbers)
    else:
        say(table(experiment))
