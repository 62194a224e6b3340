"""All that is wrong in a file is said in one run, and sizes that can hardly be meant are asked about."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from axiscal.cli.app import run
from axiscal.exceptions import Faults, ReadingError
from axiscal.machine.description import builtin_names, load_machine
from axiscal.machine.questions import questions
from tests.commands import Command
from tests.generators.texts import campaign_text, setup_text

GOOD = """chain = "w-X'-b-Y-t"
[tool]
length = "50 mm"
[axes.X]
travel = ["0 mm", "300 mm"]
speed = "10 m/min"
[axes.Y]
travel = ["0 mm", "200 mm"]
[errors]
EXX = { std = "20 um" }
EYY = { std = "20 um" }
"""
LASER = campaign_text(
    "machine.toml",
    setup_text("x", "interferometer", direction="x", moves=["X"]),
    target={"readings": 5},
    compensation_active=False,
)


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


@pytest.mark.parametrize(
    ("old", "new", "asked"),
    [
        ('"300 mm"]', '"500 m"]', "The travel of X is 500 m"),
        ('"300 mm"]', '"0.2 mm"]', "The travel of X is 0.0002 m"),
        ('EXX = { std = "20 um" }', 'EXX = { std = "5 mm" }', "The std of EXX is 5 mm"),
        ('length = "50 mm"', 'length = "5 m"', "The tool is 5 m long"),
        ('speed = "10 m/min"', 'speed = "10 km/min"', "X moves at"),
    ],
)
def test_sizes_that_can_hardly_be_meant_are_asked_about(
    old: str, new: str, asked: str, tmp_path: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    if "km/min" in new:
        new = 'speed = "10000 m/min"'
    (tmp_path / "machine.toml").write_text(GOOD.replace(old, new))
    (tmp_path / "campaign.toml").write_text(LASER)
    (question,) = command("machine", "check", tmp_path / "machine.toml", "--json").document["questions"]
    assert question.startswith(asked)
    assert f"Mind: {asked}" in command("machine", "check", tmp_path / "machine.toml").printed
    assert run(["start", str(tmp_path / "campaign.toml"), str(tmp_path / "a.axiscal")]) == 0
    assert f"Mind: {asked}" in capsys.readouterr().err


@pytest.mark.parametrize("name", builtin_names())
def test_nothing_is_asked_about_the_built_in_machines(name: str) -> None:
    assert questions(load_machine(name)) == ()


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
