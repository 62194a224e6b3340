"""A level that is stepped along a way: rows against what a virtual machine reads, rests against a dense twin, exact
steps, what it cannot see, and the set-ups that are refused.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import placed_pose
from axiscal.estimation.case import Case, Knowledge
from axiscal.estimation.estimate import concluded
from axiscal.exceptions import ReadingError
from axiscal.machine.axis import iso_axis
from axiscal.measurement.candidates import breaks_along
from axiscal.measurement.instruments.rotation import Level
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array
from axiscal.present.curves import errors
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from tests.generators.campaigns import on
from tests.generators.designs import problem
from tests.generators.machines import random_machine, random_poses
from tests.generators.texts import machine_text
from tests.measurement.test_observation import virtual


def stepped(machine: Machine, axis: int, base: float, seed: int = 0) -> Setup:
    """Return a level on feet, stepped along an axis, that reads about a direction across it."""
    park = tuple(sum(a.travel) / 2 for a in machine.axes)
    along = machine.frames(np.array([park])).rotations[axis][0] @ np.array(machine.axes[axis].direction)
    direction = np.cross(along, np.random.default_rng(seed).standard_normal(3))
    x, y, z = map(float, direction / np.linalg.norm(direction))
    zero, raster = (Unknown("zero", 1e-3),), (0.0,) * len(park)
    return Level("s", machine, (x, y, z), (axis,), park, 2e-6, zero, 60.0, 5.0, 5.0, raster, "+", base=base)


@pytest.mark.parametrize("base", [0.0, 0.03, 0.11])
@pytest.mark.parametrize("seed", [0, 2, *(pytest.param(seed, marks=pytest.mark.long) for seed in (3, 4))])
def test_rows_are_the_differences_of_what_a_virtual_machine_reads(seed: int, base: float) -> None:
    """All errors at once, each in a direction drawn for it, on both sides and with rotary axes; most are not seen."""
    model, rng = random_machine(seed, count=3), np.random.default_rng(seed)
    axis = next((k for k, a in enumerate(model.axes) if not a.rotary), None)
    if axis is None:
        pytest.skip("a machine without a way")
    setup = replace(stepped(model, axis, base, seed), noise=0.0)
    observation, step = Observation(model, (setup,)), 1e-6
    poses, approaches = random_poses(model, 1, rng)
    low, high = setup.span(model.axes[axis], axis)
    poses[0] = setup.park
    poses[0, axis] = rng.uniform(low, high)
    pose = tuple(map(float, poses[0]))
    rows = observation.numbers(Places.of_setup(0, poses, approaches)).rows[0]
    for towards in rng.uniform(-1, 1, (6, observation.size)):
        ends = [virtual(model, (setup,), sign * step * towards) for sign in (1, -1)]
        up, down = (machine.read_all(setup, pose, (1,) * len(pose), rng)[0] for machine in ends)
        assert (up - down) / (2 * step) == pytest.approx(rows @ towards, abs=2e-6 * max(1.0, np.abs(rows).max()))
    assert np.count_nonzero(np.abs(rows) > 1e-9) > 3


def test_a_way_that_rises_along_x_turns_the_level_about_minus_y() -> None:
    machine = Machine((iso_axis("X", False, (0.0, 1.0)),), (Error("EZX", 1e-5, knots=5),), 0.0, name="m")
    setup = replace(stepped(machine, 0, 0.2), direction=(0.0, 1.0, 0.0), unknowns=())
    rows = Observation(machine, (setup,)).numbers(along([0.3, 0.9])).rows
    rising = 10e-6 * np.linspace(0.0, 1.0, 5)
    assert rows @ rising == pytest.approx(-10e-6)
    assert rows @ np.ones(5) == pytest.approx(0.0, abs=1e-12)


def _slide(knots: int = 9) -> Machine:
    """Return a slide of 1 m whose straightness has cells of 1/(8·(knots − 1)) m; a yaw and a roll stand beside it."""
    entries = (
        Error("EZX", 1e-5, knots=knots, length=0.3, rest=1e-6),
        Error("EBX", 2e-5, knots=5, rest=1e-6),
        Error("EZX_reversal", 2e-6),
    )
    return Machine((iso_axis("X", False, (0.0, 1.0)),), entries, 0.1, name="m")


def along(positions: list[float]) -> Places:
    """Return places along the slide, from the positive side."""
    return Places.of_setup(0, np.array(positions)[:, None], np.ones((len(positions), 1)))


def test_breaks_stand_where_a_foot_meets_a_knot_and_feet_lie_in_cells() -> None:
    model = _slide(knots=5)
    observation = Observation(model, (stepped(model, 0, 0.1),))
    assert breaks_along(observation, 0, 0) == pytest.approx([0.05, 0.2, 0.3, 0.45, 0.55, 0.7, 0.8, 0.95])
    numbers = observation.numbers(along([0.41]))
    assert sorted(numbers.cell[0, np.flatnonzero(numbers.reach[0])]) == [11, 14]  # 0.36 and 0.46 in cells of 1/32


def _read(observation: Observation, places: Array) -> Normal:
    """Return what is known after readings one by one."""
    known = Knowledge(observation, Normal(np.zeros(observation.size), observation.prior_covariance()))
    for place in places.tolist():
        known = known.read([Reading(observation.setups[0].name, (place,), (1,), 1e-5 * np.cos(7 * place))])
    return known.belief


def test_feet_share_the_rests_of_their_cells_as_a_dense_twin_does() -> None:
    """Stepped by its own length a level puts a foot where the other stood: the rest there tells both readings."""
    model, base, places = _slide(), 0.05, np.array([0.125, 0.175, 0.225, 0.225, 0.612, 0.662])
    setup = replace(stepped(model, 0, base), direction=(0.0, 1.0, 0.0))
    observation = Observation(model, (setup,))
    belief = _read(observation, places)
    rows = observation.numbers(along(places.tolist())).rows
    feet = [((p + base / 2), 1 / base) for p in places], [((p - base / 2), -1 / base) for p in places]
    kernel = rows @ observation.prior_covariance() @ rows.T + (2e-6) ** 2 * np.eye(6)
    for one in feet:
        for other in feet:
            here, there = np.array(one), np.array(other)
            same = np.floor(here[:, 0, None] * 64) == np.floor(there[:, 0] * 64)
            kernel += 1e-12 * same * np.outer(here[:, 1], there[:, 1])
    across = observation.prior_covariance() @ rows.T
    mean = across @ np.linalg.solve(kernel, 1e-5 * np.cos(7 * places))
    covariance = observation.prior_covariance() - across @ np.linalg.solve(kernel, across.T)
    assert belief.mean[: observation.size] == pytest.approx(mean, abs=1e-12)
    np.testing.assert_allclose(belief.covariance[: observation.size, : observation.size], covariance, atol=1e-16)


def test_a_raster_stays_where_both_feet_stand_within_the_travel() -> None:
    model = _slide()
    setup = replace(stepped(model, 0, 0.1), raster=(0.04,))
    asked = problem(model, (setup,), 40)
    assert asked.lattice.poses.min() == pytest.approx(0.08)
    assert asked.lattice.poses.max() == pytest.approx(0.92)


MACHINE = machine_text(
    "w-b-X-Z-t",
    {"X": (0, 800), "Z": (0, 300)},
    {
        "EZX": 'std = "10 um", knots = 9, length = "200 mm", rest = "0.2 um"',
        "EXZ": 'std = "5 um", knots = 5',
        "EAX": 'std = "20 urad", knots = 5',
        "B0Z": "20 urad",
    },
    name="bed",
)
LEVEL = 'instrument = "level"\ndirection = "y"\nmoves = ["X"]\nbase = "100 mm"\n'


def _described(setup: str) -> CampaignDescription:
    return on(MACHINE, f'[[setups]]\nname = "survey"\n{setup}', target={"readings": 1})


def test_a_foot_beyond_the_travel_is_refused() -> None:
    description = _described(LEVEL)
    with pytest.raises(ReadingError, match=r"the level of \".*\" does not stand within its reach and the travel"):
        placed_pose(description.setups[0], description.machine, {"X": 0.02})
    assert placed_pose(description.setups[0], description.machine, {"X": 0.0499995})[0] == 0.05  # as rounded to um
    with pytest.raises(ReadingError, match="X = 900 mm is outside the travel"):
        placed_pose(description.setups[0], description.machine, {"X": 0.9})


def test_a_slope_between_two_feet_is_no_point_of_a_curve() -> None:
    """Between the knots one foot stands as high as the other: no height follows from the slope."""
    case = Case(_described(LEVEL))
    readings = [Reading("survey", (x, 0.1), (1, 1), 1e-6) for x in (0.1, 0.4, 0.6)]
    assert errors(concluded(case, readings), readings)["EZX"].read.position == []
