"""A new record of what stands whole: each event keeps its number, what is missing is named, branches are asked for."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axiscal.campaign.possible import beginning_of
from axiscal.campaign.repairing import Repaired, repaired
from axiscal.cli import printing
from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts
from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Reading
from axiscal.record.accepted import Accepted
from axiscal.record.events import Asked, Event, Finished, Recorded, Skipped, Undone
from axiscal.record.store import Record
from tests.commands import Command
from tests.generators.plain_records import CAMPAIGN, HEAD, MACHINE

DESCRIPTION = campaign_from_texts(CAMPAIGN, "campaign.toml", MACHINE, "machine.toml")


def recorded(value: float) -> Recorded:
    return Recorded(Reading("along x", (0.1,), (1,), value))


def made(path: Path, *events: Event) -> Path:
    with Record.create(path, beginning_of(DESCRIPTION)) as record:
        for event in events:
            record.append(event)
    return path


def without(path: Path, *numbers: int) -> None:
    """Change a bit in each of these events of a record."""
    lines = path.read_bytes()[HEAD:].splitlines(keepends=True)
    for number in numbers:
        lines[number - 1] = lines[number - 1][:-9] + b"#" + lines[number - 1][-8:]
    path.write_bytes(path.read_bytes()[:HEAD] + b"".join(lines))


Repair = Callable[..., Repaired]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "mill.axiscal"


@pytest.fixture
def repair(path: Path, tmp_path: Path) -> Repair:
    """Repair the record into a new one, and forbid a question."""

    def given(name: str = "new", asked: Callable[[str], bool] = lambda question: 1 / 0 > 1, **named: str) -> Repaired:
        return repaired([path], tmp_path / f"{name}.axiscal", asked, **named)  # type: ignore[arg-type]

    return given


def values(found: Repaired) -> list[float]:
    return [reading.value for reading in found.state.readings]


def test_every_event_keeps_its_number(path: Path, repair: Repair) -> None:
    made(path, recorded(1e-6), recorded(2e-6), recorded(3e-6), Undone(4), recorded(4e-6))
    without(path, 2)
    found = repair()
    assert (values(found), found.missing) == ([2e-6, 4e-6], ("event 2",))
    assert Record.open(path.with_name("new.axiscal")).events()[5].event == recorded(4e-6)


def test_a_taking_back_of_what_is_missing_is_left_out(path: Path, repair: Repair) -> None:
    made(path, recorded(1e-6), recorded(2e-6), Undone(3), recorded(4e-6))
    without(path, 3)
    found = repair()
    assert values(found) == [1e-6, 4e-6]
    assert [words[:16] for words in found.left] == ["event 4 (undone)"]


def test_what_must_have_been_taken_back_does_not_stand(path: Path, repair: Repair) -> None:
    """The second reading: only so could the first one be taken back. The end: only so could readings follow."""
    made(path, recorded(1e-6), recorded(2e-6), Undone(3), Undone(2), Finished("enough"), Undone(6), recorded(4e-6))
    without(path, 4, 7)
    found = repair()
    assert (values(found), found.state.finished) == ([4e-6], None)
    why = "what follows shows that it was taken back"
    assert found.left == (f"event 3 (recorded): {why}", f"event 6 (finished): {why}")


def test_what_hangs_on_a_missing_event_is_left_out(path: Path, repair: Repair) -> None:
    place = recorded(0).reading.place
    made(path, recorded(1e-6), Asked(2, place), Skipped("blocked"), Accepted("sign", ("along x",), factor=-1.0))
    assert values(repair("whole")) == [-1e-6]
    without(path, 3)
    found = repair()
    assert values(found) == [1e-6]
    assert [words[:17] for words in found.left] == ["event 4 (skipped)", "event 5 (accepted"]


def test_an_event_that_cannot_be_is_left_out(path: Path, repair: Repair) -> None:
    made(path, recorded(1e-6), Recorded(Reading("along x", (7.0,), (1,), 2e-6)))
    found = repair()
    assert (values(found), found.left) == ([1e-6], ("event 3 (recorded): X = 7000 mm is outside the travel",))


def test_of_two_campaigns_one_has_to_be_named(path: Path, repair: Repair, tmp_path: Path) -> None:
    made(path, *(recorded(1e-6 * number) for number in range(1, 5)))
    other = made(tmp_path / "other.axiscal", *(recorded(1e-5 + 1e-6 * number) for number in range(1, 9)))
    path.write_bytes(path.read_bytes() + other.read_bytes()[HEAD:])
    with pytest.raises(RecordError, match=r"several campaigns stand here: \w{8} \(5\), \w{8} \(9\).*--campaign"):
        repair()
    found = repair(campaign=Record.open(other).campaign[:8])
    assert (len(values(found)), found.missing[0][:25]) == (8, "5 lines of another campai")


@pytest.mark.parametrize("take", [True, False])
def test_readings_of_two_who_went_on_from_one_event_are_a_question(path: Path, repair: Repair, take: bool) -> None:
    made(path, recorded(1e-6), recorded(2e-6))
    shared = path.read_bytes()
    with Record.open(path) as record:
        record.append(recorded(3e-6))
        record.append(Finished("enough"))
        record.append(Undone(5), Finished("at last"))
    mine = path.read_bytes()
    path.write_bytes(shared)
    with Record.open(path) as record:
        for event in (recorded(4e-6), recorded(5e-6), Undone(5)):
            record.append(event)
    path.write_bytes(mine + path.read_bytes()[len(shared) :])
    found = repair(asked=lambda question: take)
    assert values(found) == [1e-6, 2e-6, 3e-6, *([4e-6] if take else [])]
    assert found.state.finished == (None if take else "at last")
    assert [words.partition(":")[0] for words in found.left] == ([] if take else ["two went on from event 3"])


def test_a_missing_event_comes_from_a_copy(path: Path, tmp_path: Path, command: Command) -> None:
    made(path, recorded(1e-6), recorded(2e-6), recorded(3e-6))
    copy, whole = tmp_path / "copy.axiscal", path.read_bytes()
    copy.write_bytes(whole)
    without(path, 3)
    without(copy, 1, 4)
    both = tmp_path / "both.axiscal"
    assert "Nothing is missing" in command("data", "merge", path, copy, both).printed
    assert both.read_bytes()[HEAD:].startswith(whole[HEAD:])


def test_the_beginning_comes_from_the_description(path: Path, tmp_path: Path, command: Command) -> None:
    made(path, recorded(1e-6), recorded(2e-6))
    without(path, 1)
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    new = tmp_path / "new.axiscal"
    assert "2 readings stand" in command("data", "repair", path, new).refusal
    assert command("data", "repair", path, new, "--beginning", tmp_path / "campaign.toml").status == 0
    assert "2 readings" in command("status", new).printed


def test_a_damaged_record_names_the_command_and_it_writes_over_nothing(
    path: Path, tmp_path: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    made(path, *(recorded(1e-6 * number) for number in range(1, 9)))
    without(path, 5)
    damaged, new = path.read_bytes(), tmp_path / "mill-repaired.axiscal"
    for name in ("status", "copy"):
        assert f"axiscal data repair {path} {new};" in command(name, path).refusal
    said = command("salvage", path, new, "--json").document  # as it was called
    assert (said["readings"], said["events"], said["missing"], said["left_out"]) == (7, 8, ["event 5"], [])
    kept = new.read_bytes()
    assert run(["status", str(new), "--details"]) == run(["copy", str(new)]) == 0
    assert ": repaired from mill.axiscal, 8 events" in capsys.readouterr().out
    assert "exists already" in command("data", "repair", path, new).refusal
    assert (path.read_bytes(), new.read_bytes()) == (damaged, kept)


def test_a_person_is_asked_and_without_one_it_has_to_be_said(
    path: Path, tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    made(path, recorded(1e-6))
    copy = tmp_path / "copy.axiscal"
    copy.write_bytes(path.read_bytes())
    for each, value in ((path, 2e-6), (copy, 3e-6)):
        with Record.open(each) as record:
            record.append(recorded(value))
    both = tmp_path / "both.axiscal"
    assert "Say --take if they count, --leave if not" in command("data", "merge", path, copy, both).refusal
    assert not both.exists()
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr(printing, "ask", lambda prompt: "y")
    found = command("data", "merge", path, copy, both)
    assert "Two went on from event 2: 1 reading of" in found.err
    assert "holds 3 readings" in found.printed
    assert "nothing is missing" in command("data", "repair", both, tmp_path / "again.axiscal").printed.lower()


def test_a_file_without_a_whole_entry_is_refused(path: Path, repair: Repair) -> None:
    whole = made(path).read_bytes()
    for content in (b"", whole[:HEAD], bytes(100_000), b"x" * 100_000):
        path.write_bytes(content)
        with pytest.raises(RecordError, match="No entry"):
            repair()
