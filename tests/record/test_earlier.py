"""Records of before open to what they held, go on in today's form, and keep what they were beside."""

import gzip
import hashlib
from pathlib import Path
from unittest.mock import Mock

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.repairing import repaired
from axiscal.estimation.inheritance import last_estimation
from axiscal.exceptions import RecordError
from axiscal.present.answer_of_campaign import answered, standing_answer
from axiscal.record.carried import carried_text
from axiscal.record.store import Record
from benchmarks.reliability.record_faults import recorded, values
from tests.generators.plain_records import NONE, OLD_START, old_record, story, values_in

SAID = pytest.approx((-3908.36, 748.592), rel=1e-5)
"""urad, the angle of a printed square and its U: in result.json of the version that began the record."""
SQUARE = gzip.decompress((Path(__file__).with_name("earlier") / "halved-lengths.axiscal.gz").read_bytes())
"""Of form 3, three lengths measured by calipers, half of each length at each of its ends."""
STORY = story(4)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A record of form 3."""
    (tmp_path / "mill.axiscal").write_bytes(old_record(STORY))
    return tmp_path / "mill.axiscal"


def chain() -> str:
    """Return what the story is called."""
    found = NONE
    for line in STORY:
        found = hashlib.sha256(f"{found} {line.kind} {line.said}".encode()).hexdigest()
    return found


@pytest.mark.parametrize("form", [2, 3])
def test_it_opens_to_what_it_held_and_nothing_is_written(path: Path, form: int) -> None:
    if form == 2:  # whose first block says less
        path.write_bytes(second_form() + path.read_bytes()[4096:])
    before = path.read_bytes()
    with Record.open(path, write=False) as record:
        assert (values(path), record.name) == (values_in(STORY), chain())
        assert [(row.at, row.kind, row.payload) for row in record.rows] == [tuple(line) for line in STORY]
    assert path.read_bytes() == before
    assert [each.name for each in path.parent.iterdir()] == [path.name]


def second_form() -> bytes:
    """Return the first block of form 2: that of form 3 without its guard."""
    first = SQUARE[:4096].replace(b"3 160b968e", b"2 610ca618").replace(b"\x89\r\n\x1a\n\0\n", b"")
    return first[:-1].ljust(4095) + b"\n"


def test_the_first_entry_writes_it_anew_and_keeps_it_beside(path: Path) -> None:
    before = path.read_bytes()
    with Record.open(path) as one, Record.open(path) as other:
        assert one.append(recorded(1e-6, "along x")) == len(STORY) + 1
        assert other.append(recorded(2e-6, "along x")) == len(STORY) + 2
    assert values(path) == [*values_in(STORY), 1e-6, 2e-6]
    assert path.read_bytes()[:16] == b"axiscal record 4"
    (beside,) = (each for each in path.parent.iterdir() if each != path)
    assert (beside.suffix, beside.read_bytes()) == (".before", before)


def test_what_is_written_anew_keeps_its_permissions(path: Path) -> None:
    path.chmod(0o640)
    with Record.open(path) as record:
        record.append(recorded(1e-6, "along x"))
    repaired([path], path.with_name("new.axiscal"), lambda question: True)
    assert {each.stat().st_mode & 0o777 for each in path.parent.iterdir()} == {0o640}


def test_two_copies_that_went_on_apart_are_of_one_campaign(path: Path) -> None:
    """Its id follows from its first line, so that whoever goes on with it makes the same one."""
    copy, both = path.with_name("copy.axiscal"), path.with_name("both.axiscal")
    copy.write_bytes(path.read_bytes())
    for each, value in ((path, 1e-6), (copy, 2e-6)):
        with Record.open(each) as record:
            record.append(recorded(value, "along x"))
    repaired([path, copy], both, lambda question: True)
    assert sorted(values(both)[-2:]) == [1e-6, 2e-6]


def test_what_stands_behind_a_gap_is_asked_for_and_what_stands_before_is_not(path: Path) -> None:
    whole = path.read_bytes()
    at = whole.rindex(b'"reading":9,')
    path.write_bytes(whole[:at] + b"X" + whole[at + 1 :])
    with pytest.raises(RecordError, match="damaged"):
        Record.open(path)
    every = values_in(STORY)
    for taken, count in ((True, len(every) - 1), (False, 8)):
        asked = Mock(return_value=taken)
        found = repaired([path], path.with_name(f"{taken}.axiscal"), asked)
        assert [reading.value for reading in found.state.readings] == [*every[:8], *every[9:]][:count]
        assert (asked.call_count, found.missing[0]) == (1, "event 19" if taken else "events 19 to 61")


def test_lines_of_another_campaign_in_it_are_never_taken_unasked(path: Path) -> None:
    whole, other = path.read_bytes(), old_record(story(5, later=0.2))
    cut = whole.index(b"\n", OLD_START + 4000) + 1
    path.write_bytes(whole[:cut] + other[other.index(b"\n", OLD_START + 6000) + 1 :])
    with pytest.raises(RecordError, match="damaged"):
        Record.open(path)
    repaired([path], path.with_name("new.axiscal"), lambda question: False)
    assert set(values(path.with_name("new.axiscal"))) <= set(values_in(STORY))


def test_a_record_of_halved_lengths_says_what_it_said(tmp_path: Path) -> None:
    path = tmp_path / "square.axiscal"
    path.write_bytes(SQUARE)
    with Campaign.open(path) as campaign:
        assert len(campaign.state.readings) == 6
        (row, *_) = standing_answer(campaign).rows
    assert (row.signed[0].value, row.signed[0].U) == SAID
    assert path.read_bytes() == SQUARE


@pytest.mark.long
def test_what_it_leaves_the_next_campaign_is_the_same(tmp_path: Path) -> None:
    (tmp_path / "square.axiscal").write_bytes(SQUARE)
    ((_, row), *_) = answered(last_estimation(carried_text(tmp_path / "square.axiscal")), {})
    assert (row.signed[0].value, row.signed[0].U) == SAID
