"""Entries of next year's version: kept, passed on, named, and in the way of nothing but what needs them."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.cli.app import run
from axiscal.exceptions import NewerError
from axiscal.record.events import Newer, Noted
from axiscal.record.lines import EventText
from axiscal.record.store import Record
from tests.commands import Command
from tests.generators.begun import begun
from tests.generators.plain_records import CAMPAIGN, MACHINE

AT = "2028-03-01T08:00:00.000+00:00"
CALIBRATED = EventText(AT, "calibrated", '{"certificate":"K-17","due":"2029-03-01","instrument":"laser"}')
SIGNED = EventText(AT, "noted", '{"author":"Anna","text":"warm"}')
HARMLESS = (CALIBRATED, SIGNED)
STOPPING = (
    EventText(AT, "weighted", '{"reading":1,"weight":0.5}'),
    EventText(AT, "finished", '{"because":"enough","signed":"Anna"}'),
    EventText(
        AT, "recorded", '{"approach":[1],"humidity":0.4,"position":[0.1],"setup":"along x","std":null,"value":1e-6}'
    ),
)


def of(*rows: EventText) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("row", rows, ids=lambda row: row.kind)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A campaign with two readings."""
    files = {"machine.toml": MACHINE, "campaign.toml": CAMPAIGN.replace("500", "5")}  # a plan of a moment
    at = ("--setup", "along x", "--at", "X=100mm")
    begin, given = ("start", "campaign.toml", "mill.axiscal"), ("record", "mill.axiscal", "1.5 um", *at)
    begun(tmp_path, files, begin, given, given)
    return tmp_path / "mill.axiscal"


def written(path: Path, row: EventText) -> tuple[str, str]:
    """Let next year's version write an entry, and return what a log has to hold of it."""
    with Record.open(path) as record:
        record.extend([row])
    return row.kind, row.payload


def last(path: Path) -> tuple[str, str]:
    row = Record.open(path, write=False).rows[-1]
    return row.kind, row.payload


@of(*HARMLESS)
def test_the_state_goes_on_without_what_says_nothing_of_readings(path: Path, row: EventText) -> None:
    with Record.open(path, write=False) as record:
        before = record.state()
    written(path, row)
    with Record.open(path, write=False) as record:
        after = record.state()
    assert (after.readings, after.notes, after.plan) == (before.readings, before.notes, before.plan)
    assert after.newer == (Newer(row.kind, row.payload),)
    assert (after.last, len(after.readings)) == (before.last + 1, 2)


@of(*HARMLESS)
def test_people_are_told_of_it_and_nothing_is_written_behind_it(path: Path, row: EventText, command: Command) -> None:
    written(path, row)
    before = path.read_bytes()
    assert f"An entry of a newer version: {row.kind}" in command("status", path).printed
    assert command("status", path, "--json").document["newer"] == [row.kind]
    with Record.open(path) as record, pytest.raises(NewerError, match=f"newer version of axiscal.*{row.kind}"):
        record.append(Noted("by this version"))
    for words in (["note", path, "warm"], ["undo", path], ["finish", path, "--out", "out"]):
        assert "Install that version" in command(*words).refusal
    assert path.read_bytes() == before


@of(*STOPPING)
def test_what_may_say_something_of_readings_stops_what_needs_them(
    path: Path, row: EventText, capsys: pytest.CaptureFixture[str]
) -> None:
    written(path, row)
    with Record.open(path, write=False) as record, pytest.raises(NewerError, match=row.kind):
        record.state()
    assert run(["status", str(path)]) == 1
    said = capsys.readouterr().err
    assert "newer version" in said
    assert "damaged" not in said


@of(*HARMLESS, *STOPPING)
def test_a_copy_holds_it(path: Path, row: EventText, capsys: pytest.CaptureFixture[str]) -> None:
    entry = written(path, row)
    assert run(["copy", str(path)]) == 0
    assert ("holds 2 readings" if row in HARMLESS else "events") in capsys.readouterr().out
    assert last(path.with_name("mill.axiscal.copy")) == entry


def test_what_comes_behind_it_may_hang_on_it(path: Path) -> None:
    """A newer version may take its own entries back: that is no damage."""
    written(path, CALIBRATED)
    with Record.open(path, write=False) as record:
        number = record.last()
    written(path, EventText(AT, "undone", f'{{"event":{number}}}'))
    with Record.open(path, write=False) as record, pytest.raises(NewerError):
        record.state()


@pytest.mark.parametrize("payload", ["[1]", "7", "not json"])
def test_what_is_no_entry_at_all_is_damage(path: Path, payload: str) -> None:
    with Record.open(path) as record, pytest.raises(ValueError, match="calibrated"):
        record.extend([EventText(AT, "calibrated", payload)])
