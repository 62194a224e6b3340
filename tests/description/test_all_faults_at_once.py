"""All that is wrong in a file is said in one run, and sizes that can hardly be meant are asked about."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from axiscal.exceptions import Faults, ReadingError
from axiscal.machine.description import load_machine
from tests.commands import Command


def lines_of(text: str) -> list[int]:
    return [int(number) for number in re.findall(r"\bline (\d+)", text)]


def test_no_more_than_five_are_said_beside_the_first() -> None:
    faults = Faults()
    for line in range(1, 40):
        with faults.noted():
            raise ReadingError(f"no number {line}", "write one", "a.csv", line)
    with pytest.raises(ReadingError) as refused:
        faults.refuse()
    assert lines_of(str(refused.value)) == [1, 2, 3, 4, 5, 6]
    assert str(refused.value).endswith("\nAnd 33 more.")
    Faults().refuse()


def test_a_rotary_axis_of_which_nobody_says_which_way_it_counts_is_asked_about(
    tmp_path: Path, command: Command
) -> None:
    asked = "Which way do C and B count?"
    assert f"Mind: {asked}" in command("machine", "check", "dmu60").printed
    text = load_machine("dmu60").text.replace("[axes.B]", '[axes.B]\ndirection = "iso"')
    (tmp_path / "machine.toml").write_text(text)
    (question,) = command("machine", "check", tmp_path / "machine.toml", "--json").document["questions"]
    assert question.startswith("Which way does C count?")
    (tmp_path / "machine.toml").write_text(text.replace("[axes.C]", '[axes.C]\ndirection = "reversed"'))
    assert command("machine", "check", tmp_path / "machine.toml", "--json").document["questions"] == []


def test_what_is_wrong_alike_in_many_lines_is_said_once() -> None:
    faults = Faults()
    for line in (2, 3, 4, 9):
        with faults.noted():
            raise ReadingError("approach 'up' cannot be read", "Write 'X+'", "r.csv", line)
    with faults.noted():
        raise ReadingError("there is no value", "Write one", "r.csv", 5)
    with pytest.raises(ReadingError) as refused:
        faults.refuse()
    said = str(refused.value)
    assert said.count("cannot be read") == 1
    assert said.startswith("r.csv, line 2: approach 'up' cannot be read. Write 'X+'. (4 times, up to line 9.)")
    assert said.endswith("\n- line 5: there is no value. Write one.")
