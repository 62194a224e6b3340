"""Records of the first form: they are refused by name, and a tool brings all that they held into today's."""

import gzip
import sqlite3
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.exceptions import RecordError
from axiscal.record.store import Record
from tools.bring_first_form import BroughtError, bring

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


@pytest.mark.parametrize(("name", "kept"), [("closed.axiscal", CLOSED), ("left.axiscal", LEFT)])
def test_every_reading_is_brought_and_the_old_record_stays(name: str, kept: tuple[float, ...], tmp_path: Path) -> None:
    path = earlier(name, tmp_path)
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    bring(path, tmp_path / "new.axiscal")
    after = {file.name: file.read_bytes() for file in tmp_path.iterdir() if file.name != "new.axiscal"}
    assert after == before
    with Campaign.open(tmp_path / "new.axiscal") as campaign:
        assert tuple(reading.value for reading in campaign.state.readings) == kept
        assert [gap.reason for gap in campaign.state.skipped] == ["the beam is blocked"]


def test_a_record_of_the_first_form_is_refused_with_the_tool_that_brings_it(tmp_path: Path) -> None:
    path = earlier("closed.axiscal", tmp_path)
    with pytest.raises(RecordError, match=r"first form.*tools/bring_first_form\.py"):
        Record.open(path)


def test_a_log_of_another_state_takes_nothing_back(tmp_path: Path) -> None:
    path = earlier("closed.axiscal", tmp_path)
    earlier("left.axiscal", tmp_path).with_name("left.axiscal-wal").rename(tmp_path / "closed.axiscal-wal")
    with pytest.raises(BroughtError, match=r"closed\.axiscal-wal beside it is of another state"):
        bring(path, tmp_path / "new.axiscal")


def test_what_is_no_entry_or_torn_is_named(tmp_path: Path) -> None:
    path = earlier("closed.axiscal", tmp_path)
    content = path.read_bytes()
    path.write_bytes(content[:5000] + bytes(3000) + content[8000:])
    with pytest.raises(BroughtError):
        bring(path, tmp_path / "new.axiscal")
    path.write_bytes(content)
    payload = '{"setup":"laser along X","position":[0.1,0.1],"approach":[1,0],"value":1,"std":-1}'
    database = sqlite3.connect(path)
    database.execute("INSERT INTO events (kind, payload, at) VALUES ('recorded', ?, '')", (payload,))
    database.commit()
    database.close()
    with pytest.raises(BroughtError, match=r"std: .* greater than 0"):
        bring(path, tmp_path / "new.axiscal")
    assert not (tmp_path / "new.axiscal").exists()
