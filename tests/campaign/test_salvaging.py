"""A new record of what stands whole: what is missing is named, nothing is mixed, and nothing is written over."""

from __future__ import annotations

import json
import zlib
from pathlib import Path

import pytest

from axiscal.campaign.possible import beginning_of
from axiscal.campaign.salvaging import Salvaged, salvaged
from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts
from axiscal.exceptions import NewerError, RecordError
from axiscal.measurement.reading import Reading
from axiscal.record.accepted import Accepted
from axiscal.record.events import Asked, Event, Finished, Recorded, Skipped, Undone
from axiscal.record.line_form import BLOCK, MARK, MARKS, START, EventText
from axiscal.record.store import Record
from tests.commands import Command
from tests.reliability.salvaged import CAMPAIGN, MACHINE, Line, lines_of

DESCRIPTION = campaign_from_texts(CAMPAIGN, "campaign.toml", MACHINE, "machine.toml")


def recorded(value: float) -> Recorded:
    return Recorded(Reading("along x", (0.1,), (1,), value))


def made(path: Path, *events: Event) -> Path:
    with Record.create(path, beginning_of(DESCRIPTION)) as record:
        for event in events:
            record.append(event)
    return path


def without(path: Path, *numbers: int) -> list[Line]:
    """Change a bit in each of these events of a record, and return its lines as they were."""
    content = bytearray(path.read_bytes())
    lines = list(lines_of(bytes(content)))
    for number in numbers:
        content[lines[number - 1].end - 12] ^= 1
    path.write_bytes(content)
    return lines


def values(found: Salvaged) -> list[float]:
    return [reading.value for reading in found.state.readings]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "mill.axiscal"


@pytest.fixture
def new(tmp_path: Path) -> Path:
    return tmp_path / "new.axiscal"


def test_what_is_taken_back_has_another_number_now(path: Path, new: Path) -> None:
    made(path, recorded(1e-6), recorded(2e-6), recorded(3e-6), Undone(4), recorded(4e-6))
    without(path, 2)
    assert values(salvaged(path, new)) == [2e-6, 4e-6]


def test_a_taking_back_of_what_is_missing_is_left_out(path: Path, new: Path) -> None:
    made(path, recorded(1e-6), recorded(2e-6), Undone(3), recorded(4e-6))
    without(path, 3)
    found = salvaged(path, new)
    assert (values(found), found.left) == ([1e-6, 4e-6], ("event 4 (undone): what it takes back is missing",))


def test_what_must_have_been_taken_back_does_not_stand(path: Path, new: Path) -> None:
    """The second reading: only so could the first one be taken back. The end: only so could readings follow."""
    made(path, recorded(1e-6), recorded(2e-6), Undone(3), Undone(2), Finished("enough"), Undone(6), recorded(4e-6))
    without(path, 4, 7)
    found = salvaged(path, new)
    assert (values(found), found.state.finished) == ([4e-6], None)
    why = "what follows shows that it was taken back"
    assert found.left == (f"event 3 (recorded): {why}", f"event 6 (finished): {why}")


def test_a_skip_without_its_question_is_left_out(path: Path, new: Path) -> None:
    made(path, recorded(1e-6), Asked(2, recorded(0).reading.place), Skipped("blocked"), recorded(2e-6))
    without(path, 3)
    found = salvaged(path, new)
    assert values(found) == [1e-6, 2e-6]
    assert [words[:17] for words in found.left] == ["event 4 (skipped)"]


def test_a_mistake_that_was_accepted_is_left_out_where_readings_may_be_missing(path: Path, new: Path) -> None:
    mistake = Accepted("sign", ("along x",), factor=-1.0)
    made(path, recorded(1e-6), recorded(2e-6), mistake)
    assert values(salvaged(path, new)) == [-1e-6, -2e-6]
    without(path, 2)
    found = salvaged(path, new.with_name("second.axiscal"))
    assert (values(found), len(found.left)) == ([2e-6], 1)


def test_the_tail_and_the_marks_may_be_gone(path: Path, new: Path) -> None:
    made(path, *(recorded(1e-6 * number) for number in range(1, 9)))
    content, lines = path.read_bytes(), lines_of(path.read_bytes())
    path.write_bytes(content[: lines[6].begin + 50])
    found = salvaged(path, new)
    named, unborne = found.missing
    assert (len(values(found)), named) == (5, f"events 7 to 9 (bytes {lines[6].begin} to {len(content)})")
    assert unborne.startswith("event 9 as a mark names it")
    blank = MARK * b" "
    for at in MARKS:
        content = content[:at] + blank + content[at + MARK :]
    path.write_bytes(content)
    found = salvaged(path, new.with_name("second.axiscal"))
    assert (len(values(found)), len(found.missing)) == (8, 1)
    assert "both marks" in found.missing[0]


