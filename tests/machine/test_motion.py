"""How a machine moves while measuring: times against a run in small steps, overrun and room."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.machine import machine_from_text
from axiscal.machine.axis import iso_axis
from axiscal.machine.motion import Driving, approach_seconds, inward, travel_seconds, turning
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

X = iso_axis("X", False, (0.0, 0.6), speed=0.2, acceleration=1.0)
Y = iso_axis("Y", True, (0.0, 0.4), speed=0.1, acceleration=3.0)
C = iso_axis("C", True, (0.0, math.tau), speed=1.0, acceleration=5.0)
MACHINE = Machine((C, Y, X), tool=0.1, name="m")

TOML = """
chain = "w-C'-b-X-t"
[axes.C]
travel = ["0 deg", "360 deg"]
{c}
[axes.X]
travel = ["0 mm", "600 mm"]
{x}
[errors]
EXX = {{ std = "10 um" }}
"""


def stepped(axes: tuple[Axis, ...], ways: list[float], step: float = 1e-4) -> float:
    """Return the time of a straight move by taking it in small steps: as fast as each axis lets it."""
    top = min((axis.speed / way for axis, way in zip(axes, ways, strict=True) if way), default=math.inf)
    push = min((axis.acceleration / way for axis, way in zip(axes, ways, strict=True) if way), default=math.inf)
    if top == math.inf:
        return 0.0
    done, speed, seconds = 0.0, 0.0, 0.0
    while done < 1.0:
        braking = speed**2 / (2 * push)
        speed = max(speed - push * step, 1e-9) if 1.0 - done <= braking else min(speed + push * step, top)
        done, seconds = done + speed * step, seconds + step
        if speed <= 1e-9:
            break
    return seconds


@pytest.mark.parametrize("ways", [(0.3, 0.05), (0.3, 0.3), (0.0, 0.2), (0.001, 0.0005), (0.5, 0.01), (0.0, 0.0)])
def test_a_straight_move_takes_as_long_as_in_small_steps(ways: tuple[float, float]) -> None:
    start, stop = np.array([1.0, 0.05, 0.05]), np.array([1.0, 0.05 + ways[1], 0.05 + ways[0]])
    assert float(travel_seconds(MACHINE, start, stop)) == pytest.approx(stepped((X, Y), list(ways)), abs=3e-3)


@given(
    st.tuples(*[st.floats(0, 0.4)] * 3),
    st.tuples(*[st.floats(0, 0.4)] * 3),
    st.tuples(*[st.sampled_from([-1, 0, 1])] * 3),
)
def test_whoever_arrives_from_a_side_comes_over_the_overrun(
    start: tuple[float, ...], stop: tuple[float, ...], side: tuple[int, ...]
) -> None:
    begin, end, sides = np.array(start), np.array(stop), np.array(side, dtype=float)
    past = turning(MACHINE, begin, end, sides)
    for k, axis in enumerate(MACHINE.axes):
        if side[k] == 0:
            assert past[k] == end[k]
        else:
            come = (end[k] - (past[k] if past[k] != end[k] else begin[k])) * side[k]
            assert come >= axis.overrun - 2e-9


def test_room_is_the_whole_overrun_at_the_ends_of_a_full_turn_too() -> None:
    assert X.overrun == 1e-3
    assert inward(X, 0.0004, 1) == 1e-3
    assert inward(X, 0.0004, -1) == 0.0004
    assert inward(X, 0.6, -1) == pytest.approx(0.599)
    assert inward(X, 0.0, 0) == 0.0
    assert inward(C, 0.0, 1) == pytest.approx(math.radians(1.0))


def test_the_owner_may_state_an_overrun() -> None:
    machine = machine_from_text(TOML.format(x='overrun = "3 mm"', c='overrun = "0.2 deg"'))
    assert machine.axis("X").overrun == pytest.approx(3e-3)
    assert machine.axis("C").overrun == pytest.approx(math.radians(0.2))
    assert machine_from_text(TOML.format(x="", c="")).axis("X").overrun == 1e-3


DRIVINGS = [
    Driving(),
    Driving(clearance=("X", 0.55)),
    Driving(clearance=("C", 3.0)),
]


@pytest.mark.parametrize("driving", DRIVINGS)
def test_many_moves_at_once_take_as_long_as_each_however_they_are_driven(driving: Driving) -> None:
    rng = np.random.default_rng(1)
    poses = rng.uniform(0.01, 0.4, (6, 3))
    poses[3, 1:] = poses[2, 1:]  # only C moves
    sides = rng.integers(-1, 2, (6, 3)).astype(float)
    table = approach_seconds(MACHINE, poses[:, None], poses[None], sides[None], driving)
    for i in range(6):
        for j in range(6):
            alone = approach_seconds(MACHINE, poses[i], poses[j], sides[j], driving)
            assert table[i, j] == pytest.approx(float(alone))
