"""The record: append-only, whole after any kill, and plain about what is wrong with a file."""

import fcntl
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from axiscal.document import durable
from axiscal.document.durable import written
from axiscal.exceptions import NewerError, RecordError
from axiscal.record import store
from axiscal.record.events import Created
from axiscal.record.lines import EventText
from axiscal.record.signing import rows_of
from axiscal.record.store import Record, content_of
from benchmarks.reliability.record_faults import CREATED, recorded


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "trial.axiscal"


@pytest.fixture
def record(path: Path) -> Iterator[Record]:
    with Record.create(path, CREATED) as opened:
        yield opened


def test_a_record_is_never_overwritten(record: Record) -> None:
    record.append(recorded(1e-6))
    with pytest.raises(RecordError, match="exists already"):
        Record.create(record.path, CREATED)
    assert len(record.state().readings) == 1


@pytest.mark.parametrize("content", [b"", b"S", b"machine = 'mill'\n", b"SQLite format 3\0" + b"\0" * 84])
def test_a_file_that_is_no_record_is_refused(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    with pytest.raises(RecordError, match="not a campaign record"):
        Record.open(path)
    assert path.read_bytes() == content


def test_a_newer_record_is_refused(record: Record) -> None:
    record.path.write_bytes(b"axiscal record 5 of any kind\n".ljust(9000))
    with pytest.raises(RecordError, match="newer axiscal"):
        Record.open(record.path)


@pytest.mark.parametrize("row", [("weighted", '{"weight":0.5}'), ("noted", '{"author":"Anna","text":"warm"}')])
def test_an_entry_of_a_newer_version_is_named_and_nothing_is_written(record: Record, row: tuple[str, str]) -> None:
    content = content_of([*record.rows, EventText("2028-03-01T08:00:00.000+00:00", *row)])
    record.path.write_bytes(content)
    with pytest.raises(NewerError, match=f"trial.axiscal: A newer version .* an entry here: .*{row[0]}"):
        Record.open(record.path)
    assert record.path.read_bytes() == content


@pytest.mark.parametrize("at", ["x", "2026-13-01T00:00:00+00:00", "2026-01-01T00:00:00"])
def test_an_entry_without_its_time_is_damage(path: Path, at: str) -> None:
    (created,) = rows_of([CREATED])
    path.write_bytes(content_of([created._replace(at=at)]))
    with pytest.raises(RecordError, match=f"damaged: event 1: '{re.escape(at)}' is no time"):
        Record.open(path)


def test_a_locked_record_says_so(record: Record, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store, "PATIENCE", 0.05)
    with record.path.open("rb") as blocker, Record.open(record.path) as other:
        fcntl.flock(blocker, fcntl.LOCK_EX)
        with pytest.raises(RecordError, match="Another program holds this record"):
            other.append(recorded(1e-6))
    assert record.append(recorded(1e-6)) == 2


AS_NOBODY = """
import importlib.metadata, os, sys  # what only the owner of this Python may load
from pathlib import Path
from axiscal.record.events import Created
from axiscal.record.store import Record, content_of
from axiscal.exceptions import RecordError
folder = Path(sys.argv[1])
if os.geteuid() == 0:
    os.setgroups([]); os.setgid(65534); os.setuid(65534)
try:
    Record.create(folder / "new.axiscal", Created("", "", "", "", {}))
except RecordError as error:
    print(error)
with Record.open(folder / "old.axiscal", write=False) as record:
    print(record.last(), "events")
try:
    Record.open(folder / "old.axiscal")
except RecordError as error:
    print(error)
"""


def test_in_a_read_only_folder_one_can_look_but_not_write() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        Record.create(folder / "old.axiscal", CREATED).close()
        (folder / "old.axiscal").chmod(0o444)
        folder.chmod(0o555)
        run = subprocess.run([sys.executable, "-c", AS_NOBODY, name], capture_output=True, text=True, check=False)
        folder.chmod(0o755)
    assert run.returncode == 0, run.stderr
    first, look, second = run.stdout.splitlines()
    assert "cannot be written here" in first
    assert look == "1 events"
    assert "cannot be written here" in second


def test_a_record_that_appears_while_another_is_made_is_not_overwritten(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "mill.axiscal"

    def meanwhile(draft: Path, content: bytes) -> None:
        written(draft, content)
        path.write_text("another one")

    monkeypatch.setattr(durable, "written", meanwhile)
    with pytest.raises(RecordError, match="exists already"):
        Record.made(path, content_of(rows_of([CREATED])))
    assert [(each.name, each.read_text()) for each in tmp_path.iterdir()] == [("mill.axiscal", "another one")]


def test_a_copy_takes_the_place_of_nothing_else(record: Record, tmp_path: Path) -> None:
    other = tmp_path / "other.axiscal"
    with Record.create(other, Created("name = 'n'", "", "machine.toml", "campaign.toml", {})):
        pass
    (tmp_path / "text.axiscal").write_text("no record")
    for name, why in (("other.axiscal", "no earlier copy"), ("text.axiscal", "not a campaign record")):
        before = (tmp_path / name).read_bytes()
        with pytest.raises(RecordError, match=why):
            record.copy_to(tmp_path / name)
        assert (tmp_path / name).read_bytes() == before
