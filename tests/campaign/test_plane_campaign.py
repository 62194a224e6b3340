"""A whole campaign on a virtual bed whose axes act together: planned, read, estimated, reported."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from axiscal.cli.app import run

MACHINE = """
chain = "w-Y'-b-X-t"
[axes.X]
travel = ["0 mm", "300 mm"]
[axes.Y]
travel = ["0 mm", "200 mm"]
[errors]
EZX = { std = "60 um", knots = 5, length = "150 mm", rest = "1 um" }
EZY = { std = "60 um", knots = 5, length = "100 mm" }
EZXY = { std = "40 um", knots = 5, length = ["150 mm", "100 mm"], rest = "2 um" }
"""
CAMPAIGN = """
machine = "machine.toml"
sure = "{sure}"
[target]
readings = 10
[[setups]]
name = "bed"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
reach = {{ X = ["0 mm", "300 mm"], Y = ["0 mm", "200 mm"] }}
noise = "2 um"
"""


@pytest.mark.long
@pytest.mark.parametrize("sure", ["exactly", "roughly"])
def test_a_virtual_bed_is_planned_read_and_estimated(sure: str, tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN.format(sure=sure))
    out = tmp_path / "out"
    assert run(["run", str(tmp_path / "campaign.toml"), "--source", "sim:3", "--out", str(out)]) == 0
    result = json.loads((out / "result.json").read_text())
    assert result["readings"] == 10
    before = result["history"][0]["rms_um"]  # as stated: where sizes are learnt, this bed turns out larger
    assert result["rms_um"] < {"exactly": 0.6, "roughly": 1.0}[sure] * before
    assert result["plane_errors"]["EZXY"]["from_readings"] > 0.1
