"""Tables loaded into Debian's LinuxCNC: it reads them as our model says and commands what our prediction says."""

from functools import cache

import numpy as np
import pytest

from axiscal.numerics import Array
from axiscal.ports.linuxcnc.tables.writer import notes, parse, write
from axiscal.tables.table import CompensationTable
from tests.linuxcnc.lab import Ending, Joint, Run, run
from tests.linuxcnc.needed import LINUXCNC
from tests.tables.test_linuxcnc import correction

pytestmark = LINUXCNC

CLOSE = 1e-5  # mm or deg
SCALES = {"X": 1e-3, "Y": 1e-3, "C": np.pi / 180}
UNITS = {"X": "mm", "Y": "mm", "C": "deg"}


def deviations(axis: str) -> CompensationTable:
    """A table with reversal, as measured ones are: some tens of um or arcsec, uneven points; of C over turns."""
    rng = np.random.default_rng(ord(axis))
    positions = (np.linspace(-200, 200, 32) * (1 if axis != "C" else 4) + np.r_[0, rng.uniform(-4, 4, 30), 0]) * SCALES[
        axis
    ]
    wave = 2e-5 * np.sin(positions / (80 * SCALES[axis])) + rng.normal(0, 1e-6, 32)
    reverse = wave - 8e-6 - 3e-6 * np.cos(positions / (60 * SCALES[axis]))
    return CompensationTable(axis, positions, wave, wave if axis == "Y" else reverse, np.full(32, 1e-6))


def visits(points: Array) -> list[str]:
    """Moves that reach every point once upwards and once downwards, in all axes at once."""
    lines = []
    for point in points:
        for side in (1, -1):
            lines += [f"G0 X{point - side * 5:.6f} Y{-point - side * 5:.6f} C{4 * point - side * 5:.6f}"]
            lines += [f"G0 X{point:.6f} Y{-point:.6f} C{4 * point:.6f}"]
    return lines


POINTS = np.r_[-240.0, -200.0, np.random.default_rng(7).uniform(-199, 199, 20), 0.0, 200.0, 240.0]


@cache
def visited() -> Run:
    """One start of LinuxCNC with all three tables; hardly any acceleration is left in the last cycle of a move."""
    joints = [Joint(axis, -1e3, 1e3, acceleration=1e5, table=write(deviations(axis), UNITS[axis])) for axis in SCALES]
    return run(joints, visits(POINTS))


def reached(run: Run) -> list[tuple[int, Ending]]:
    """Direction of approach and end of every second move, those that end on a point."""
    return [(1 if number % 2 == 0 else -1, step) for number, step in enumerate(run.steps[1::2])]


@pytest.mark.parametrize(("joint", "axis"), list(enumerate(SCALES)))
def test_motor_commands_are_as_predicted_in_both_directions(joint: int, axis: str) -> None:
    parsed = parse(write(deviations(axis), UNITS[axis]))
    assert visited().errors == ()
    for direction, step in reached(visited()):
        command = step.command[joint]
        predicted = command + correction(parsed, np.array([command]), direction)[0]
        assert step.settled
        assert step.motor[joint] == pytest.approx(predicted, abs=CLOSE)


def test_before_the_first_motion_there_is_no_correction() -> None:
    assert visited().start == (0, 0, 0)
    assert abs(correction(parse(write(deviations("X"), "mm")), np.array([0.0]), 1)[0]) > CLOSE


SPOILT = {
    "X": "# made by hand\n0 0.1 0.1\n",
    "Y": "0 0.1 0.1\n\n100 100.5 100.5\n",
    "Z": "0 0.1 0.1\n50 50.2 50.2\n20 20.9 20.9\n100 100.3 100.3\n",
    "C": "".join(f"{i - 100} {i - 99.9:.3f} {i - 99.9:.3f}\n" for i in range(258)),
    "B": "0\t1e-1\t+0.125 ; tab\r\n100 100.2 100.4",
    "A": "0 0.1 0.1" + " " * 300 + "\n100 100.5 100.5\n",
}


@pytest.mark.long
def test_spoilt_files_are_read_as_our_model_reads_them() -> None:
    joints = [Joint(axis, acceleration=2000.0, table=text) for axis, text in SPOILT.items()]
    moves = [" ".join(["G0", *(f"{axis}{at}" for axis in SPOILT)]) for at in (-20, 10, 70, 130)]
    ended = run(joints, moves)
    parsed = [parse(text) for text in SPOILT.values()]
    assert len(ended.errors) == 3
    for direction, step in zip((-1, 1, 1, 1), ended.steps, strict=True):
        for joint, table in enumerate(parsed):
            command = step.command[joint]
            predicted = command + correction(table, np.array([command]), direction)[0]
            assert step.motor[joint] == pytest.approx(predicted, abs=CLOSE), (joint, command)


@pytest.mark.parametrize(("step", "stuck"), [(0.020, True), pytest.param(0.040, False, marks=pytest.mark.long)])
def test_the_dead_band_is_where_the_warning_says(step: float, stuck: bool) -> None:
    """With 50 m/s² and 1 ms a reversal step above 12.5 um and up to 25 um is never carried out."""
    positions, level = np.array([-0.1, 0.1]), np.zeros(2)
    table = CompensationTable("X", positions, level, level - step * 1e-3, level)
    said = notes(table, "mm", (0,), acceleration=50.0)
    ended = run([Joint("X", acceleration=50000.0, table=write(table, "mm"))], ["G0 X5", "G0 X2"])
    assert any(note.startswith("WARNING") for note in said) is stuck
    assert ended.steps[1].settled is not stuck
    assert ended.steps[1].motor[0] - 2 == pytest.approx(0 if stuck else step, abs=1e-6)
