"""Errors of two axes in `result.json` and in the report, against what `predict` says at the same places."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

from axiscal.cli.app import run
from tests.generators.texts import machine_text

MACHINE = machine_text(
    "w-X'-Y'-b-Z-t",
    {"X": (0, 300), "Y": (0, 200), "Z": (0, 100)},
    {
        "EZX": 'std = "30 um", length = "150 mm"',
        "EZY": 'std = "30 um", length = "100 mm"',
        "EZXY": 'std = "30 um", length = ["150 mm", "100 mm"], rest = "1 um"',
    },
)
BARE = """usual = "off"
sure = "exactly"
"""
CAMPAIGN = f"""
machine = "machine.toml"
{BARE}[[setups]]
name = "table"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
noise = "1 um"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("plane")
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 300, 7), np.linspace(0, 200, 5)))
    z = 40 * (x / 150 - 1) * (y / 100 - 1) + 20 * np.cos(x / 80)
    lines = [f"table,{a:g},{b:g},{c:.4f}" for a, b, c in zip(x, y, z, strict=True)]
    (folder / "machine.toml").write_text(MACHINE)
    (folder / "campaign.toml").write_text(CAMPAIGN)
    (folder / "readings.csv").write_text("\n".join(["setup,X_mm,Y_mm,value_um", *lines]) + "\n")
    readings, out = folder / "readings.csv", folder / "out"
    assert run(["estimate", str(folder / "campaign.toml"), str(readings), "--out", str(out)]) == 0
    return out


def test_the_whole_map_is_what_predict_says_of_the_tool(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = json.loads((folder / "result.json").read_text())
    readings = (folder / "data" / "readings.csv").read_bytes()
    assert result["inputs"]["data/readings.csv"] == hashlib.sha256(readings).hexdigest()
    plane = result["plane_errors"]["EZXY"]
    assert (plane["axes"], plane["position_unit"], plane["value_unit"]) == (["X", "Y"], ["mm", "mm"], "um")
    x, y = plane["position"]
    rows = [f"{a},{b},0" for a in x for b in y]
    (folder / "poses.csv").write_text("\n".join(["X_mm,Y_mm,Z_mm", *rows]) + "\n")
    capsys.readouterr()
    assert run(["predict", str(folder / "campaign.axiscal"), str(folder / "poses.csv"), "--json"]) == 0
    tool = np.array([pose["mean_um"][2] for pose in json.loads(capsys.readouterr().out)["poses"]])
    whole = np.array(plane["whole_mean"])
    assert whole.shape == (len(x), len(y))
    np.testing.assert_allclose(whole.ravel(), tool - tool.mean(), atol=2e-3)


def test_the_twist_is_found_with_the_sign_of_the_table(folder: Path) -> None:
    """The tool is high where x and y are; the table Y', on which both stand, is low there."""
    plane = json.loads((folder / "result.json").read_text())["plane_errors"]["EZXY"]
    mean, std = np.array(plane["mean"]), np.array(plane["std"])
    assert mean[-1, -1] == pytest.approx(-40, abs=6)
    assert mean[0, -1] == pytest.approx(40, abs=6)
    assert np.all(std < np.array(plane["prior_std"]) * 1.001)
    assert plane["from_readings"] > 0.9
    np.testing.assert_allclose(np.array(plane["whole_std"])[15, 15], 0, atol=4)
