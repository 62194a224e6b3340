"""Axes that count against ISO 841: a campaign on a machine with LinuxCNC's own trt-kins, tables in, in TCP mode.

The machine is written from what its drives do and from nothing of the package: a mill with a table C on a swivel A,
whose drive that counts up turns the workpiece by the right hand, against ISO 841. Lengths in mm, angles in deg.
"""

from collections.abc import Mapping
from math import cos, radians, sin
from pathlib import Path

import numpy as np

from axiscal.numerics import Array
from tests.commands import Command
from tests.generators.kinematics import turned
from tests.generators.texts import machine_text
from tests.linuxcnc.lab import Joint, Session, Settings
from tests.linuxcnc.needed import LONG

pytestmark = LONG

LIMITS = {"X": (-150, 150), "Y": (-150, 150), "Z": (0, 200), "A": (-60, 60), "C": (0, 360)}
ERRORS = {
    "EXX": 'std = "15 um", knots = 7, length = "100 mm", rest = "0.3 um"',
    "EYY EZZ": 'std = "12 um", knots = 7, length = "100 mm", rest = "0.3 um"',
    "EXX_reversal EYY_reversal": "6 um",
    "C0Y B0Z A0Z": "50 urad",
    "ECC": 'std = "80 urad", knots = 9, length = "60 deg", rest = "1 urad"',
    "X0C Y0C Y0A Z0A": "20 um",
    "EAA": 'std = "80 urad", knots = 7, length = "45 deg", rest = "1 urad"',
    "EAA_reversal": "20 urad",
}
CAMPAIGN = 'machine = "machine.toml"\n[target]\nreadings = 50\n' + "".join(
    f'[[setups]]\nname = "{d}"\ninstrument = "probe"\ndirection = "{d}"\nnoise = "0.3 um"\napproach = "both"\n'
    'unknowns = { zero = "100 um" }\n'
    for d in "xyz"
)
TOOL, TABLE, ACROSS, HEIGHT = 80.0, np.array([4.0, -3.0]), 7.0, -120.0
"""The tool's length, where the line of C is, and where that of the swivel: across the bed, and its height."""


def tip(drives: Array, sides: Array | None = None) -> Array:
    """Return where the tool is on the workpiece, (3,); a machine without errors where no sides are given."""
    x, y, z, swing, turn = drives.tolist()
    line = np.array([ACROSS, HEIGHT])
    if sides is not None:
        turn += np.degrees(9e-5 * sin(radians(turn)) + 4e-5 * cos(radians(2 * turn)))
        swing += np.degrees(1.1e-4 * sin(radians(2.2 * swing)) + 7e-5 * radians(swing) + 1.2e-5 * sides[3])
        x, y, z = (
            x + 0.014 * sin(x / 70) + 1.2e-4 * x + 0.003 * sides[0] - 4e-5 * y + 3e-5 * z,
            y - 0.011 * sin(y / 60) - 0.9e-4 * y + 0.0025 * sides[1] - 2e-5 * z,
            z + 0.009 * cos(z / 80) + 1.1e-4 * z,
        )
    pivot = np.array([0.0, *line])
    at = pivot + turned("A", -radians(swing))[:3, :3] @ (np.array([x, y, z - TOOL]) - pivot)
    middle = np.array([*TABLE, 0.0])
    found: Array = middle + turned("C", -radians(turn))[:3, :3] @ (at - middle)
    return found


def machine(direction: str) -> str:
    """Return the description of the tilting table by its owner."""
    text = machine_text("w-C'-A'-b-X-Y-Z-t", LIMITS, ERRORS, tool=TOOL)
    for axis, (x, y) in (("A", (0.0, ACROSS)), ("C", TABLE)):
        stated = f'origin = ["{x} mm", "{y} mm", "{HEIGHT} mm"]\ndirection = "{direction}"\n'
        text = text.replace(f"[axes.{axis}]\n", f"[axes.{axis}]\n{stated}")
    return text


def drawn(count: int, seed: int, room: float = 0.0) -> tuple[Array, Array]:
    """Return where the drives stand and from which side they come, both (count, 5)."""
    rng = np.random.default_rng(seed)
    low, high = np.array([*LIMITS.values()], dtype=float).T
    places = rng.uniform(low + room, high - room, (count, 5)).round(6)
    return places, rng.choice([-1.0, 1.0], (count, 5))


