"""Every axiscal command that a page gives is one that the program takes: its name, its options, its arguments."""

import re
import shlex
from pathlib import Path
from typing import Any

import pytest
import typer.main

from axiscal.cli.app import app, shielded
from tests.docs.howtos import DOCS

_BLOCK = re.compile(r"^[ \t]*```sh\n(.*?)^[ \t]*```", re.MULTILINE | re.DOTALL)
PAGES = [DOCS.parent / "README.md", *sorted(DOCS.rglob("*.md"))]


def commands(page: Path) -> list[list[str]]:
    """Return the axiscal commands of a page as words, continued lines joined."""
    blocks = _BLOCK.findall(page.read_text(encoding="utf-8"))
    lines = [line.strip() for block in blocks for line in block.replace("\\\n", " ").splitlines()]
    return [_words(line) for line in lines if line.startswith("axiscal ")]


def _words(line: str) -> list[str]:
    """Return what the program is given of a line; the shell keeps what it sends elsewhere."""
    words = shlex.split(line, comments=True)[1:]
    ends = [number for number, word in enumerate(words) if word in (">", "|", "&&")]
    return [shielded(word) for word in words[: min(ends, default=len(words))]]


def taken(words: list[str]) -> None:
    """Parse a command to the end without running it; raises what click raises for a wrong one."""
    command: Any = typer.main.get_command(app)
    name, context = "axiscal", None
    while hasattr(command, "commands"):
        context = command.make_context(name, list(words), parent=context)
        name, command, words = command.resolve_command(context, [*context._protected_args, *context.args])
    command.make_context(name, list(words), parent=context)


@pytest.mark.parametrize("page", [page for page in PAGES if commands(page)], ids=lambda page: page.stem)
def test_the_commands_of_a_page_are_taken(page: Path) -> None:
    for words in commands(page):
        taken(words)


def test_a_wrong_command_is_not_taken() -> None:
    for words in (["plan"], ["plan", "c.toml", "--gcod", "linuxcnc"], ["pla", "c.toml"], ["machine", "lst"]):
        with pytest.raises(Exception, match=r"Missing|No such"):
            taken(words)


def test_the_way_from_an_ini_file_to_a_verified_correction_is_whole() -> None:
    given = [words[words[0] == "step"] for words in commands(DOCS / "linuxcnc.md")]
    steps = ["init", "machine", "plan", "run", "export", "verify", "verify"]
    assert given[: len(steps)] == steps
    assert {"start", "measure", "record"} <= set(given)
