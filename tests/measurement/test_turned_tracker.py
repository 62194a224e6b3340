"""A tracker that was set down by eye: turned by 20 mrad, and the machine is found as if it stood straight."""

from __future__ import annotations

import contextlib
import io
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from axiscal.cli.app import run
from axiscal.numerics import Array
from tests.generators.texts import machine_text

MACHINE = machine_text(
    "w-X'-Y'-b-Z-t",
    {"X": (0, 600), "Y": (0, 400), "Z": (-400, 0)},
    {"EXX EYY EZZ": ("15 um", 7, 250), "EYX": "8 um", "C0Y": "60 urad"},
    curve=(5, 300),
    tool=0,
)
CAMPAIGN = """machine = "machine.toml"
[target]
readings = 6
[[setups]]
name = "tracker"
instrument = "tracker"
noise = "2 um"
station = ["300 mm", "-1500 mm", "-200 mm"]
unknowns = { zero_x = "3 mm", zero_y = "3 mm", zero_z = "3 mm", turn_x = "TURN", turn_y = "TURN", turn_z = "TURN" }
""".replace("TURN", "20 mrad")
INSTRUMENT = """
import json, sys
import numpy as np
sys.path[:0] = HERE
from test_turned_tracker import STATION, TURN, off
for line in sys.stdin:
    at = np.array([json.loads(line)["position"][axis] for axis in "XYZ"])
    seen = TURN.apply(at + off(*at) - STATION) + STATION - at
    print(json.dumps({"value": [1e3 * v for v in seen], "unit": "um"}), flush=True)
""".replace("HERE", repr([str(Path(__file__).parent), str(Path(__file__).parents[2])]))
STATION, TURN = np.array([300.0, -1500.0, -200.0]), Rotation.from_rotvec([0.019, -0.021, 0.023])


def off(x: float, y: float, z: float) -> Array:
    """By how much the tool is off on the workpiece, mm."""
    return np.array([0.012 * np.sin(x / 110), 0.010 * np.sin(y / 80) + 6e-3 * (x / 600) ** 2, 0.011 * np.cos(z / 90)])


def readings(count: int, turn: Rotation) -> str:
    rng = np.random.default_rng(4)
    lines = ["setup,X_mm,Y_mm,Z_mm,value_x_um,value_y_um,value_z_um"]
    for _ in range(count):
        at = np.round(rng.uniform((0, 0, -400), (600, 400, 0)), 4)
        seen = turn.apply(at + off(*at) - STATION) + STATION - at + rng.normal(0, 2e-3, 3)
        lines.append("tracker," + ",".join(f"{v:.6f}" for v in (*at, *(1e3 * seen))))
    return "\n".join(lines)


@pytest.mark.parametrize(
    "turn", [TURN, pytest.param(Rotation.identity(), marks=pytest.mark.long)], ids=["by eye", "straight"]
)
@pytest.mark.long
def test_the_machine_is_found_whichever_way_the_tracker_is_turned(turn: Rotation, tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    (tmp_path / "readings.csv").write_text(readings(60, turn))
    out = tmp_path / "out"
    assert run(["estimate", str(tmp_path / "campaign.toml"), str(tmp_path / "readings.csv"), "--out", str(out)]) == 0
    result = json.loads((out / "result.json").read_text())
    assert result["rejected"] == []
    rng = np.random.default_rng(9)
    at = np.round(rng.uniform((0, 0, -400), (600, 400, 0), (40, 3)), 3)
    poses = "\n".join(["X_mm,Y_mm,Z_mm", *(",".join(map(str, row)) for row in at)])
    (tmp_path / "poses.csv").write_text(poses)
    found = predicted(out / "campaign.axiscal", tmp_path / "poses.csv")
    apart = found - 1e3 * np.array([off(*row) for row in at])
    left = apart - apart.mean(axis=0)
    missed = float(np.sqrt(np.mean(np.sum(left**2, axis=1))))
    assert missed < 3.5
    assert missed < 1.6 * result["rms_um"] < 16


def predicted(record: Path, poses: Path) -> Array:
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        assert run(["predict", str(record), str(poses), "--json"]) == 0
    return np.array([pose["mean_um"] for pose in json.loads(text.getvalue())["poses"]])


@pytest.mark.long
def test_a_closed_loop_finds_it_as_well(tmp_path: Path) -> None:
    """The instrument answers request by request; nothing is implausible, and the end agrees with what is stated."""
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN.replace("readings = 6", "readings = 12"))
    answers = tmp_path / "tracker.py"
    answers.write_text(INSTRUMENT)
    arguments = ["run", str(tmp_path / "campaign.toml"), "--source", f"exec:{sys.executable} {answers}"]
    assert run([*arguments, "--out", str(tmp_path / "out")]) == 0
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert result["rejected"] == []
    rng = np.random.default_rng(9)
    at = np.round(rng.uniform((0, 0, -400), (600, 400, 0), (40, 3)), 3)
    (tmp_path / "poses.csv").write_text("\n".join(["X_mm,Y_mm,Z_mm", *(",".join(map(str, row)) for row in at)]))
    left = predicted(tmp_path / "out" / "campaign.axiscal", tmp_path / "poses.csv") - 1e3 * np.array(
        [off(*r) for r in at]
    )
    left -= left.mean(axis=0)
    assert float(np.sqrt(np.mean(np.sum(left**2, axis=1)))) < 1.6 * result["rms_um"]
