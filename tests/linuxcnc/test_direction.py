"""Axes that count against ISO 841: a campaign on a machine with LinuxCNC's own trt-kins, tables in, in TCP mode."""

from __future__ import annotations

import contextlib
import io
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.cli.app import run
from axiscal.numerics import Array
from tests.commands import Command
from tests.linuxcnc import tilting_table
from tests.linuxcnc.lab import Joint, Session, Settings
from tests.linuxcnc.needed import LONG

pytestmark = LONG

LIMITS = {"X": (-150, 150), "Y": (-150, 150), "Z": (0, 200), "A": (-60, 60), "B": (-60, 60), "C": (0, 360)}
ERRORS = """
EXX = { std = "15 um", knots = 7, length = "100 mm", rest = "0.3 um" }
EYY = { std = "12 um", knots = 7, length = "100 mm", rest = "0.3 um" }
EZZ = { std = "12 um", knots = 6, length = "100 mm", rest = "0.3 um" }
EXX_reversal = { std = "6 um" }
EYY_reversal = { std = "6 um" }
ESS = { std = "80 urad", knots = 7, length = "45 deg", rest = "1 urad" }
ESS_reversal = { std = "20 urad" }
ECC = { std = "80 urad", knots = 9, length = "60 deg", rest = "1 urad" }
C0Y = { std = "50 urad" }
B0Z = { std = "50 urad" }
A0Z = { std = "50 urad" }
X0C = { std = "20 um" }
Y0C = { std = "20 um" }
T0S = { std = "20 um" }
Z0S = { std = "20 um" }
"""
CAMPAIGN = 'machine = "machine.toml"\n[target]\nreadings = 50\n' + "".join(
    f'[[setups]]\nname = "{d}"\ninstrument = "probe"\ndirection = "{d}"\nnoise = "0.3 um"\napproach = "both"\n'
    'unknowns = { zero = "100 um" }\n'
    for d in "xyz"
)
TRACKER = """machine = "machine.toml"
[target]
readings = 17
[[setups]]
name = "tracker"
instrument = "tracker"
station = ["900 mm", "0 mm", "-100 mm"]
noise = "0.3 um"
approach = "both"
unknowns = { zero_x = "100 um", zero_y = "100 um", zero_z = "100 um" }
"""
NAMED = "correct direction of C, A in the machine's file"


def machine(swivel: str, direction: str) -> str:
    """Return the description of the tilting table by its owner; direction : lines for both rotary axes."""
    across, height = tilting_table.LINE
    pivot = (0.0, across, height) if swivel == "A" else (across, 0.0, height)
    origins = {swivel: pivot, "C": (*tilting_table.TABLE, height)}
    lines = [
        f'name = "tilting table"\nchain = "w-C\'-{swivel}\'-b-X-Y-Z-t"\n[tool]\nlength = "{tilting_table.TOOL} mm"'
    ]
    for axis in ("X", "Y", "Z", swivel, "C"):
        unit = "deg" if axis in origins else "mm"
        low, high = LIMITS[axis]
        lines.append(f'[axes.{axis}]\ntravel = ["{low} {unit}", "{high} {unit}"]')
        if axis in origins:
            x, y, z = origins[axis]
            lines.append(f'origin = ["{x} mm", "{y} mm", "{z} mm"]\n{direction}')
    across_name = "Y" if swivel == "A" else "X"
    errors = ERRORS.replace("ESS", f"E{swivel}{swivel}").replace("T0S", f"{across_name}0{swivel}")
    return "\n".join([*lines, "[errors]", errors.replace("Z0S", f"Z0{swivel}")])


def described(swivel: str, folder: Path, direction: str = 'direction = "reversed"') -> Path:
    """Return the file of the campaign."""
    (folder / "machine.toml").write_text(machine(swivel, direction))
    (folder / "campaign.toml").write_text(CAMPAIGN)
    return folder / "campaign.toml"