@pytest.mark.parametrize("lines", [3, 4, 5])
def test_the_beginning_of_another_record_is_not_put_before_the_rest(
    path: Path, new: Path, tmp_path: Path, lines: int
) -> None:
    """Both are of one machine with one description, so only the chain tells their readings apart."""
    made(path, *(recorded(1e-6 * number) for number in range(1, 9)))
    other = made(tmp_path / "other.axiscal", *(recorded(1e-5 + 1e-6 * number) for number in range(1, 9)))
    with Record.open(path, write=False) as record:
        first = record.texts()[0].row
    cut = lines_of(other.read_bytes())[lines].begin - 40
    behind = [line for line in lines_of(path.read_bytes()) if line.begin >= cut]
    path.write_bytes(path.read_bytes()[:START] + other.read_bytes()[START:cut] + path.read_bytes()[cut:])
    with pytest.raises(RecordError, match=r"Event 1.*does not stand whole"):
        salvaged(path, new)
    assert not new.exists()
    found = salvaged(path, new, first)
    assert values(found) == [json.loads(line.payload)["value"] for line in behind]
    assert any("may be of another file" in words for words in found.missing)


def test_lines_of_another_record_behind_head_and_marks_are_refused_and_both_are_named(
    path: Path, new: Path, tmp_path: Path
) -> None:
    made(path, *(recorded(1e-6 * number) for number in range(1, 5)))
    other = made(tmp_path / "other.axiscal", *(recorded(1e-5 + 1e-6 * number) for number in range(1, 9)))
    with Record.open(path, write=False) as own, Record.open(other, write=False) as theirs:
        first, mark, line, begun = (
            own.texts()[0].row,
            own.name[:12],
            theirs.texts()[4].chain[:12],
            theirs.texts()[0].row,
        )
    path.write_bytes(path.read_bytes()[:START] + other.read_bytes()[START:])
    with pytest.raises(RecordError, match=f"two records: event 5 is {mark} by the marks and {line} by the lines.*"):
        salvaged(path, new)
    with pytest.raises(RecordError, match="No entry of a record stands whole"):
        salvaged(path, new, first._replace(at="2026-01-01T00:00:00.000+00:00"))
    assert len(values(salvaged(path, new, begun))) == 8


def test_what_an_editor_changed_is_undone_and_said(path: Path, new: Path) -> None:
    made(path, *(recorded(1e-6 * number) for number in range(1, 5)))
    whole = path.read_bytes()
    lines = whole[START:].splitlines(keepends=True)
    path.write_bytes(whole[:START].replace(b"\n", b"\r\n") + b"".join([*lines[:2], *lines[3:], lines[2], lines[2]]))
    with pytest.raises(RecordError, match="took it for text"):
        Record.open(path)
    found = salvaged(path, new)
    assert (values(found), found.missing, found.left) == ([1e-6, 2e-6, 3e-6, 4e-6], (), ())
    assert [words.partition(",")[0] for words in found.seams] == [
        "lines stood in another order",
        "1 lines stood there twice",
        "line ends or blanks were changed",
    ]


def test_readings_of_two_who_went_on_from_one_event_come_all_and_the_end_stays_the_end(path: Path, new: Path) -> None:
    made(path, recorded(1e-6), recorded(2e-6))
    shared = path.read_bytes()
    with Record.open(path) as record:
        record.append(recorded(3e-6))
        record.append(Finished("enough"))
    mine = path.read_bytes()
    path.write_bytes(shared)
    with Record.open(path) as record:
        for event in (recorded(4e-6), recorded(5e-6), Undone(5)):
            record.append(event)
    path.write_bytes(mine + path.read_bytes()[len(shared) :])
    found = salvaged(path, new)
    assert (values(found), found.state.finished) == ([1e-6, 2e-6, 3e-6, 4e-6], "enough")
    assert [words.partition(":")[0] for words in found.seams] == ["two went on from event 3"]


