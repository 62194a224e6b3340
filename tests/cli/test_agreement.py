"""Readings that agree and that contradict where a person sees it: lines, files, README.txt and the exit status."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.cli import app
from tests.commands import Command
from tests.generators.texts import campaign_text, machine_text, setup_text

CAMPAIGN = campaign_text(
    "m.toml",
    setup_text("laser", "interferometer", direction="x", noise="0.5 um", approach="both"),
    target={"readings": 40},
)
NARROW = f'usual = "off"\nsure = "exactly"\n{CAMPAIGN}drift = "0"\n'
MACHINE = machine_text("w-b-X-t", {"X": (0, 1000)}, {"EXX": 'std = "10 um", length = "200 mm", knots = 21'})
SCATTERED = 3 * np.random.default_rng(1).choice([-1.0, 1.0], 40)
"""um, six times the noise: more than a model allows that learns nothing, and less than another unit would make."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "m.toml").write_text(MACHINE)
    (tmp_path / "c.toml").write_text(CAMPAIGN)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def _evaluated(folder: Path, added: np.ndarray[Any, Any]) -> tuple[int, dict[str, Any]]:
    """Evaluate forty readings of a smooth axis, one a minute out and back, each with something added, um."""
    out, back = np.linspace(5, 985, 20), np.linspace(25, 995, 20)[::-1]
    places = [(x, "+") for x in out] + [(x, "-") for x in back]
    rows = [
        f"laser,{x:.3f},X{side},{8 * np.sin(x / 150) + 0.3 * np.sin(40 * x) + more:.4f},2026-11-20T10:{n:02}:00"
        for n, ((x, side), more) in enumerate(zip(places, added, strict=True))
    ]
    (folder / "r.csv").write_text("\n".join(["setup,X_mm,approach,value_um,time", *rows]))
    status = app.run(["estimate", "c.toml", "r.csv", "--out", "d", "--details"])
    return status, json.loads((folder / "d" / "result.json").read_text())


@pytest.fixture
def contradicting(folder: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    """Return the record of readings that contradict each other, which no mistake explains: they promise nothing."""
    (folder / "c.toml").write_text(NARROW)
    status, result = _evaluated(folder, SCATTERED)
    told = capsys.readouterr()
    assert (status, result["U_um"], result["k"], result["readings"]) == (1, None, None, 40)
    assert (result["agreement"]["contradict"], result["agreement"]["explained"]) == (True, [])
    assert "READINGS CONTRADICT" in told.out
    assert "U = " not in told.out
    assert "--anyway" in told.err
    assert "<strong>READINGS CONTRADICT</strong>" in (folder / "d" / "report.html").read_text()
    assert not (folder / "d" / "tables").exists()
    return folder / "d" / "campaign.axiscal"


def test_a_drift_of_usual_size_is_taken_off_without_a_word_of_it_in_the_campaign(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    status, result = _evaluated(folder, 10 * np.linspace(0, 1, 40))
    moved = next(each for each in result["warnings"] if each["code"] == "drift")["text"]
    assert (status, result["agreement"]["contradict"]) == (0, False)
    assert float(moved.partition("had moved by ")[2].partition(" ")[0]) == pytest.approx(10.0, abs=1.0)
    told = capsys.readouterr().out
    assert "with zeros that wander as is usual, 5 um/h" in told
    assert "Agreement: 40 of 40 readings agree with the others" in told
    assert "Readings agree: 40 of 40." in told
    lines = told.splitlines()
    assert f"Expanded uncertainty U in space: {result['U_um']:.3g} um" in lines
    assert any(line.startswith("positioning of X  EXX  ± ") for line in lines)
    assert any(line.startswith("MEASURED   40 readings") for line in lines)
    assert {table["controller"] for table in result["tables"]} == {"linuxcnc", "csv"}
    (left,) = (line for line in lines if line.startswith("linuxcnc: All files together take"))
    assert left.partition(" Then ")[2] in (folder / "d/tables/linuxcnc/README.txt").read_text()  # one U of the files


def test_a_campaign_that_contradicts_itself_is_finished_without_u_and_with_it_where_that_is_wanted(
    contradicting: Path, command: Command
) -> None:
    kept, home = contradicting.read_bytes(), contradicting.parent.parent
    told = command("finish", contradicting, "--out", "e").refusal
    assert told.endswith("all readings are kept and the report is written.")
    assert told.count("Not known: the readings contradict each other") == 1
    assert contradicting.read_bytes() == kept
    assert json.loads((home / "e" / "result.json").read_text())["U_um"] is None
    told = command("finish", contradicting, "--out", "f", "--anyway", "--details").printed
    assert "U = k u = " in told
    result = json.loads((home / "f" / "result.json").read_text())
    assert result["U_um"] > 0
    words = result["agreement"]["text"]
    assert words.startswith("The readings contradict each other (p = ")
    assert f"Agreement: {words}" in told
    assert words in (home / "f" / "report.html").read_text()
    for readme in (home / "f" / "tables").glob("*/README.txt"):
        assert f"{words}.\n" in readme.read_text()
    assert {path.name for path in (home / "f" / "tables").iterdir()} == {"csv", "linuxcnc"}


def test_tables_of_a_campaign_that_contradicts_itself_are_written_where_that_is_wanted(
    contradicting: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept, out = contradicting.read_bytes(), contradicting.parent.parent / "g"
    assert app.run(["export", str(contradicting), "--to", "linuxcnc", "--out", str(out)]) == 1
    told = capsys.readouterr()
    assert told.out == ""
    said = " ".join(told.err.split())
    assert "no single mistake explains it" in said
    assert "--anyway" in said
    assert not out.exists()
    assert app.run(["export", str(contradicting), "--to", "linuxcnc", "--out", str(out), "--anyway"]) == 0
    assert "The readings contradict each other (p = " in (out / "README.txt").read_text()
    assert (out / "X.comp").exists()
    assert contradicting.read_bytes() == kept
