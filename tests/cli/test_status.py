"""`axiscal status FOLDER`: a line for each record, as it stands there, and what it needs next."""

from pathlib import Path

import pytest

from axiscal.cli.app import run
from axiscal.record.events import Finished, KeptResult
from axiscal.record.store import Record
from tests.generators.begun import begun
from tests.generators.laser_axis import CAMPAIGN, MACHINE


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of campaigns that were planned, measured and ended, one that contradicts, and a damaged record."""
    record = ("record", "1 um", "--setup", "laser", "--at", "X=100 mm")
    begun(
        tmp_path,
        {"campaign.toml": CAMPAIGN, "m": MACHINE},
        *(("start", "campaign.toml", f"{name}.axiscal") for name in ("a", "b", "c", "d")),
        *((record[0], f"{name}.axiscal", *record[1:]) for name in ("b", "c", "d")),
    )
    for name, result in (("c", KeptResult(1.5e-6, 3.1e-6, "agree")), ("d", KeptResult(None, None, "contradict"))):
        with Record.open(tmp_path / f"{name}.axiscal") as log:
            log.append(Finished("ended by the operator", result))
    (tmp_path / "e.axiscal").write_bytes((tmp_path / "a.axiscal").read_bytes()[:200])
    return tmp_path


def test_each_record_has_a_line_with_what_it_needs_next(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = {path: path.read_bytes() for path in folder.iterdir()}
    assert run(["status", str(folder)]) == 0
    heads, *rows, left_out = capsys.readouterr().out.splitlines()
    assert heads.split() == ["record", "machine", "last", "state", "next"]
    cells = [[cell.strip() for cell in row.split("  ") if cell.strip()] for row in rows]
    assert [row[0] for row in cells] == ["a.axiscal", "b.axiscal", "c.axiscal", "d.axiscal"]
    assert cells[0][3].startswith("0 readings, ")
    assert cells[1][3].startswith("1 reading, ")
    assert [row[3] for row in cells[2:]] == [
        "1 reading, finished: RMS 1.5 um", "1 reading, finished: they contradict each other",
    ]  # fmt: skip
    assert [row[4] for row in cells] == [
        f"axiscal measure {folder}/a.axiscal",
        f"axiscal measure {folder}/b.axiscal",
        "-",
        f"axiscal step undo {folder}/d.axiscal",
    ]
    assert left_out.startswith("Left out: ")
    assert "e.axiscal" in left_out
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def test_a_folder_without_records_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["status", str(tmp_path)]) == 1
    assert "no campaign record in this folder" in " ".join(capsys.readouterr().err.split())
