"""README shows what the program shows: the demo's last screen, and a picture of its volume."""

import re
from pathlib import Path

import pytest

from tests.commands import Command
from tests.docs.howtos import DOCS

README = (DOCS.parent / "README.md").read_text(encoding="utf-8")
COLUMNS = 80
"""Of the smallest terminal that people have."""
SCREEN = re.findall(r"^```text\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


_LONGER = 1.1
"""Times the minutes that README shows: places that tie fall otherwise elsewhere, but no plan of ours takes longer."""
_SAME = ("TARGET", "volume", "Readings agree", "# places checked", "Next", "axiscal verify", "Report")


def _shape(screen: str) -> list[str]:
    """Return what every plan ends with, without figures and room: places that tie fall otherwise elsewhere."""
    lines = (" ".join(re.sub(r"[\d.]+", "#", line).split()) for line in screen.splitlines())
    return [line for line in lines if line.startswith(_SAME)]


def _minutes(screen: str) -> float:
    """Return the minutes of the plan that a screen ends with."""
    return float(re.findall(r"readings, (\d+) min by the plan", screen)[-1])


def test_it_shows_one_screen_that_ends_in_a_success() -> None:
    assert len(SCREEN) == 1
    assert SCREEN[0].startswith("TARGET REACHED")
    assert max(map(len, SCREEN[0].splitlines())) <= COLUMNS
    assert re.findall(r"^!\[.*?\]\(docs/pictures/(.*?)\)$", README, re.MULTILINE) == ["demo.svg"]


@pytest.mark.long
def test_the_screen_is_the_demos(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command) -> None:
    monkeypatch.chdir(tmp_path)
    printed = command("demo", "--out", "demo-out").printed
    assert max(map(len, printed.splitlines())) <= COLUMNS
    lines = _shape(printed)
    shown = _shape(SCREEN[0])
    assert lines[-len(shown) :] == shown
    assert _minutes(printed) <= _LONGER * _minutes(SCREEN[0])
