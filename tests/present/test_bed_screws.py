"""Screws under a bed: a tilted map becomes turns of each, in the words of Klipper."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from benchmarks.zoo.answers import Answer
from benchmarks.zoo.running import given

PRINTER = """[printer]
kinematics: corexy
[stepper_x]
position_max: 300
[stepper_y]
position_max: 300
[stepper_z]
position_max: 300
[probe]
x_offset: -33
y_offset: -46
"""
TILTED = """[screws_tilt_adjust]
screw1: 63, 76
screw1_name: front left
screw2: 303, 76
screw2_name: front right
screw3: 183, 316
screw_thread: CCW-M5
"""
PLACES = [20.0 + 57.5 * k for k in range(5)]
NOISE = 1.0
"""um, of a good probe."""


def begun(folder: Path, screws: str) -> str:
    """Return the campaign that init writes for a printer with such screws."""
    (folder / "printer.cfg").write_text(PRINTER + screws)
    wanted = ("--from", folder / "printer.cfg", "--instrument", "probe", "--target", "60 um")
    assert given("init", folder / "bed", *wanted).status == 0
    return (folder / "bed" / "campaign.toml").read_text(encoding="utf-8")


def answer_of_map(folder: Path, campaign: str, x_slope: float, y_slope: float, along_x: Sequence[float]) -> Answer:
    """Return the answer to a map of a tilted bed, mm in mm, and a plain table.  along_x : where it was probed, mm"""
    noise = np.random.default_rng(5)
    rows = [
        f"probe,{x},{y},{-1000 * (x_slope * x + y_slope * y) + noise.normal(0, NOISE):.3f}"
        for x in along_x
        for y in PLACES
    ]
    (folder / "map.csv").write_text("\n".join(["setup,X_mm,Y_mm,value_um", *rows]))
    text = campaign.replace("# compensation_active", "compensation_active = false #")
    text = text.replace('noise = "5 um"', f'noise = "{NOISE} um"')
    text = text.replace('["klipper", "marlin", "reprapfirmware"]', '["csv"]')
    (folder / "bed" / "campaign.toml").write_text(text, encoding="utf-8")
    command = ("data", "estimate", folder / "bed" / "campaign.toml", folder / "map.csv", "--out", folder / "out")
    return Answer(folder / "out", given(*command))


def test_screws_are_turned_until_the_plane_of_the_map_is_level(tmp_path: Path) -> None:
    campaign = begun(tmp_path, TILTED)
    assert '"front left" = ["30 mm", "30 mm"]' in campaign  # where the probe is, not the nozzle
    assert 'thread = "CCW-M5"' in campaign
    answer = answer_of_map(tmp_path, campaign, 0.002, -0.001, PLACES)
    right, back = answer.result["answer"]["screws"]
    assert (right["screw"], back["screw"]) == ("front right", "screw 3")
    assert right["turns"] == pytest.approx(0.002 * 240 / 0.8, abs=right["U"])  # too high; clockwise lowers it
    assert back["turns"] == pytest.approx((0.002 * 120 - 0.001 * 240) / 0.8, abs=back["U"])
    assert 0 < right["U"] < 0.1
    assert "half_read" not in answer.result["answer"]
    assert "front right CW 00:3" in answer.text.replace("\n", " ")
