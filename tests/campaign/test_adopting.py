"""Readings of a branch are taken over once, all or none, and never where a set-up's unknowns would be confused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts
from axiscal.measurement.reading import Reading
from axiscal.record.copies import write_copy
from axiscal.record.store import Record
from tests.generators.sisters import read_on, slide, write_record

SECOND = """[[setups]]
name = "dial"
instrument = "indicator"
direction = "x"
moves = ["X"]
approach = "both"
noise = "1.5 um"
"""


@pytest.fixture
def main(tmp_path: Path) -> Path:
    """Return a record with six readings of the laser."""
    described = campaign_from_texts(slide().text + SECOND, "campaign.toml", slide().machine.text, "machine.toml")
    return write_record(tmp_path / "main.axiscal", described, read_on(1)[:6])


@pytest.fixture
def branch(main: Path) -> Path:
    """Return a copy of it."""
    file = main.with_name("branch.axiscal")
    with Record.open(main, write=False) as record:
        write_copy(record, file)
    return file


def read(file: Path, readings: list[Reading], setup: str = "dial") -> None:
    """Add readings to a record."""
    with Campaign.open(file) as campaign:
        campaign.adopt(tuple(replace(reading, setup=setup) for reading in readings))


def values(file: Path) -> list[tuple[str, float]]:
    """Return what has been read, in the order of the record."""
    with Campaign.open(file, write=False) as campaign:
        assert [reading.number for reading in campaign.state.readings] == [*range(1, len(campaign.state.readings) + 1)]
        return [(reading.setup, reading.value) for reading in campaign.state.readings]


def test_a_branch_is_taken_over_once_and_what_it_has_read_since_later(
    main: Path, branch: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    read(main, read_on(1)[6:8], "laser")
    read(branch, read_on(1)[8:11])
    before, there = values(main), values(branch)
    assert run(["adopt", str(main), str(branch)]) == 0
    assert values(main) == before + there[6:]
    assert run(["adopt", str(main), str(branch)]) == 0
    assert "has no reading that is not here" in capsys.readouterr().out
    read(branch, read_on(1)[11:13])
    assert run(["adopt", str(main), str(branch), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["taken"] == 2
    assert values(main) == before + values(branch)[6:]
    assert values(branch)[:9] == there
    with Campaign.open(main, write=False) as campaign:
        assert campaign.known().accuracy.rms > 0


def test_what_was_taken_back_here_is_said_and_taken_once_more_where_asked(
    main: Path, branch: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    read(branch, read_on(1)[8:11])
    there = values(branch)
    assert run(["adopt", str(main), str(branch)]) == 0
    for _ in range(2):
        assert run(["undo", str(main)]) == 0
    capsys.readouterr()
    assert run(["adopt", str(main), str(branch)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "no reading that was not taken over before" in said
    assert "2 readings of it were taken over and taken back here since; --again takes them once more" in said
    assert values(main) == there[:7]
    assert run(["adopt", str(main), str(branch), "--again"]) == 0
    assert values(main) == there
    assert "taken back here" not in capsys.readouterr().out
    assert run(["adopt", str(main), str(branch), "--again", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["taken"], document["taken_back_here"]) == (0, 0)


def test_what_two_have_read_with_one_set_up_is_a_question_for_a_person(
    main: Path, branch: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    read(main, read_on(1)[6:7], "laser")
    read(branch, read_on(1)[7:9], "laser")
    held = main.read_bytes()
    assert run(["adopt", str(main), str(branch)]) == 1
    assert "the same set-up, laser" in " ".join(capsys.readouterr().err.split())
    assert main.read_bytes() == held
    assert run(["adopt", str(main), str(branch), "--same-mounting"]) == 0
    assert len(values(main)) == 9


@pytest.mark.parametrize("question", [[], ["--same-mounting"]])
def test_readings_that_come_back_are_not_counted_twice(
    main: Path, branch: Path, question: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    read(branch, read_on(1)[8:11])
    own = values(branch)
    third = branch.with_name("third.axiscal")
    third.write_bytes(branch.read_bytes())
    read(third, read_on(1)[11:12], "laser")
    assert run(["adopt", str(main), str(branch)]) == 0
    assert run(["adopt", str(branch), str(main), *question]) == 0
    assert "has no reading that is not here" in " ".join(capsys.readouterr().out.split())
    assert values(branch) == own
    assert run(["adopt", str(main), str(third), "--same-mounting"]) == 0  # which began with those of the branch
    assert values(main) == own + values(third)[9:]


def test_of_two_that_left_one_branch_nothing_is_lost_and_nothing_counts_twice(main: Path, branch: Path) -> None:
    before = values(main)
    read(branch, read_on(1)[8:11])
    third = branch.with_name("third.axiscal")
    third.write_bytes(branch.read_bytes())
    read(branch, read_on(1)[11:13])
    read(third, read_on(1)[13:16])
    assert run(["adopt", str(main), str(branch)]) == 0
    assert run(["adopt", str(main), str(third), "--same-mounting"]) == 0
    assert values(main) == before + values(branch)[6:] + values(third)[9:]


def test_another_campaign_a_copy_and_an_ended_one_are_sentences(
    main: Path, branch: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = write_record(tmp_path / "other.axiscal", slide(serial="other"), read_on(2))
    assert run(["adopt", str(main), str(other)]) == 1
    assert "no branch of this campaign" in " ".join(capsys.readouterr().err.split())
    assert run(["adopt", str(main), str(branch)]) == 0
    assert "no reading that is not here" in " ".join(capsys.readouterr().out.split())
    assert run(["undo", str(branch)]) == 0
    read(branch, read_on(1)[8:9])
    capsys.readouterr()
    with Campaign.open(main) as campaign:
        campaign.finish("done")
    assert run(["adopt", str(main), str(branch)]) == 1
    assert "The campaign is finished" in " ".join(capsys.readouterr().err.split())
    assert run(["undo", str(main)]) == 0
    capsys.readouterr()
    assert run(["adopt", str(main), str(branch)]) == 0
    said = capsys.readouterr().out
    assert "took back reading 6" in " ".join(said.split())
