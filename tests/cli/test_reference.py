"""The command reference is the program's own help, and every command shows an example."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from axiscal.cli.reference import reference

PAGE = Path(__file__).resolve().parents[2] / "docs" / "cli.md"
SECTIONS = reference().split("\n## ")[1:]


def test_the_page_is_the_help() -> None:
    assert PAGE.read_text(encoding="utf-8") == reference(), (
        "make it anew: python -m axiscal.cli.reference > docs/cli.md"
    )


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.splitlines()[0])
def test_every_command_has_help_with_an_example(section: str) -> None:
    name = section.splitlines()[0]
    groups = [title.splitlines()[0] for title in SECTIONS if title.startswith(f"{name} ")]
    assert groups or "Example" in section
    example = section.partition("Example")[2]
    assert groups or re.search(rf"^ +{name}( |$)", example, re.MULTILINE)
