"""The verdict where a person sees it: first lines, `result.json`, report, README.txt and the exit status."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.cli import app

CAMPAIGN = """machine = "m.toml"
[target]
readings = 40
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.5 um"
approach = "both"
drift = "0"
"""
MACHINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "10 um", length = "200 mm", knots = 21 }
"""


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
    status = app.run(["estimate", "c.toml", "r.csv", "--out", "d"])
    return status, json.loads((folder / "d" / "result.json").read_text())


def test_readings_that_drift_are_widened_and_the_first_lines_say_so(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    status, result = _evaluated(folder, 10 * np.linspace(0, 1, 40))
    said = capsys.readouterr().out
    assert (status, result["verdict"]) == (0, "widened")
    assert said.splitlines()[0].startswith("U = ")
    assert "you said that nothing drifts" in said.splitlines()[0]
    assert "Verdict: widened. The readings contradict the model" in said
    assert "drift" in next(line for line in said.splitlines() if "contradict the model (" in line)
    assert result["verdict_words"] in said
    assert result["history"][-1]["rms_um"] == result["rms_um"]
    assert "Verdict: widened" in (folder / "d" / "report.html").read_text()


def test_a_drift_of_usual_size_is_taken_off_without_a_word_of_it_in_the_campaign(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "c.toml").write_text(CAMPAIGN.replace('drift = "0"\n', ""))
    status, result = _evaluated(folder, 10 * np.linspace(0, 1, 40))
    moved = next(each for each in result["warnings"] if each["code"] == "drift")["text"]
    assert (status, result["verdict"]) == (0, "unchecked")
    assert float(moved.partition("had moved by ")[2].partition(" ")[0]) == pytest.approx(10.0, abs=1.0)
    promised, *_ = capsys.readouterr().out.splitlines()
    assert promised.startswith("U = ")
    assert "with zeros that wander as is usual, 5 um/h" in promised


def test_readings_that_nothing_explains_promise_nothing_and_are_all_kept(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    status, result = _evaluated(folder, 25 * np.random.default_rng(1).choice([-1.0, 1.0], 40))
    told = capsys.readouterr()
    assert (status, result["verdict"], result["U_um"], result["k"]) == (1, "contradicted", None, None)
    assert told.out.splitlines()[0].startswith("Verdict: contradicted. Not known: ")
    assert "Traceback" not in told.err
    assert "the readings contradict every explanation that was tried" in " ".join(told.err.split())
    assert result["readings"] == 40
    assert "the tool point is <strong>not known</strong>" in (folder / "d" / "report.html").read_text()
    readme = folder / "d" / "tables" / "csv" / "README.txt"
    assert "WHAT TO EXPECT IS Not known" not in readme.read_text()
    assert "WHAT TO EXPECT IS NOT KNOWN" in readme.read_text()
