"""The command reference: the help of every command as one Markdown page.

`python -m axiscal.cli.reference > docs/cli.md`
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import typer.main

WIDTH = 100
"""Columns; a matter of taste."""

_HEAD = """\
# Commands

Made from the program's own help by `python -m axiscal.cli.reference`; a test holds it.
"""


def reference() -> str:
    """Return the page."""
    from axiscal.cli.app import app

    sections = [_section(path, text) for path, text in _helps(typer.main.get_command(app), "axiscal", None)]
    return "\n".join([_HEAD, *sections])


def _helps(command: Any, path: str, parent: Any) -> Iterator[tuple[str, str]]:
    context = command.context_class(
        command, info_name=path.rpartition(" ")[2], parent=parent, terminal_width=WIDTH, max_content_width=WIDTH
    )
    yield path, command.get_help(context)
    names = command.list_commands(context) if hasattr(command, "list_commands") else []
    for name in names:
        yield from _helps(command.get_command(context, name), f"{path} {name}", context)


def _section(path: str, text: str) -> str:
    lines = "\n".join(line.rstrip() for line in text.strip().splitlines())
    return f"## {path}\n\n```text\n{lines}\n```\n"


if __name__ == "__main__":
    sys.stdout.write(reference())