def read_everywhere(folder: Path, command: Command, direction: str = "reversed") -> tuple[Path, str, int]:
    """Return the record of 210 readings of the true machine, three at each place, what was said, and the status."""
    lines, rng = list[str](), np.random.default_rng(5)
    for drives, sides in zip(*drawn(70, 5), strict=True):
        off = 1e3 * (tip(drives, sides) - tip(drives)) + 0.3 * rng.standard_normal(3)
        come = " ".join(f"{axis}{'+' if side > 0 else '-'}" for axis, side in zip(LIMITS, sides, strict=True))
        at = ",".join(f"{value:.6f}" for value in drives)
        lines += [f"{way},{at},{come},{value:.4f}" for way, value in zip("xyz", off, strict=True)]
    head = ",".join(f"{axis}_{'deg' if axis in 'ABC' else 'mm'}" for axis in LIMITS)
    (folder / "machine.toml").write_text(machine(direction))
    (folder / "campaign.toml").write_text(CAMPAIGN)
    (folder / "readings.csv").write_text("\n".join([f"setup,{head},approach,value_um", *lines, ""]))
    done = command("estimate", folder / "campaign.toml", folder / "readings.csv", "--out", folder / "out")
    return folder / "out" / "campaign.axiscal", " ".join(done.out.split()), done.status


def off(files: Mapping[str, str]) -> float:
    """Return the RMS by which the tool is off at 40 places on the workpiece in TCP mode, um, one shift taken off."""
    joints = [Joint(n, LIMITS[n][0] - 150, LIMITS[n][1] + 150, table=files.get(f"{n}.comp")) for n in LIMITS]
    kins = "xyzac-trt-kins"
    nominal = dict(zip(("x-rot-point", "y-rot-point"), TABLE, strict=True)) | {"z-rot-point": HEIGHT}
    nominal["y-offset"] = ACROSS - nominal["y-rot-point"]
    hal = "".join(f"setp {kins}.{pin} {at}\n" for pin, at in nominal.items())
    hal += files.get("axiscal-cross.hal", "") + f"net tool-length motion.tooloffset.z => {kins}.tool-offset\n"
    places, sides = drawn(40, 8, room=5.0)
    codes = list[str]()
    for stand in np.stack([places - 4 * sides, places], axis=1).reshape(-1, 5):
        words = zip(LIMITS, (*tip(stand), *stand[3:]), strict=True)
        codes.append("G0 " + " ".join(f"{name}{value:.6f}" for name, value in words))
    with Session(joints, Settings(hal, kins)) as session:
        session.move([f"G43.1 Z{TOOL}"])
        steps = session.move(codes)[1::2]
        assert session.errors == ()
    went = [tip(np.array(step.motor), side) for step, side in zip(steps, sides, strict=True)]
    apart = 1e3 * (np.array(went) - [tip(place) for place in places])
    return float(np.sqrt(np.mean(np.sum((apart - apart.mean(axis=0)) ** 2, axis=1))))


def test_tables_are_right_on_kinematics_that_count_the_other_way(tmp_path: Path, command: Command) -> None:
    record, _, status = read_everywhere(tmp_path, command)
    assert status == 0
    done = command("export", record, "--to", "linuxcnc", "--out", tmp_path / "tables", "--json")
    files = {path.name: path.read_text() for path in (tmp_path / "tables").iterdir()}
    before, after = off({}), off(files)
    assert before > 30
    assert after < 1.3 * done.document["rms_um_expected"] < 0.05 * before


def test_a_machine_told_the_wrong_way_gets_no_tables_and_is_told_so(tmp_path: Path, command: Command) -> None:
    """What the statement is for: the same readings without it."""
    record, said, status = read_everywhere(tmp_path, command, "iso")
    assert status == 1
    assert "correct direction of C, A in the machine's file" in said
    assert command("export", record, "--to", "linuxcnc", "--out", tmp_path / "tables").status == 1
    assert not (tmp_path / "tables").exists()
