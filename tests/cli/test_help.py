"""`axiscal --help`: ten commands, others in groups, each in a line with an example; what Tab offers."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from importlib import import_module
from inspect import Parameter, signature
from pathlib import Path
from typing import Any

import pytest
import typer.main

from axiscal.cli.app import app
from axiscal.cli.arguments import TABLE, parameters
from tests.docs.cli import PAGE, reference

TEN = ["init", "plan", "measure", "serve", "finish", "export", "verify", "status", "report", "demo"]
GROUPED = {
    "step": ["start", "next", "record", "undo", "accept", "note", "status", "run"],
    "data": ["estimate", "iso230", "predict", "copy"],
}
LONGEST = 60
"""Characters of a summary: a line of help fits 80 columns with the name before it."""
_LINE = re.compile(r"^  ([a-z0-9]+) +(\S.*)$", re.MULTILINE)
GROUPS: list[list[str]] = [[], ["step"], ["data"], ["machine"]]


def _listed(help_text: str, title: str) -> dict[str, str]:
    """Return the summaries under a title of a help, by their commands."""
    return dict(_LINE.findall(help_text.partition(f"\n{title}:\n")[2].partition("\n\n")[0]))


def _help_of(words: list[str]) -> str:
    """Return what a command says of itself behind its usage."""
    command: Any = typer.main.get_command(app)
    context = command.context_class(command, info_name="axiscal")
    for word in words:
        command = command.get_command(context, word)
        context = command.context_class(command, info_name=word, parent=context)
    text: str = command.get_help(context)
    return text.partition("\n\n")[2]


def test_ten_commands_come_first_and_the_others_in_groups() -> None:
    assert list(_listed(_help_of([]), "Commands")) == TEN
    assert list(_listed(_help_of([]), "More commands, in groups")) == [*GROUPED, "machine"]


@pytest.mark.parametrize("words", GROUPS, ids=lambda words: "-".join(["axiscal", *words]))
def test_every_command_is_said_in_one_short_sentence(words: list[str]) -> None:
    text = _help_of(words)
    shown = _listed(text, "Commands") | _listed(text, "More commands, in groups")
    assert shown
    assert {name: text for name, text in shown.items() if len(text) > LONGEST or not text.endswith(".")} == {}


def test_the_table_has_what_each_command_takes() -> None:
    for place in {place for group in TABLE["commands"].values() for place in group.values()}:
        file, _, function = place.partition(".")
        taken = signature(getattr(import_module(f"axiscal.cli.{file}"), function)).parameters.values()
        told = [each for each in parameters(place) if each.name != "json"]
        assert [each.name for each in told] == [each.name for each in taken], place
        both = [(one.default, other.default) for one, other in zip(told, taken, strict=True)]
        assert {one for one, other in both if other is not Parameter.empty and one != other} == set(), place


SECTIONS = reference().split("\n## ")[1:]


def test_the_page_is_the_help() -> None:
    assert PAGE.read_text(encoding="utf-8") == reference(), "make it anew: python -m tests.docs.cli"


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.splitlines()[0])
def test_every_command_has_help_with_an_example(section: str) -> None:
    name = section.splitlines()[0]
    groups = [title.splitlines()[0] for title in SECTIONS if title.startswith(f"{name} ")]
    assert groups or re.search(rf"^```text\n(.*\n)*{name}( |$)", section, re.MULTILINE)


@pytest.mark.long
def test_it_completes(tmp_path: Path) -> None:
    asking = {"_AXISCAL_COMPLETE": "complete_bash", "COMP_WORDS": "axiscal measure --la", "COMP_CWORD": "2"}
    done = subprocess.run(
        [sys.executable, "-m", "axiscal"],
        cwd=tmp_path,
        env={**os.environ, **asking},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout.split(), done.stderr) == (0, ["--language"], "")
