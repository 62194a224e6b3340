"""The index of a folder says what its records say, reads only what is new, and can be thrown away."""

from __future__ import annotations

import os
import random
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Reading
from axiscal.record.events import Created, Recorded
from axiscal.record.folder_index import INDEX, FolderIndex
from axiscal.record.store import Record


def begun(path: Path, machine: str, readings: int) -> Path:
    """Return a new record with so many readings."""
    with Record.create(path, Created(f"name = '{machine}'", "", "machine.toml", "campaign.toml", {})) as record:
        record.append(*(Recorded(Reading("laser", (0.1 * n,), (1,), 1e-6)) for n in range(readings)))
    return path


def went_on(path: Path, value: float = 2e-6) -> None:
    """Add a reading to a record."""
    with Record.open(path) as record:
        record.append(Recorded(Reading("laser", (0.1,), (1,), value)))


def refreshed(folder: Path) -> tuple[list[str], dict[str, tuple[str, str, int]]]:
    """Return which records were read, and what the index says of each: fault, chain, last event."""
    told = list[str]()
    with FolderIndex.open(folder) as index:
        index.refresh(told.append)
        return told, {each.file.name: (each.fault, each.chain, each.last) for each in index.records()}


def said_by_records(folder: Path) -> dict[str, tuple[str, str, int]]:
    """Return the same from the records themselves."""
    found = dict[str, tuple[str, str, int]]()
    for path in folder.glob("*.axiscal"):
        with Record.open(path, write=False) as record:
            found[path.name] = "", record.name, record.last()
    return found


def test_a_name_need_not_be_text(tmp_path: Path) -> None:
    name = os.fsdecode(b"M\xfcller.axiscal")
    begun(tmp_path / name, "m", 1)
    assert refreshed(tmp_path) == ([name], said_by_records(tmp_path))
    assert refreshed(tmp_path)[0] == []


