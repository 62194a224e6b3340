"""What commands leave in a folder: a whole set with a manifest, or what was there."""

from __future__ import annotations

import hashlib
import json
from itertools import chain
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.present import delivery
from tests.commands import Command
from tests.generators.begun import begun
from tests.generators.texts import campaign_text, machine_text, setup_text
from tests.golden.surfaces import of_paper

CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text("along x", "interferometer", direction="x", moves=["X"]),
    target={"readings": 4},
    compensation_active=False,
    usual="off",
    sure="exactly",
)
READINGS = "setup,X_mm,approach,value_um\nalong x,10,X+,-20\nalong x,200,X+,20\n"
FILES = {
    "machine.toml": machine_text("w-X'-b-t", {"X": (0, 300)}, {"EXX": "20 um"}),
    "campaign.toml": CAMPAIGN,
    "readings.csv": READINGS,
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    begun(tmp_path, FILES)
    return tmp_path


def complaint(capsys: pytest.CaptureFixture[str]) -> str:
    return " ".join(capsys.readouterr().err.split())


def differing(out: Path, name: str) -> set[str]:
    """Return the files of a folder that are not as its manifest says: missing, changed, or not in it.

    The record grows, and is no result.
    """
    files: dict[str, str] = json.loads((out / name).read_text())["files"]
    found = {path.relative_to(out).as_posix(): path for path in out.rglob("*") if path.is_file()}
    digests = {file: hashlib.sha256(path.read_bytes()).hexdigest() for file, path in found.items()}
    others = digests.keys() - {name, "campaign.axiscal"}
    return {file for file in files.keys() | others if files.get(file) != digests.get(file)}


def beside(folder: Path) -> list[str]:
    """Return the hidden files of a folder."""
    return [path.name for path in folder.glob(".*")]


def measured(folder: Path) -> Path:
    """Return a record with two readings."""
    read = ((("next", "mill.axiscal"), ("record", "mill.axiscal", value)) for value in ("-45 um", "45 um"))
    begun(folder, FILES, ("start", "campaign.toml", "mill.axiscal"), *chain.from_iterable(read))
    return folder / "mill.axiscal"


@pytest.mark.parametrize(
    "words",
    [
        ["run", "campaign.toml", "--source", "sim:3", "--out", "out"],
        ["estimate", "campaign.toml", "readings.csv", "--out", "out"],
    ],
)
def test_every_folder_of_results_has_a_manifest(folder: Path, words: list[str]) -> None:
    assert run(words) == 0
    assert differing(folder / "out", "manifest.json") == set()
    manifest = json.loads((folder / "out" / "manifest.json").read_text())
    result = json.loads((folder / "out" / "result.json").read_text())
    record = manifest["record"]
    assert record == result["record"]
    with Campaign.open(folder / "out" / "campaign.axiscal", write=False) as campaign:
        assert campaign.state.name == record["hash"]
    assert record["hash"] in of_paper(folder / "out" / "report.pdf")
    (readme, *_) = (folder / "out" / "tables").rglob("README.txt")
    zeros, *others = readme.read_text().splitlines()[1:]
    assert zeros.startswith("ZERO WORK OFFSETS")
    assert f"From the record campaign.axiscal at event {record['event']}: {record['hash']}" in others


def test_the_tables_are_those_of_the_controls_that_the_campaign_names(
    folder: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "campaign.toml").write_text(f'controls = ["sinumerik", "klipper", "sinumerik"]\n{CAMPAIGN}')
    shown = command("estimate", "campaign.toml", "readings.csv", "--out", "survey", "--details").printed
    assert "left with sinumerik" in shown
    assert "No table for klipper" in shown
    assert {each.name for each in (folder / "survey" / "tables").iterdir()} == {"sinumerik", "csv"}
    result = json.loads((folder / "survey" / "result.json").read_text())
    assert list(dict.fromkeys(table["controller"] for table in result["tables"])) == ["sinumerik", "klipper", "csv"]
    (folder / "campaign.toml").write_text(f'controls = ["yardstick"]\n{CAMPAIGN}')
    assert run(["estimate", "campaign.toml", "readings.csv", "--out", "other"]) == 1
    assert "sinumerik" in complaint(capsys)


def test_a_full_disk_leaves_the_earlier_results(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    measured(folder)
    assert run(["finish", "mill.axiscal", "--out", "out"]) == 0
    before = {path: path.read_bytes() for path in (folder / "out").rglob("*") if path.is_file()}

    def full(path: Path, content: bytes) -> None:
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(delivery, "written", full)
    assert run(["finish", "mill.axiscal", "--out", "out"]) == 1
    said = complaint(capsys)
    assert "The results were not written: No space left on device" in said
    assert "axiscal finish mill.axiscal --out out" in said
    assert {path: path.read_bytes() for path in (folder / "out").rglob("*") if path.is_file()} == before
    assert not beside(folder)


def test_ctrl_c_says_how_many_readings_are_kept(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    record = str(measured(folder))
    assert run(["next", record]) == 0
    capsys.readouterr()
    moments = [
        ("axiscal.campaign.campaign.refuse_unreadable", 2),
        ("axiscal.cli.record.last_doubt", 3),
    ]
    for name, kept in moments:
        with monkeypatch.context() as patched:
            patched.setattr(name, lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
            assert run(["record", record, "3 um"]) == 1
        assert f"Stopped by Ctrl-C. {kept} readings are kept in {record}; go on with: axiscal" in complaint(capsys)
        with Campaign.open(record, write=False) as campaign:
            assert len(campaign.state.readings) == kept
