"""Texts that people and programs type: none steers a terminal, damages a record or ends in a traceback."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from axiscal.campaign.possible import LONGEST_TEXT
from axiscal.cli.app import run
from axiscal.cli.printing import complain, say, tell, visible
from tests.commands import Command
from tests.generators.texts import FOUR_READINGS

STEERING = "red\x1b[31m bell\x07 back\x08\r \x9b2J turned\u202e\u2028 end"
WRITTEN = r"red\u001b[31m bell\u0007 back\b\r \u009b2J turned\u202e\u2028 end"
LATIN = os.fsdecode(b"caf\xe9")
"""As Python hands over an argument that was typed on a terminal of another encoding."""


@pytest.fixture
def record(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    (tmp_path / "campaign.toml").write_text(FOUR_READINGS)
    record = tmp_path / "mill.axiscal"
    assert run(["start", str(tmp_path / "campaign.toml"), str(record)]) == 0
    assert run(["next", str(record)]) == 0
    capsys.readouterr()
    return record


def refused(record: Path, capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """Return why a command was refused; not a byte of the record has changed."""
    before = record.read_bytes()
    assert run([words[0], str(record), *words[1:]]) == 1
    assert record.read_bytes() == before
    return " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize("words", [("note",), ("skip",), ("skip", "--leave")])
def test_bytes_that_are_no_text_are_refused(
    words: tuple[str, ...], record: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    why = refused(record, capsys, *words, LATIN)
    assert r'"caf\xdce9" ends in a byte that is no UTF-8' in why
    assert "on a terminal that writes UTF-8; nothing was kept." in why
    assert "defect" not in why
    assert run(["status", str(record)]) == 0


@pytest.mark.parametrize("words", [("note",), ("skip",)])
def test_a_book_is_no_note_and_no_reason(
    words: tuple[str, ...], record: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    why = refused(record, capsys, *words, "a" * (LONGEST_TEXT + 1))
    assert f"has {LONGEST_TEXT + 1} characters. Write up to {LONGEST_TEXT}" in why
    assert run([words[0], str(record), *words[1:], "a" * LONGEST_TEXT]) == 0


def test_what_is_kept_steers_no_terminal(record: Path, command: Command) -> None:
    assert run(["note", str(record), STEERING]) == 0
    assert WRITTEN in command("skip", record, STEERING).printed
    assert command("status", record, "--details").printed.count(WRITTEN) == 2
    document = command("status", record, "--json").printed
    assert WRITTEN in document
    assert [note["text"] for note in json.loads(document)["notes"]] == [STEERING]


@pytest.mark.parametrize("write", [say, tell, complain])
def test_whatever_is_said_steers_no_terminal(write: Callable[[str], None], capsys: pytest.CaptureFixture[str]) -> None:
    """Such as what a printer answers, or what somebody called a store."""
    write(f'"mill" is said to be {"x" + chr(27) + "]0;title" + chr(7)}')
    written = "".join(capsys.readouterr())
    assert r'"mill" is said to be x\u001b]0;title\u0007' in written
    assert written.replace("\n", "").isprintable()


def test_other_text_is_shown_as_it_is() -> None:
    text = "21,4 °C\t±\u202f0.3 µm → – …\n日本 \U0001f600 \xa0"
    assert visible(text) == text
    assert json.loads(visible(json.dumps("\x9b\ud800\x7f", ensure_ascii=False))) == "\x9b\ud800\x7f"