def read_everywhere(swivel: str, campaign: Path, out: Path, status: int = 0) -> Path:
    """Return the record of 210 readings of the true machine, three at each place."""
    names = ["X", "Y", "Z", swivel, "C"]
    lines = ["setup," + ",".join(f"{n}_{'deg' if n in 'ABC' else 'mm'}" for n in names) + ",approach,value_um"]
    rng = np.random.default_rng(5)
    low, high = np.array([LIMITS[n] for n in names], dtype=float).T
    for _ in range(70):
        at, side = rng.uniform(low, high), rng.choice([-1, 1], 5)
        drives = {n: float(f"{value:.6f}") for n, value in zip(names, at, strict=True)}
        approach = {n: int(s) for n, s in zip(names, side, strict=True)}
        off = tilting_table.deviation(swivel, drives, approach)
        sides = " ".join(f"{n}{'+' if s > 0 else '-'}" for n, s in approach.items())
        where = ",".join(f"{value:.6f}" for value in drives.values())
        lines += [
            f"{d},{where},{sides},{1e3 * v + 0.3 * rng.standard_normal():.4f}" for d, v in zip("xyz", off, strict=True)
        ]
    readings = campaign.with_name("readings.csv")
    readings.write_text("\n".join(lines) + "\n")
    assert run(["estimate", str(campaign), str(readings), "--out", str(out)]) == status
    return out / "campaign.axiscal"


def printed(arguments: Sequence[str]) -> dict[str, Any]:
    """Return the document that a command prints."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        assert run(list(arguments)) == 0
    found: dict[str, Any] = json.loads(text.getvalue())
    return found


def exported(record: Path, folder: Path, *more: str) -> dict[str, str]:
    """Return the files by name."""
    said = printed(["export", str(record), "--to", "linuxcnc", "--out", str(folder), "--json", *more])
    (folder.parent / "said.json").write_text(json.dumps(said))
    return {path.name: path.read_text() for path in folder.iterdir()}


def nominal_pivots(swivel: str) -> str:
    """Return the settings of the kinematics that the machine has as built."""
    (x, y), (across, height) = tilting_table.TABLE, tilting_table.LINE
    pin, offset = ("y-offset", across - y) if swivel == "A" else ("x-offset", across - x)
    kins = f"xyz{swivel.lower()}c-trt-kins"
    pins = {"x-rot-point": x, "y-rot-point": y, "z-rot-point": height, pin: offset}
    return "".join(f"setp {kins}.{name} {value}\n" for name, value in pins.items())


def off(swivel: str, files: Mapping[str, str]) -> Array:
    """Return by how much the tool is off at 40 places on the workpiece in TCP mode, (40, 3) um, one shift taken off."""
    names = ["X", "Y", "Z", swivel, "C"]
    joints = [Joint(n, LIMITS[n][0] - 150, LIMITS[n][1] + 150, table=files.get(f"{n}.comp")) for n in names]
    kins = f"xyz{swivel.lower()}c-trt-kins"
    hal = files.get("axiscal-pivots.hal") or nominal_pivots(swivel)
    hal += files.get("axiscal-cross.hal", "") + f"net tool-length motion.tooloffset.z => {kins}.tool-offset\n"
    wanted, sides, codes = _places(swivel, names)
    with Session(joints, Settings(hal, kins)) as session:
        session.move([f"G43.1 Z{tilting_table.TOOL}"])
        steps = session.move(codes)[1::2]
        assert session.errors == ()
    found = [
        tilting_table.tip(swivel, dict(zip(names, step.motor, strict=True)), dict(zip(names, side, strict=True)))
        for step, side in zip(steps, sides, strict=True)
    ]
    apart: Array = 1e3 * (np.array(found) - wanted)
    centred: Array = apart - np.mean(apart, axis=0)
    return centred


def _places(swivel: str, names: Sequence[str]) -> tuple[Array, list[list[int]], list[str]]:
    """Return places on the workpiece (40, 3), from which side each drive comes, and the moves, two for each."""
    rng = np.random.default_rng(8)
    low, high = np.array([LIMITS[n] for n in names], dtype=float).T
    wanted, sides, codes = [], [], []
    for _ in range(40):
        drives, side = rng.uniform(low + 5, high - 5), rng.choice([-1, 1], 5)
        for stand in (drives - 4 * side, drives):
            at = tilting_table.tip(swivel, dict(zip(names, stand, strict=True)))
            words = zip(names, (*at, *stand[3:]), strict=True)
            codes.append("G0 " + " ".join(f"{name}{value:.6f}" for name, value in words))
        wanted.append(at)
        sides.append([int(s) for s in side])
    return np.array(wanted), sides, codes


def rms(apart: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(apart**2, axis=1))))


@pytest.mark.parametrize("swivel", ["A", "B"])
def test_tables_are_right_on_kinematics_that_count_the_other_way(swivel: str, tmp_path: Path) -> None:
    record = read_everywhere(swivel, described(swivel, tmp_path), tmp_path / "out")
    files = exported(record, tmp_path / "tables", "--pivots")
    expected = json.loads((tmp_path / "said.json").read_text())["rms_um_expected"]
    before, after = rms(off(swivel, {})), rms(off(swivel, files))
    assert before > 30
    assert after < 1.3 * expected < 0.05 * before


def test_a_machine_told_the_wrong_way_gets_no_tables_and_is_told_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What the statement is for: the same readings without it. Tables that are written all the same are worse."""
    record = read_everywhere("A", described("A", tmp_path, 'direction = "iso"'), tmp_path / "out", status=1)
    assert NAMED in " ".join(capsys.readouterr().out.split())
    assert run(["export", str(record), "--to", "linuxcnc", "--out", str(tmp_path / "tables")]) == 1
    assert not (tmp_path / "tables").exists()
    files = exported(record, tmp_path / "tables", "--anyway")
    assert rms(off("A", files)) > 15


