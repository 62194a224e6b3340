"""What loading tables does to the zero of a machine on a real LinuxCNC: nothing there, elsewhere what the note says."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from axiscal.cli.app import run
from axiscal.numerics import Array
from tests.generators.reaches import reach_of
from tests.generators.texts import machine_text
from tests.linuxcnc.lab import Joint, Session, Settings
from tests.linuxcnc.needed import LONG

pytestmark = LONG

MACHINE = machine_text(
    "w-X'-Y'-b-Z-t",
    {"X": (0, 400), "Y": (0, 300), "Z": (-250, 0)},
    {"EXX EYY EZZ": ("40 um", 7, 200), "EYX EXZ": "20 um", "C0Y B0Z": "100 urad", "EXX_reversal": "6 um"},
    curve=(5, 300),
    tool=80,
)
CAMPAIGN = 'machine = "machine.toml"\n[target]\nreadings = 9\n' + "".join(
    f'[[setups]]\nname = "{d}"\ninstrument = "probe"\ndirection = "{d}"\nnoise = "0.3 um"\nunknowns = {{}}\n'
    + reach_of(MACHINE)
    for d in "xyz"
)
NOTE = re.compile(r"at machine zero, (.*?) by (.*?) um; in the middle of the volume, (.*?) by (.*?) um")


def deviation(x: float, y: float, z: float, x_way: int) -> tuple[float, float, float]:
    """Return how far the tool is off on the workpiece, mm; far from zero in the mean."""
    return (
        0.024 + 0.010 * math.sin(x / 60) + 5e-5 * x - 7e-5 * y + 4e-5 * z + 0.003 * x_way,
        0.023 + 0.006 * math.cos(y / 60) + 3e-5 * y + 0.004 * math.sin(x / 90),
        0.0015 + 4e-5 * z,
    )


def test_the_tool_stays_at_machine_zero_and_moves_elsewhere_as_the_note_says(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    rng = np.random.default_rng(1)
    lines = ["setup,X_mm,Y_mm,Z_mm,approach,value_um"]
    for _ in range(80):
        x, y, z = (round(float(at), 6) for at in rng.uniform((0, 0, -250), (400, 300, 0)))
        way = int(rng.choice([-1, 1]))
        found = zip("xyz", deviation(x, y, z, way), strict=True)
        lines += [f"{d},{x},{y},{z},X{'+' if way > 0 else '-'} Y+ Z+,{1e3 * value:.4f}" for d, value in found]
    (tmp_path / "readings.csv").write_text("\n".join(lines))
    out, record = tmp_path / "out", tmp_path / "out" / "campaign.axiscal"
    assert run(["estimate", str(tmp_path / "campaign.toml"), str(tmp_path / "readings.csv"), "--out", str(out)]) == 0
    assert run(["export", str(record), "--to", "linuxcnc", "--out", str(tmp_path / "tables")]) == 0
    files = {path.name: path.read_text() for path in (tmp_path / "tables").iterdir()}
    first = files["README.txt"].splitlines()[1]
    assert first.startswith("ZERO WORK OFFSETS, TOOL SETTER AND PROBE ANEW")
    said = NOTE.search(first)
    assert said is not None
    assert (said[1], said[3]) == ("X 0 mm Y 0 mm Z 0 mm", "X 200 mm Y 150 mm Z -125 mm")
    at_zero, in_the_middle = moved(files)
    for text, found_there in ((said[2], at_zero), (said[4], in_the_middle)):
        numbers = [float(word) for word in re.findall(r"[-+][\d.]+", text)]
        assert numbers == pytest.approx(list(found_there), abs=0.06)
    assert np.abs(at_zero).max() < 0.05
    truly = [np.mean([deviation(*at, way) for way in (1, -1)], axis=0) for at in ((0, 0, 0), (200, 150, -125))]
    assert in_the_middle == pytest.approx(1e3 * (truly[0] - truly[1]), abs=1.0)
    assert np.abs(in_the_middle).max() > 5


def moved(files: dict[str, str]) -> tuple[Array, Array]:
    """Return how far LinuxCNC sends the tool beyond the command at zero and in the middle, mean of both sides, um."""
    joints = [Joint(name, -500, 500, table=files[f"{name}.comp"]) for name in "XYZ"]
    codes = [
        f"G0 X{at[0] - step} Y{at[1] - step} Z{at[2] - step}"
        for at in ((0, 0, 0), (200, 150, -125))
        for side in (3, -3)
        for step in (side, 0)
    ]
    with Session(joints, Settings(files["axiscal-cross.hal"])) as session:
        steps = session.move(codes)[1::2]
        assert session.errors == ()
    beyond = 1e3 * np.array([np.subtract(step.motor, step.command) for step in steps])
    return beyond[:2].mean(axis=0), beyond[2:].mean(axis=0)
