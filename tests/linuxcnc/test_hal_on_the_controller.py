"""The HAL text on a real LinuxCNC: several joints for an axis, and no jump whatever homes when."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from axiscal.cli.app import run
from axiscal.ports.linuxcnc.tables import cross
from axiscal.tables.table import CompensationTable
from tests.commands import Command
from tests.generators.reaches import reach_of
from tests.generators.texts import machine_text
from tests.linuxcnc.lab import Joint, Session, Settings
from tests.linuxcnc.needed import LONG
from tests.linuxcnc.watched import WatchedSession

pytestmark = LONG

SPEEDS = {"X": 0.2, "Y": 0.2, "Z": 0.2}


def bend(axis: str, over: str, size: float) -> CompensationTable:
    """An axis that is off by a parabola over another: nothing at zero, `size` m at 200 mm."""
    at = np.linspace(-0.2, 0.2, 15)
    values = size * (at / 0.2) ** 2
    return CompensationTable(axis, at, values, values, np.full(15, 1e-7), over)


def watched(signals: list[str]) -> str:
    """HAL text that keeps the fastest that signals have moved, mm/s."""
    names = [f"{kind}-{i}" for kind in ("rate", "most") for i in range(len(signals))]
    rates, most = names[: len(signals)], names[len(signals) :]
    lines = [f"loadrt ddt names={','.join(rates)}", f"loadrt minmax names={','.join(most)}"]
    for signal, rate, peak in zip(signals, rates, most, strict=True):
        lines += [f"addf {rate} servo-thread", f"addf {peak} servo-thread", f"net {signal} => {rate}.in"]
        lines.append(f"net {rate}-speed {rate}.out => {peak}.in")
    return "\n".join(lines) + "\n"


def fastest(session: Session, count: int) -> list[float]:
    """The fastest that each watched signal has moved since the last `forget`."""
    ends = session.read([f"most-{i}.{end}" for i in range(count) for end in ("max", "min")])
    return [max(abs(high), abs(low)) for high, low in zip(ends[::2], ends[1::2], strict=True)]


def forget(session: Session, count: int) -> None:
    for value in (1, 0):
        session.move([f"setp most-{i}.reset {value}" for i in range(count)])


def test_a_correction_comes_and_goes_smoothly_with_homing() -> None:
    """X is off by 100 um where Y stands; Y's joint is homed there, and its coordinate becomes zero."""
    table = bend("X", "Y", 1e-4)
    wiring = cross.Wiring({"X": (0,), "Y": (1,), "Z": (2,)}, SPEEDS)
    text = cross.write([table, bend("X", "Z", 5e-5)], wiring) + watched(["axiscal-x-correction"])
    limit = cross.fastest([table, bend("X", "Z", 5e-5)], SPEEDS) * 1e3
    joints = [Joint(axis, velocity=200.0, acceleration=2000.0) for axis in "XYZ"]
    with WatchedSession(joints, Settings(text)) as session:
        ramped = [session.read(["axiscal-x-correction", "axiscal-gain"]) for _ in range(40)]
        assert all(abs(value) < 1e-9 for value, _ in ramped)  # X is right where Y and Z are zero
        session.move(["G4 P1.1", "G0 Y200"])
        (there,) = session.read(["axiscal-x-correction"])
        assert there == pytest.approx(-0.1, abs=1e-6)
        forget(session, 1)
        session.move(["G0 Y-200", "G0 Y200"])
        assert 0.05 < fastest(session, 1)[0] <= limit  # on the way it follows, no faster than it may
        assert session.read(["axiscal-x-correction"])[0] == pytest.approx(-0.1, abs=1e-6)
        forget(session, 1)
        ending = session.move(["home 1", "G4 P1.5"])[-1]
        assert ending.command[1] == pytest.approx(0, abs=1e-9)
        assert session.read(["axiscal-x-correction"])[0] == pytest.approx(0, abs=1e-9)
        assert 0 < fastest(session, 1)[0] <= limit * 1.0001
        assert session.errors == ()


def test_the_speed_that_is_allowed_is_far_below_a_jump() -> None:
    """100 um in one period would be 100 mm/s."""
    assert cross.fastest([bend("X", "Y", 1e-4)], SPEEDS) * 1e3 < 1.0
    assert cross.fastest([bend("X", "Y", 1e-7)], SPEEDS) == cross.LEAST_SPEED


def test_before_all_joints_are_homed_nothing_is_added_and_then_it_is_ramped() -> None:
    """The curve is 50 um where the machine is switched on, and the DISPLAY program homes at once."""
    at = np.linspace(-0.2, 0.2, 3)
    table = CompensationTable("X", at, np.full(3, 5e-5), np.full(3, 5e-5), np.full(3, 1e-7), "Y")
    wiring = cross.Wiring({"X": (0,), "Y": (1,), "Z": (2,)}, SPEEDS)
    text = cross.write([table], wiring) + watched(["axiscal-x-correction"])
    with Session([Joint(axis) for axis in "XYZ"], Settings(text)) as session:
        early = session.read(["axiscal-x-correction"])[0]
        session.move(["G4 P1.2"])
        assert early > -0.049
        assert session.read(["axiscal-x-correction"])[0] == pytest.approx(-0.05, abs=1e-9)
        assert fastest(session, 1)[0] == pytest.approx(0.05 / cross.RAMP, rel=0.01)