def test_requests_and_predictions_are_in_what_the_control_shows(tmp_path: Path) -> None:
    """Readings through `exec:` from the true machine, then its deviation at poses of the control, both directions."""
    command, campaign = f"exec:{sys.executable} {tilting_table.__file__} A", described("A", tmp_path)
    campaign.write_text(TRACKER)
    assert run(["run", str(campaign), "--source", command, "--out", str(tmp_path / "out")]) == 0
    rng = np.random.default_rng(3)
    names = "XYZAC"
    low, high = np.array([LIMITS[n] for n in names], dtype=float).T
    poses = [dict(zip(names, map(float, np.round(rng.uniform(low, high), 3)), strict=True)) for _ in range(12)]
    sides = [int(side) for side in rng.choice([-1, 1], 12)]
    rows = [
        f"{','.join(map(str, at.values()))},{_approach(names, side)}" for at, side in zip(poses, sides, strict=True)
    ]
    (tmp_path / "poses.csv").write_text("\n".join(["X_mm,Y_mm,Z_mm,A_deg,C_deg,approach", *rows]))
    said = printed(["predict", str(tmp_path / "out" / "campaign.axiscal"), str(tmp_path / "poses.csv"), "--json"])
    found = np.array([pose["mean_um"] for pose in said["poses"]])
    true = [tilting_table.deviation("A", at, dict.fromkeys(at, side)) for at, side in zip(poses, sides, strict=True)]
    apart = found - 1e3 * np.array(true)
    assert rms(apart - apart.mean(axis=0)) < 3
    assert rms(found - found.mean(axis=0)) > 30


def _approach(names: str, side: int) -> str:
    return " ".join(f"{name}{'+' if side > 0 else '-'}" for name in names)


def test_pivots_need_a_word_about_the_direction(
    tmp_path: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    record = read_everywhere("A", described("A", tmp_path, ""), tmp_path / "out", status=1)
    arguments = ["export", str(record), "--to", "linuxcnc", "--out", str(tmp_path / "tables"), "--anyway"]
    assert NAMED in " ".join(capsys.readouterr().out.split())
    assert "machine.toml does not say which way" in command(*arguments, "--pivots").refusal
    assert not (tmp_path / "tables").exists()
    assert run(arguments) == 0
    assert (tmp_path / "tables" / "README.txt").read_text().splitlines()[2].startswith("WHICH WAY DO C and A COUNT?")
