"""The command reference is the program's own help, and every command shows an example."""

from __future__ import annotations

import re

import pytest

from tests.docs.cli import PAGE, reference

SECTIONS = reference().split("\n## ")[1:]


def test_the_page_is_the_help() -> None:
    assert PAGE.read_text(encoding="utf-8") == reference(), "make it anew: python -m tests.docs.cli"


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.splitlines()[0])
def test_every_command_has_help_with_an_example(section: str) -> None:
    name = section.splitlines()[0]
    groups = [title.splitlines()[0] for title in SECTIONS if title.startswith(f"{name} ")]
    assert groups or re.search(rf"^```text\n(.*\n)*{name}( |$)", section, re.MULTILINE)
