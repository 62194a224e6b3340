"""Head and marks of an older copy before newer lines: what was acknowledged stands, and no next entry cuts it off."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Reading
from axiscal.record.events import Recorded
from axiscal.record.line_form import head
from axiscal.record.store import Record
from tests.generators.plain_records import PlainLine, front, lines_in, story, values_in, written_lines

LINES = story(1, count=4)


def older(count: int) -> bytes:
    """Return the record with the marks that it had when it held so many lines."""
    lines = written_lines(LINES)
    return front(head(), lines[:count]) + b"".join(lines)


@pytest.mark.parametrize("count", range(1, len(LINES)))
def test_whole_lines_behind_the_marks_count_and_the_next_entry_leaves_them(count: int, tmp_path: Path) -> None:
    path = tmp_path / "mill.axiscal"
    path.write_bytes(older(count))
    with Record.open(path, write=False) as record:
        assert [reading.value for reading in record.state().readings] == values_in(LINES)
    for value in (7e-6, 8e-6):
        with Record.open(path) as record:
            record.append(Recorded(Reading("along x", (0.1,), (1,), value)))
    assert values_in(lines_in(path.read_bytes())) == [*values_in(LINES), 7e-6, 8e-6]


def test_what_nobody_finished_writing_is_cut_off_and_whole_lines_behind_it_are_damage(tmp_path: Path) -> None:
    path, content = tmp_path / "mill.axiscal", older(4)
    path.write_bytes(content[:-20])
    with Record.open(path) as record:
        record.append(Recorded(Reading("along x", (0.1,), (1,), 7e-6)))
    assert values_in(lines_in(path.read_bytes())) == [*values_in(LINES)[:-1], 7e-6]
    at = len(content) - len(b"".join(written_lines(LINES)[5:])) - 30
    damaged = content[:at] + b"#" + content[at + 1 :]
    path.write_bytes(damaged)
    with pytest.raises(RecordError, match="whole lines stand behind event 4"):
        Record.open(path)
    strange = content + written_lines([*LINES[:2], PlainLine(LINES[2].at, "noted", '{"text":"of another one"}')])[2]
    path.write_bytes(strange)
    with pytest.raises(RecordError, match="do not follow from it"):
        Record.open(path)
    assert path.read_bytes() == strange