GANTRY = machine_text(
    "w-b-Y-X-Z-t",
    {"X": (0, 300), "Y": (0, 200), "Z": (0, 100)},
    {"EXX EYY EYX": "20 um", "C0Y": "90 urad", "EYY_reversal": "8 um"},
    tool=50,
)
CAMPAIGN = 'machine = "machine.toml"\n[target]\nreadings = 9\n' + "".join(
    f'[[setups]]\nname = "{d}"\ninstrument = "probe"\ndirection = "{d}"\nnoise = "0.3 um"\nunknowns = {{}}\n'
    + reach_of(GANTRY)
    for d in "xy"
)


def off(x: float, y: float, way: int) -> tuple[float, float]:
    """How far the tool is off on the workpiece, mm."""
    return 6e-5 * x + 1.1e-4 * y, -8e-5 * y + 0.01 * np.sin(x / 70) + 0.004 * way


@pytest.fixture(scope="module")
def gantry(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("gantry")
    (folder / "machine.toml").write_text(GANTRY)
    (folder / "campaign.toml").write_text(CAMPAIGN)
    rng = np.random.default_rng(2)
    lines = ["setup,X_mm,Y_mm,Z_mm,approach,value_um"]
    for _ in range(60):
        x, y, way = round(float(rng.uniform(0, 300)), 4), round(float(rng.uniform(0, 200)), 4), int(rng.choice([-1, 1]))
        for setup, value in zip("xy", off(x, y, way), strict=True):
            lines.append(f"{setup},{x},{y},50,Y{'+' if way > 0 else '-'},{1e3 * value:.4f}")
    (folder / "r.csv").write_text("\n".join(lines))
    arguments = ["estimate", str(folder / "campaign.toml"), str(folder / "r.csv"), "--out", str(folder / "out")]
    assert run(arguments) == 0
    return folder / "out" / "campaign.axiscal"


def test_both_joints_of_a_gantry_are_corrected_alike(gantry: Path, tmp_path: Path) -> None:
    out = tmp_path / "tables"
    arguments = ["export", str(gantry), "--to", "linuxcnc", "--number", "Y=1", "--number", "Y=2", "--out", str(out)]
    assert run(arguments) == 0
    files = {path.name: path.read_text() for path in out.iterdir()}
    assert "[JOINT_1] and [JOINT_2]: COMP_FILE = Y.comp" in files["README.txt"]
    joints = [Joint(axis, table=files.get(f"{axis}.comp")) for axis in "XYYZ"]
    codes, sides = [], []
    for x, y in ((20, 30), (280, 190), (150, 100), (250, 20)):
        for side in (1, -1):
            codes += [f"G0 X{x} Y{y - 3 * side}", f"G0 X{x} Y{y}"]
            sides.append(side)
    with Session(joints, Settings(files["axiscal-cross.hal"])) as session:
        session.move(["G4 P1.1"])
        steps = session.move(codes)[1::2]
        assert session.errors == ()
    left = []
    for ending, side in zip(steps, sides, strict=True):
        across, left_y, right_y, _ = ending.motor
        assert left_y == right_y
        left.append(np.add((across, left_y), off(across, left_y, side)) - np.array(ending.command)[[0, 1]])
    spread = np.array(left) - np.mean(left, axis=0)
    assert np.abs(spread).max() < 1e-3
    assert max(abs(value) for ending in steps for value in off(ending.command[0], ending.command[1], 1)) > 15e-3


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        (["Y=1", "Y=1"], "Y is given twice the same number 1"),
        (["X=0", "Y=0"], "X and Y have the same number 0"),
        (["Y=2"], "Y and Z have the same number 2"),
        (["Q=1"], 'no axis "Q"'),
    ],
)
def test_a_number_given_twice_is_refused(
    gantry: Path, numbers: list[str], message: str, tmp_path: Path, command: Command
) -> None:
    given = [word for number in numbers for word in ("--number", number)]
    assert message in command("export", gantry, "--to", "linuxcnc", "--out", tmp_path / "t", *given).refusal
    assert not (tmp_path / "t").exists()


def test_other_controls_take_one_number(gantry: Path, tmp_path: Path, command: Command) -> None:
    given = ["--number", "Y=2", "--number", "Y=3", "--number", "Z=4"]
    assert (
        "Y is given the numbers 2 and 3"
        in command("export", gantry, "--to", "sinumerik", "--out", tmp_path / "t", *given).refusal
    )
    assert (
        len(command("export", gantry, "--to", "linuxcnc", "--out", tmp_path / "t", *given, "--json").document["files"])
        > 2
    )