def test_an_index_that_another_program_holds_is_not_thrown_away(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun(tmp_path / "a.axiscal", "m", 2)
    refreshed(tmp_path)
    monkeypatch.setattr("axiscal.record.folder_index._PATIENCE", 0.01)
    with closing(sqlite3.connect(tmp_path / INDEX, isolation_level=None)) as other:
        other.execute("BEGIN EXCLUSIVE")
        with FolderIndex.open(tmp_path) as index:
            assert "database is locked" in index.why_apart
    assert refreshed(tmp_path)[0] == []


def test_a_full_disk_is_a_sentence(tmp_path: Path) -> None:
    with FolderIndex.open(tmp_path) as index:
        index._database.execute("PRAGMA max_page_count = 1")  # as full as it is
        begun(tmp_path / "a.axiscal", "m", 400)
        with pytest.raises(RecordError, match=r"cannot be written: database or disk is full"):
            index.refresh()
        assert index.records() == []


def test_only_what_is_new_is_read(tmp_path: Path) -> None:
    for number in range(3):
        begun(tmp_path / f"{number}.axiscal", f"m{number}", number + 1)
    told, found = refreshed(tmp_path)
    assert told == ["0.axiscal", "1.axiscal", "2.axiscal"]
    assert found == said_by_records(tmp_path)
    assert refreshed(tmp_path) == ([], found)
    went_on(tmp_path / "1.axiscal")
    (tmp_path / "0.axiscal").unlink()
    told, found = refreshed(tmp_path)
    assert told == ["1.axiscal"]
    assert found == said_by_records(tmp_path)
    (tmp_path / INDEX).unlink()
    assert refreshed(tmp_path)[1] == found


def test_all_events_can_be_asked_for_at_once(tmp_path: Path) -> None:
    for number in range(3):
        begun(tmp_path / f"{number}.axiscal", f"m{number}", 4)
    with FolderIndex.open(tmp_path) as index:
        index.refresh()
        assert [(kind.kind, kind.events) for kind in index.kinds()] == [("created", 3), ("recorded", 12)]
        assert all(kind.first <= kind.last for kind in index.kinds())


def test_a_record_that_was_put_in_the_place_of_another_is_read_anew(tmp_path: Path) -> None:
    begun(tmp_path / "a.axiscal", "one", 5)
    refreshed(tmp_path)
    (tmp_path / "a.axiscal").unlink()
    begun(tmp_path / "a.axiscal", "other", 2)
    assert refreshed(tmp_path)[1] == said_by_records(tmp_path)
    with FolderIndex.open(tmp_path) as index:
        assert sum(kind.events for kind in index.kinds()) == 3


@pytest.mark.parametrize("content", [b"", b"no database", b"SQLite format 3\0" + 500 * b"x"])
def test_an_index_that_is_none_is_made_anew(tmp_path: Path, content: bytes) -> None:
    begun(tmp_path / "a.axiscal", "one", 1)
    _, found = refreshed(tmp_path)
    (tmp_path / INDEX).write_bytes(content)
    assert refreshed(tmp_path) == (["a.axiscal"], found)
    with closing(sqlite3.connect(tmp_path / INDEX)) as other:
        other.execute("PRAGMA user_version = 99")
    assert refreshed(tmp_path) == (["a.axiscal"], found)


def test_an_index_torn_in_its_pages_is_made_anew(tmp_path: Path) -> None:
    begun(tmp_path / "a.axiscal", "one", 200)
    _, found = refreshed(tmp_path)
    content = bytearray((tmp_path / INDEX).read_bytes())
    content[4096:12288] = os.urandom(8192)
    (tmp_path / INDEX).write_bytes(content)
    assert refreshed(tmp_path) == (["a.axiscal"], found)


@pytest.mark.parametrize(
    "change",
    [
        *(f"DROP TABLE {table}" for table in ("records", "events", "findings")),
        "ALTER TABLE events RENAME COLUMN payload TO other",
        "ALTER TABLE findings ADD COLUMN other",
    ],
)
def test_an_index_with_other_tables_is_made_anew(tmp_path: Path, change: str) -> None:
    begun(tmp_path / "a.axiscal", "one", 3)
    _, found = refreshed(tmp_path)
    with closing(sqlite3.connect(tmp_path / INDEX, isolation_level=None)) as other:
        other.execute(change)
    assert refreshed(tmp_path) == (["a.axiscal"], found)


@pytest.mark.parametrize(
    "change",
    [
        *(f"UPDATE events SET {change} WHERE number = 2" for change in ("at = '2020-01-01'", "kind = 'undone'")),
        *(f"UPDATE events SET {change} WHERE number = 2" for change in ("number = 9", "chain = 'x'")),
        "UPDATE events SET file = x'ff' WHERE number = 2 AND file < x'62'",
        "UPDATE events SET payload = replace(payload, '1', '2') WHERE number = 2",
        "DELETE FROM events WHERE number = 2",
        "INSERT INTO events SELECT file, 9, at, kind, payload, chain FROM events WHERE number = 2",
        *(f"UPDATE records SET {change}" for change in ("campaign = 'x'", "chain = 'x'", "last = 7", "fault = 'torn'")),
        "UPDATE records SET digest = NULL",
        "DELETE FROM records",
    ],
)
def test_what_the_index_says_and_nobody_wrote_is_not_believed(tmp_path: Path, change: str) -> None:
    for name in ("a.axiscal", "b.axiscal"):
        begun(tmp_path / name, name, 3)
    refreshed(tmp_path)
    before = _said(tmp_path)
    with closing(sqlite3.connect(tmp_path / INDEX, isolation_level=None)) as other:
        other.execute(change)
    assert _said(tmp_path) == before


def test_a_bit_of_the_index_that_changes_is_never_believed(tmp_path: Path) -> None:
    begun(tmp_path / "a.axiscal", "m", 2)
    before, path, dice = _said(tmp_path), tmp_path / INDEX, random.Random(5)
    content = path.read_bytes()
    begin = content.index(b"CREATE TABLE")
    tables = [8 * place + 7 for place in range(begin - 60, begin + 100)]  # what is no text in SQLite's own words
    for bit in [*tables, *(dice.randrange(8 * len(content)) for _ in range(200))]:
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << bit % 8
        path.write_bytes(flipped)
        assert _said(tmp_path) == before


def _said(folder: Path) -> object:
    with FolderIndex.open(folder) as index:
        index.refresh()
        return index.records(), index.kinds()


@pytest.mark.parametrize("value", ["NULL", "''", "7", "x'ff'", "CAST(x'ff' AS TEXT)", "replace(answer, '7', '8')"])
def test_an_answer_that_is_not_what_was_kept_is_none(tmp_path: Path, value: str) -> None:
    with FolderIndex.open(tmp_path) as index:
        index.keep("chain", "how far", '{"rms": 7}')
        index.keep("chain", "how long", "")
        assert index.found("chain", "how far") == '{"rms": 7}'
        assert index.found("chain", "how long") == ""
        assert index.found("another", "how far") is None
    with closing(sqlite3.connect(tmp_path / INDEX, isolation_level=None)) as other:
        other.execute(f"UPDATE findings SET answer = {value} WHERE question = 'how far'")
        other.execute("UPDATE findings SET question = 'how many' WHERE question = 'how long'")
    with FolderIndex.open(tmp_path) as index:
        assert index.found("chain", "how far") is None
        assert index.found("chain", "how many") is None
        index.keep("chain", "how far", "8")
        assert index.found("chain", "how far") == "8"


def test_where_it_cannot_be_written_it_is_done_without(tmp_path: Path) -> None:
    begun(tmp_path / "a.axiscal", "one", 1)
    (tmp_path / INDEX).mkdir()
    with FolderIndex.open(tmp_path) as index:
        index.refresh()
        assert "cannot be kept" in index.why_apart
        assert len(index.records()) == 1


def test_while_another_program_writes_it_is_done_without(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun(tmp_path / "a.axiscal", "one", 1)
    refreshed(tmp_path)
    went_on(tmp_path / "a.axiscal")
    monkeypatch.setattr("axiscal.record.folder_index._PATIENCE", 0.05)
    with closing(sqlite3.connect(tmp_path / INDEX, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        with FolderIndex.open(tmp_path) as index:
            index.refresh()
            assert "locked" in index.why_apart
            assert index.records()[0].last == 3
    assert refreshed(tmp_path)[0] == ["a.axiscal"]


def test_damage_is_said_and_tried_again(tmp_path: Path) -> None:
    path = begun(tmp_path / "a.axiscal", "one", 3)
    good = path.read_bytes()
    path.write_bytes(good[:-40])
    _, found = refreshed(tmp_path)
    assert "damaged" in found["a.axiscal"][0]
    path.write_bytes(good)
    assert refreshed(tmp_path)[1] == said_by_records(tmp_path)
    with pytest.raises(RecordError, match="no folder"):
        FolderIndex.open(path)


def test_where_two_records_of_a_campaign_part(tmp_path: Path) -> None:
    one = begun(tmp_path / "a.axiscal", "one", 3)
    (tmp_path / "b.axiscal").write_bytes(one.read_bytes())
    went_on(one, 1e-6)
    went_on(tmp_path / "b.axiscal", 3e-6)
    with FolderIndex.open(tmp_path) as index:
        index.refresh()
        first, second = index.records()
        assert first.campaign == second.campaign
        assert index.parting(first, second) == 5
