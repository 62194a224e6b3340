"""Whatever is in force before a measuring program, its motion is the same: tried on LinuxCNC's own interpreter."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from axiscal.numerics import Array
from benchmarks.zoo.animals import Job
from benchmarks.zoo.mills import LATHE
from benchmarks.zoo.running import described, given
from tests.programs.readers import canonical_calls

SHIFTS = {"SET_G5X_OFFSET": 1, "SET_G92_OFFSET": 0, "USE_TOOL_LENGTH_OFFSET": 0}
"""Calls that shift what is meant, and the numbers before X Y Z."""
STATES = ("G7", "G20", "G91", "G93", "G95", "G18", "G19", "G91.1", "G43.1 Z7", "G92 X4 Z-3", "G10 L2 P1 X5 Z2 R30")


NEEDS_RS274 = pytest.mark.skipif(shutil.which("rs274") is None, reason="LinuxCNC's interpreter is not installed")


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A program for the cross slide of a lathe, by the command line."""
    folder = tmp_path_factory.mktemp("lathe")
    campaign = described(Job(LATHE, ("laser",), "20 um"), folder / "job")
    assert given("plan", campaign, "--readings", 8, "--gcode", "linuxcnc", "--out", folder / "nc").status == 0
    return next(path.read_text() for path in sorted(folder.rglob("*.ngc")) if path.stem.endswith("_X"))


def moves(calls: list[str]) -> Array:
    """Return where feeds lead, (m, 4): X Y Z of the machine, mm, and mm/min.

    The interpreter says places in what is in force: the turn about z comes after G92 and before the rest.
    """
    shifts, turn, feed, unit, found = dict.fromkeys(SHIFTS, np.zeros(3)), 0.0, 0.0, 1.0, []
    for call in calls:
        name, numbers = (
            call.partition("(")[0],
            [float(each) for each in re.findall(r"-?\d+\.?\d*", call.split("(")[-1])],
        )
        if name in SHIFTS:
            shifts[name] = np.array(numbers[SHIFTS[name] :][:3])
        elif name == "USE_LENGTH_UNITS":
            unit = 25.4 if "INCHES" in call else 1.0
        elif name == "SET_XY_ROTATION":
            turn = np.radians(numbers[0])
        elif name == "SET_FEED_RATE":
            feed = numbers[0]
        elif name == "STRAIGHT_FEED":
            x, y, z = np.array(numbers[:3]) + shifts["SET_G92_OFFSET"]
            turned = np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y, z
            at = np.array(turned) + shifts["SET_G5X_OFFSET"] + shifts["USE_TOOL_LENGTH_OFFSET"]
            found.append([*unit * at, unit * feed])
    return np.array(found)


@NEEDS_RS274
@pytest.mark.parametrize("state", STATES)
def test_the_motion_does_not_hang_on_what_is_in_force(program: str, state: str, tmp_path: Path) -> None:
    bare, before = (moves(canonical_calls(text, tmp_path)) for text in (program, f"{state}\n{program}"))
    assert len(bare) >= 4
    assert np.ptp(bare[:, 0]) > 50
    np.testing.assert_allclose(before[:, [0, 2, 3]], bare[:, [0, 2, 3]], atol=2e-4)


@NEEDS_RS274
@pytest.mark.parametrize("state", ["G7", "G20"])
def test_without_its_head_the_motion_would_be_another(program: str, state: str, tmp_path: Path) -> None:
    headless = program.partition("\n")[2]
    bare, before = (moves(canonical_calls(text, tmp_path)) for text in (program, f"{state}\n{headless}"))
    assert not np.allclose(before[:, 0], bare[:, 0], atol=1.0)
