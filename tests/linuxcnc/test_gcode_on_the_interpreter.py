"""Measuring programs read by LinuxCNC's own interpreter: what it would make the machine do."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.machine.axis import iso_axis
from axiscal.machine.motion import inward
from axiscal.measurement.instruments.displacement import Probe
from axiscal.measurement.reading import Place
from axiscal.programs import dialect, programs
from axiscal_core.machine import Machine
from tests.linuxcnc.lab import Joint, run
from tests.linuxcnc.running import ControlError
from tests.programs.judge import HOSTILE, Plan, interpreted, random_plan
from tests.programs.readers import canonical_calls, interpreter

pytestmark = [
    pytest.mark.linuxcnc,
    pytest.mark.long,
    pytest.mark.skipif(interpreter() is None, reason="Debian package linuxcnc-uspace is not installed"),
]


def test_random_plans_stay_in_the_travel_and_come_from_the_planned_side(tmp_path: Path) -> None:
    for seed in range(25):
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


def test_a_running_linuxcnc_goes_to_the_very_ends_of_the_travel_and_nowhere_else() -> None:
    axes = [iso_axis(name, False, (-0.0123, 0.0456), speed=0.5) for name in "XYZ"]
    table = iso_axis("C", True, (0.0, 2 * np.pi), speed=20.0)
    machine = Machine((table, *axes), tool=0.0, name="m")
    low, high = np.array([axis.travel for axis in machine.axes]).T
    rng = np.random.default_rng(3)
    poses = [low, high, *rng.uniform(low + 0.001, high - 0.001, (6, 4))]
    sides = [(0, 0, 0, 0)] * 2 + [tuple(map(int, row)) for row in rng.integers(-1, 2, (6, 4))]
    setup = Probe("s", machine, (1, 0, 0), (0, 1, 2, 3), tuple(low), 1e-6, (), 0, 0.001, 0, (0.0,) * 4, "both")
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
