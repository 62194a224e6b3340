"""Measuring programs read by LinuxCNC's own interpreter: what it would make the machine do."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.motion import inward
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.programs import dialect, programs
from tests.certify.gcode import HOSTILE, Plan, interpreted, interpreter_verdicts, random_plan, reader_verdicts
from tests.certify.gcode_traces import canonical_calls, interpreter, read_canonical
from tests.linuxcnc.lab import Joint, Session, Settings
from tests.linuxcnc.running import ControlError
from tests.linuxcnc.watched import run

pytestmark = [
    pytest.mark.linuxcnc,
    pytest.mark.long,
    pytest.mark.skipif(interpreter() is None, reason="Debian package linuxcnc-uspace is not installed"),
]

SAMPLE = range(60)


@pytest.mark.parametrize("tens", range(0, len(SAMPLE), 20))
def test_random_plans_stay_in_the_travel_and_come_from_the_planned_side(tens: int, tmp_path: Path) -> None:
    for seed in SAMPLE[tens : tens + 20]:
        found = list(interpreted(random_plan(np.random.default_rng(seed)), tmp_path))
        assert [faults for _, faults in found if faults] == [], f"seed {seed}"
        assert all(moves for moves, _ in found)


def named(plan: Plan, name: str) -> Plan:
    """Return the plan with its machine and its one set-up under another name."""
    first = next(setup for setup in plan.setups if setup.name == plan.places[0].setup)
    places = tuple(replace(place, setup=name) for place in plan.places)
    return Plan(replace(plan.machine, name=name), (replace(first, name=name),), places)


@pytest.mark.parametrize("name", HOSTILE)
def test_a_name_adds_no_call(name: str, tmp_path: Path) -> None:
    plan = random_plan(np.random.default_rng(5))
    with_name, without = (
        canonical_calls(program.text, tmp_path)
        for each in (name, "A")
        for program in named(plan, each).programs("linuxcnc")
    )
    assert [call for call in with_name if not call.startswith("COMMENT")] == [
        call for call in without if not call.startswith("COMMENT")
    ]
    assert len(with_name) == len(without)
    said = [call for call in with_name if call.startswith("COMMENT") and call not in without]
    assert all(call.startswith(('COMMENT("SET-UP', 'COMMENT("MACHINE')) for call in said)
    assert [path.name for path in tmp_path.iterdir()] == ["program.ngc"]


@pytest.mark.parametrize(
    "line", ["G0 X1", "G53 G0 X1", "M3 S100", "T1", "G20", "G91", "G38.2 X999 F10", "G10 L2 P1 X5", "G43.1 Z5", "M5"]
)
def test_the_reader_of_the_calls_refuses_what_does_not_belong(line: str, tmp_path: Path) -> None:
    (program,) = named(random_plan(np.random.default_rng(5)), "A").programs("linuxcnc")
    head, rest = program.text.split("M0\n", 1)
    assert read_canonical(canonical_calls(f"{head}M0\n{rest}", tmp_path))
    with pytest.raises(AssertionError):
        read_canonical(canonical_calls(f"{head}M0\n{line}\n{rest}", tmp_path))


def test_offsets_in_force_do_not_move_the_readings(tmp_path: Path) -> None:
    (program,) = named(random_plan(np.random.default_rng(5)), "A").programs("linuxcnc")
    offset = np.array([12.5, -3.0, 8.0, 4.0, 5.0, 6.0])
    words = " ".join(f"{axis}{value}" for axis, value in zip("XYZABC", offset, strict=True))
    plain = feeds(canonical_calls(program.text, tmp_path))
    moved = feeds(canonical_calls(f"G10 L2 P1 {words}\nG54\n{program.text}", tmp_path))
    np.testing.assert_allclose(moved + offset, plain, atol=1e-9)
    assert len(plain) > 3


def feeds(calls: list[str]) -> Array:
    """Return the ends of the feed moves, (n, 6), in the coordinates in force."""
    ends = [call.partition("(")[2][:-1].split(",") for call in calls if call.startswith("STRAIGHT_FEED")]
    return np.array(ends, dtype=np.float64)


def test_a_running_linuxcnc_goes_to_the_very_ends_of_the_travel_and_nowhere_else() -> None:
    axes = [Axis.named(name, False, (-0.0123, 0.0456), speed=0.5) for name in "XYZ"]
    table = Axis.named("C", True, (0.0, 2 * np.pi), speed=20.0)
    machine = Machine("m", (table, *axes), 0.0, (), "", "")
    low, high = np.array([axis.travel for axis in machine.axes]).T
    rng = np.random.default_rng(3)
    poses = [low, high, *rng.uniform(low + 0.001, high - 0.001, (6, 4))]
    sides = [(0, 0, 0, 0)] * 2 + [tuple(map(int, row)) for row in rng.integers(-1, 2, (6, 4))]
    setup = Setup("s", "probe", (1, 0, 0), (0, 1, 2, 3), tuple(low), 1e-6, (), 0, 0.001, 0, (0.0,) * 4, "both")
    places = [tuple(map(inward, machine.axes, map(float, pose), side)) for pose, side in zip(poses, sides, strict=True)]
    readings = [Place(setup.name, place, side) for place, side in zip(places, sides, strict=True)]
    (program,) = programs(machine, [setup], readings, dialect("linuxcnc"))
    codes = [line for line in program.text.splitlines()[:-1] if line[0] == "G"]
    joints = [Joint(axis, *((0.0, 360.0) if axis == "C" else (-12.3, 45.6))) for axis in "XYZC"]
    done = run(joints, [*codes, "G53 G1 X45.6 F9000"])
    assert done.errors == ()
    for code, step in zip(codes, done.steps, strict=False):
        for word in code.split():
            if code.startswith("G53") and word[0] in "XYZC":
                assert step.motor["XYZC".index(word[0])] == pytest.approx(float(word[1:]), abs=1e-6)
    with pytest.raises(ControlError, match="limit"):
        run(joints, ["G53 G1 X45.6001 F9000"])


def test_a_machine_set_up_in_inches_goes_to_the_same_places() -> None:
    axes = tuple(Axis.named(name, False, (0.0, 0.2), speed=0.5) for name in "XYZ")
    machine = Machine("m", axes, 0.0, (), "", "")
    setup = Setup("s", "probe", (1, 0, 0), (0, 1, 2), (0.0,) * 3, 1e-6, (), 0, 0.001, 0, (0.0,) * 3, "both")
    rng = np.random.default_rng(5)
    places = [Place("s", tuple(map(float, rng.uniform(0.01, 0.19, 3))), (1, -1, 0)) for _ in range(5)]
    (program,) = programs(machine, [setup], places, dialect("linuxcnc"))
    codes = [line for line in program.text.splitlines()[:-1] if line[0] == "G" or line == "M5 M9"]
    joints = [Joint(axis, 0.0, 200 / 25.4, 200.0, 2e4) for axis in "XYZ"]
    with Session(joints, Settings(unit="in")) as session:
        steps = session.move(codes)
        assert session.errors == ()
    checked = 0
    for code, step in zip(codes, steps, strict=True):
        for word in code.split()[2:] if code.startswith("G53") else []:
            if word[0] in "XYZ":
                assert step.motor["XYZ".index(word[0])] * 25.4 == pytest.approx(float(word[1:]), abs=1e-5)
                checked += 1
    assert checked > 15


def test_the_campaign_says_how_much_it_read() -> None:
    found = [*interpreter_verdicts(3, 0), *reader_verdicts(3, 0)]
    assert len(found) == 6
    assert all(good for _, good in found)
    assert found[0][0].startswith("LinuxCNC's interpreter: ")