@pytest.fixture
def beheaded(path: Path) -> tuple[Path, EventText]:
    """A record whose first event is wiped, and that event."""
    made(path, recorded(1e-6), recorded(2e-6))
    with Record.open(path, write=False) as record:
        first = record.texts()[0].row
    content = path.read_bytes()
    path.write_bytes(content[:START] + bytes(512) + content[START + 512 :])
    return path, first


def test_without_its_beginning_a_record_needs_one(beheaded: tuple[Path, EventText], new: Path) -> None:
    path, first = beheaded
    with pytest.raises(RecordError, match=r"Event 1.*2 readings stand.*--beginning"):
        salvaged(path, new)
    found = salvaged(path, new, first)
    assert (values(found), found.missing) == ([1e-6, 2e-6], ("event 1, which is that of another file",))


def test_the_command_takes_it_from_a_copy_or_the_description(
    beheaded: tuple[Path, EventText], tmp_path: Path, command: Command
) -> None:
    path, first = beheaded
    copy = tmp_path / "copy.axiscal"
    Record.made(copy, [first]).close()
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    for beginning in (copy, tmp_path / "campaign.toml"):
        new = tmp_path / f"from-{beginning.stem}.axiscal"
        assert "holds 2 readings, from 3 events" in command("salvage", path, new, "--beginning", beginning).printed
        assert "2 readings" in command("status", new).printed


def test_a_damaged_record_names_the_command_and_it_writes_over_nothing(
    path: Path, tmp_path: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    made(path, *(recorded(1e-6 * number) for number in range(1, 9)))
    without(path, 5)
    damaged = path.read_bytes()
    new = tmp_path / "mill-salvaged.axiscal"
    for name in ("status", "copy"):
        assert f"axiscal data salvage {path} {new};" in command(name, path).refusal
    said = command("salvage", path, new, "--json").document
    assert (said["readings"], said["events"], len(said["missing"]), said["left_out"]) == (7, 8, 1, [])
    kept = new.read_bytes()
    assert run(["status", str(new), "--details"]) == run(["copy", str(new)]) == 0
    assert ": salvaged from mill.axiscal, 8 events" in capsys.readouterr().out
    assert "exists already" in command("salvage", path, new).refusal
    assert (path.read_bytes(), new.read_bytes()) == (damaged, kept)


def test_an_event_that_cannot_be_is_left_out(path: Path, new: Path) -> None:
    made(path, recorded(1e-6), Recorded(Reading("along x", (7.0,), (1,), 2e-6)))
    found = salvaged(path, new)
    assert (values(found), found.left) == ([1e-6], ("event 3 (recorded): X = 7000 mm is outside the travel",))


def test_an_entry_of_a_newer_version_comes_along_unless_it_says_something_of_readings(path: Path, new: Path) -> None:
    made(path, recorded(1e-6))
    at = "2028-03-01T08:00:00.000+00:00"
    with Record.open(path) as record:
        record.extend([EventText(at, "calibrated", '{"instrument":"laser"}')])
    assert [each.kind for each in salvaged(path, new).state.newer] == ["calibrated"]
    with Record.open(path) as record:
        record.extend([EventText(at, "weighted", '{"reading":1}')])
    with pytest.raises(NewerError, match="weighted"):
        salvaged(path, new.with_name("second.axiscal"))


def test_half_a_transaction_does_not_stand_unless_a_mark_counts_it(path: Path, new: Path) -> None:
    made(path, recorded(1e-6))
    whole = path.read_bytes()
    with Record.open(path) as record:
        batch: list[Event] = [recorded(2e-6), recorded(3e-6)]
        record.append(*batch)
    half = path.read_bytes()[: lines_of(path.read_bytes())[2].end]
    path.write_bytes(half)
    assert values(salvaged(path, new)) == [1e-6, 2e-6]
    path.write_bytes(whole[:START] + half[START:])
    assert values(salvaged(path, new.with_name("second.axiscal"))) == [1e-6]


def test_a_file_without_a_whole_entry_or_of_a_form_to_come_is_refused(path: Path, new: Path) -> None:
    whole = made(path).read_bytes()
    for content in (b"", whole[:START]):
        path.write_bytes(content)
        with pytest.raises(RecordError, match="No entry"):
            salvaged(path, new)
    title = b"axiscal record 9"
    path.write_bytes(title + b" %08x\n" % zlib.crc32(title) + whole[BLOCK:])
    with pytest.raises(NewerError, match="form 9"):
        salvaged(path, new)
