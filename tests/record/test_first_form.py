"""Records that earlier versions wrote: they open with all they held, and go on in today's form."""

from __future__ import annotations

import gzip
import sqlite3
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.exceptions import RecordError
from axiscal.record.events import Recorded, Stored
from axiscal.record.line_form import FORM, SQLITE, form_of
from axiscal.record.store import Record

EARLIER = Path(__file__).with_name("earlier")
CLOSED = (3.333333333333333e-07, 6.666666666666666e-07, 1.3333333333333332e-06, 2.5e-06)
"""What the one was closed with: the first five questions, the third skipped, the last taken back and read again."""
LEFT = CLOSED[:3]
"""What another held when it was copied together with its log, while it was open: four questions, the third skipped."""


def earlier(name: str, folder: Path) -> Path:
    for packed in EARLIER.glob(f"form1-{name}*.gz"):
        (folder / packed.name.removeprefix("form1-").removesuffix(".gz")).write_bytes(
            gzip.decompress(packed.read_bytes())
        )
    return folder / name


def values(stored: tuple[Stored, ...]) -> list[float]:
    return [each.event.reading.value for each in stored if isinstance(each.event, Recorded)]


@pytest.mark.parametrize(("name", "kept"), [("closed.axiscal", CLOSED), ("left.axiscal", LEFT)])
@pytest.mark.parametrize("write", [False, True])
def test_an_earlier_record_opens_with_every_reading(
    name: str, kept: tuple[float, ...], write: bool, tmp_path: Path
) -> None:
    path = earlier(name, tmp_path)
    with Campaign.open(path, write=write) as campaign:
        assert tuple(reading.value for reading in campaign.state.readings) == kept
        assert [gap.reason for gap in campaign.state.skipped] == ["the beam is blocked"]
    assert form_of(path.read_bytes()) == (FORM if write else SQLITE)


def test_looking_leaves_an_earlier_record_as_it_is(tmp_path: Path) -> None:
    path = earlier("left.axiscal", tmp_path)
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    Record.open(path, write=False).close()
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before


def test_an_earlier_record_has_the_same_name_before_and_after_it_goes_on(tmp_path: Path) -> None:
    path = earlier("left.axiscal", tmp_path)
    with Record.open(path, write=False) as record:
        before, events = record.name, record.events()
    with Record.open(path) as record:
        assert (record.name, record.events()) == (before, events)
    assert [file.name for file in tmp_path.iterdir()] == ["left.axiscal"]
    with Campaign.open(path) as campaign:
        campaign.next()
        campaign.record(1e-6)
    with Record.open(path, write=False) as record:
        assert values(record.events()) == [*LEFT, 1e-6]


@pytest.mark.parametrize("write", [False, True])
def test_a_log_of_another_state_beside_an_earlier_record_takes_nothing_back(write: bool, tmp_path: Path) -> None:
    path = earlier("closed.axiscal", tmp_path)
    log = earlier("left.axiscal", tmp_path).with_name("left.axiscal-wal").rename(tmp_path / "closed.axiscal-wal")
    before = path.read_bytes()
    with pytest.raises(RecordError, match=r"damaged: closed\.axiscal-wal beside it is of another state.*move it away"):
        Record.open(path, write=write)
    assert (path.read_bytes(), log.exists()) == (before, True)
    log.unlink()
    with Record.open(path, write=write) as record:
        assert set(CLOSED) <= set(values(record.events()))


def test_an_impossible_entry_of_an_earlier_record_is_named(tmp_path: Path) -> None:
    path = earlier("closed.axiscal", tmp_path)
    database = sqlite3.connect(path)
    (count,) = database.execute("SELECT count(*) FROM events").fetchone()
    payload = '{"setup":"laser along X","position":[0.1,0.1],"approach":[1,0],"value":1,"std":-1}'
    database.execute("INSERT INTO events (kind, payload, at) VALUES ('recorded', ?, '')", (payload,))
    database.commit()
    database.close()
    with pytest.raises(RecordError, match=f"damaged: event {count + 1}: .*no standard deviation"):
        Record.open(path)


def test_an_earlier_record_with_torn_pages_is_damaged_and_left_alone(tmp_path: Path) -> None:
    path = earlier("closed.axiscal", tmp_path)
    content = path.read_bytes()
    path.write_bytes(content[:5000] + bytes(3000) + content[8000:])
    before = path.read_bytes()
    with pytest.raises(RecordError, match="damaged"):
        Record.open(path)
    assert path.read_bytes() == before


def test_a_byte_of_an_earlier_record_that_is_no_text_is_damage(tmp_path: Path) -> None:
    path = earlier("closed.axiscal", tmp_path)
    content = path.read_bytes()
    path.write_bytes(content.replace(b"ABORT", b"ABOR\xd4"))
    with pytest.raises(RecordError, match="damaged"):
        Record.open(path)
