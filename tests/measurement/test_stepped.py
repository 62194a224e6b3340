"""A level that is stepped along a way: rows against what a virtual machine reads, rests against a dense twin, exact
steps, what it cannot see, and the set-ups that are refused.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebfit, chebval

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.placed_readings import placed_pose
from axiscal.errors.model import ErrorFunction, ErrorModel
from axiscal.estimation.belief import Belief
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.exceptions import DescriptionError, ReadingError
from axiscal.machine import Machine
from axiscal.machine.axis import Axis
from axiscal.machine.entry import ErrorEntry
from axiscal.machine.kinematics import frames
from axiscal.measurement.candidates import breaks_along, smoothness_along
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.reading_rows import visited
from axiscal.measurement.setup import Setup, Unknown
from axiscal.measurement.simulation import Curve, Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.planning.unseen import hidden_of
from axiscal.present.curves import curves
from axiscal_core.roots import node_count, nodes
from tests.generators.designs import problem
from tests.generators.forms import gain_forms
from tests.generators.machines import random_machine, random_poses

ZERO = (Unknown("zero", 1e-3),)


def stepped(machine: Machine, axis: int, base: float, seed: int = 0) -> Setup:
    """Return a level on feet, stepped along an axis, that reads about a direction across it."""
    park = tuple(sum(a.travel) / 2 for a in machine.axes)
    along = frames(machine, np.array([park])).rotations[axis][0] @ np.array(machine.axes[axis].direction)
    direction = np.cross(along, np.random.default_rng(seed).standard_normal(3))
    x, y, z = map(float, direction / np.linalg.norm(direction))
    raster = (0.0,) * len(park)
    return Setup("s", "level", (x, y, z), (axis,), park, 2e-6, ZERO, 60.0, 5.0, 5.0, raster, "+", base=base)


def _curve(function: ErrorFunction, unknowns: Array) -> Curve:
    return lambda t: np.asarray(function.basis.rows(t) @ unknowns[function.columns])


def _seen(model: ErrorModel, setup: Setup, unknowns: Array, pose: tuple[float, ...]) -> float:
    curves = tuple(_curve(f, unknowns) for f in model.functions)
    machine = VirtualMachine(model, curves, {"s": {"zero": float(unknowns[-1])}})
    return machine.read_all(setup, pose, (1,) * len(pose), np.random.default_rng(0))[0]


@pytest.mark.parametrize("base", [0.0, 0.03, 0.11])
@pytest.mark.parametrize("seed", [0, 2, *(pytest.param(seed, marks=pytest.mark.long) for seed in (3, 4))])
def test_rows_are_the_differences_of_what_a_virtual_machine_reads(seed: int, base: float) -> None:
    """All errors at once, each in a direction drawn for it, on both sides and with rotary axes; most are not seen."""
    model, rng = ErrorModel(random_machine(seed, count=3)), np.random.default_rng(seed)
    axis = next((k for k, a in enumerate(model.machine.axes) if not a.rotary), None)
    if axis is None:
        pytest.skip("a machine without a way")
    setup = replace(stepped(model.machine, axis, base, seed), noise=0.0)
    observation, step = Observation(model, (setup,)), 1e-6
    poses, approaches = random_poses(model.machine, 1, rng)
    low, high = setup.span(model.machine.axes[axis], axis)
    poses[0] = setup.park
    poses[0, axis] = rng.uniform(low, high)
    pose = tuple(map(float, poses[0]))
    rows = observation.rows(0, poses, approaches).rows[0]
    for towards in rng.uniform(-1, 1, (6, observation.size)):
        up, down = (_seen(model, setup, sign * step * towards, pose) for sign in (1, -1))
        assert (up - down) / (2 * step) == pytest.approx(rows @ towards, abs=2e-6 * max(1.0, np.abs(rows).max()))
    assert np.count_nonzero(np.abs(rows) > 1e-9) > 3


def test_a_way_that_rises_along_x_turns_the_level_about_minus_y() -> None:
    machine = Machine("m", (Axis.named("X", False, (0.0, 1.0)),), 0.0, (ErrorEntry("EZX", 1e-5, knots=5),), "", "")
    setup = replace(stepped(machine, 0, 0.2), direction=(0.0, 1.0, 0.0), unknowns=())
    rows = Observation(ErrorModel(machine), (setup,)).rows(0, np.array([[0.3], [0.9]]), np.ones((2, 1))).rows
    rising = 10e-6 * np.linspace(0.0, 1.0, 5)
    assert rows @ rising == pytest.approx(-10e-6)
    assert rows @ np.ones(5) == pytest.approx(0.0, abs=1e-12)


def _slide(rest: float = 1e-6, knots: int = 9) -> ErrorModel:
    """Return a slide of 1 m whose straightness has cells of 1/(8·(knots − 1)) m; a yaw and a roll stand beside it."""
    entries = (
        ErrorEntry("EZX", 1e-5, knots=knots, length=0.3, rest=rest),
        ErrorEntry("EBX", 2e-5, knots=5, rest=1e-6),
        ErrorEntry("EZX_reversal", 2e-6),
    )
    return ErrorModel(Machine("m", (Axis.named("X", False, (0.0, 1.0)),), 0.1, entries, "", ""))


def along(positions: list[float]) -> Places:
    """Return places along the slide, from the positive side."""
    return Places.of_setup(0, np.array(positions)[:, None], np.ones((len(positions), 1)))


def test_breaks_stand_where_a_foot_meets_a_knot_or_a_visited_cell() -> None:
    model = _slide(knots=5)
    observation = Observation(model, (stepped(model.machine, 0, 0.1),))
    assert breaks_along(observation, 0, 0) == pytest.approx([0.05, 0.2, 0.3, 0.45, 0.55, 0.7, 0.8, 0.95])
    wider = visited(observation, along([0.41]))
    assert sorted(cell for owner, cell in wider.cells if owner == 0) == [11, 14]  # 0.36 and 0.46 in cells of 1/32
    assert {owner for owner, _ in wider.cells} == {0}
    edges = {round(cell / 32 - 2e-4 - shift, 9) for cell in (11, 12, 14, 15) for shift in (0.05, -0.05)}
    assert edges <= {round(float(b), 9) for b in breaks_along(wider, 0, 0)}


def test_the_forms_are_followed_between_the_breaks() -> None:
    model, rng = _slide(), np.random.default_rng(0)
    observation = Observation(model, (stepped(model.machine, 0, 0.13),))
    observation = visited(observation, along([0.2, 0.5, 0.77]))
    factor, weighted = rng.standard_normal((observation.size, 4)), rng.standard_normal((3, 4))
    count, inside = node_count(*smoothness_along(observation, 0, 0)), np.linspace(-0.99, 0.99, 9)
    for left, right in pairwise(breaks_along(observation, 0, 0)):
        at = left + (right - left) * (1 + np.concatenate([nodes(count), inside])[:, None]) / 2
        seen = observation.rows(0, at, np.ones_like(at))
        for form in gain_forms(seen.rows, factor, weighted, seen.variances):
            series = chebval(inside, chebfit(nodes(count), form[:count], count - 1))
            assert np.abs(series - form[count:]).max() < 1e-9 * np.abs(form).max()


def _read(observation: Observation, places: Array) -> tuple[Observation, Belief]:
    covariance = observation.prior_covariance()
    belief = Belief(np.zeros(len(covariance)), covariance)
    for place in places:
        wider = visited(observation, along([place]))
        belief, observation = belief.extended(observation.rest_variances(wider)), wider
        seen = observation.rows(0, np.array([[place]]), np.ones((1, 1)))
        belief = belief.update(seen.rows, 1e-5 * np.cos(7 * place), seen.variances)
    return observation, belief


def test_feet_share_the_rests_of_their_cells_as_a_dense_twin_does() -> None:
    """Stepped by its own length a level puts a foot where the other stood: the rest there tells both readings."""
    model, base, places = _slide(), 0.05, np.array([0.125, 0.175, 0.225, 0.225, 0.612, 0.662])
    setup = replace(stepped(model.machine, 0, base), direction=(0.0, 1.0, 0.0))
    observation = Observation(model, (setup,))
    _, belief = _read(observation, places)
    rows = observation.rows(0, places[:, None], np.ones((6, 1))).rows
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
    setup = replace(stepped(model.machine, 0, 0.1), raster=(0.04,))
    asked = problem(model.machine, (setup,), 40)
    assert asked.lattice.poses.min() == pytest.approx(0.08)
    assert asked.lattice.poses.max() == pytest.approx(0.92)


MACHINE = """
name = "bed"
chain = "w-b-X-Z-t"
[axes.X]
travel = ["0 mm", "800 mm"]
speed = "10 m/min"
acceleration = "2 m/s^2"
[axes.Z]
travel = ["0 mm", "300 mm"]
speed = "10 m/min"
acceleration = "2 m/s^2"
[errors]
EZX = { std = "10 um", knots = 9, length = "200 mm", rest = "0.2 um" }
EXZ = { std = "5 um", knots = 5 }
EAX = { std = "20 urad", knots = 5 }
B0Z = { std = "20 urad" }
"""
LEVEL = 'instrument = "level"\ndirection = "y"\nmoves = ["X"]\nbase = "100 mm"\n'


def _described(setup: str) -> CampaignDescription:
    text = f'machine = "bed.toml"\n[target]\nreadings = 1\n[[setups]]\nname = "survey"\n{setup}'
    return campaign_from_texts(text, "campaign.toml", MACHINE, "bed.toml")


def test_a_rotary_axis_has_no_way() -> None:
    text = f'machine = "five-axis-mill"\n[target]\nreadings = 1\n[[setups]]\nname = "s"\n{LEVEL}'.replace("X", "C")
    with pytest.raises(DescriptionError, match="a base is stepped along one straight way"):
        campaign_from_texts(text, "c.toml", _five_axes(), "five-axis-mill")


def _five_axes() -> str:
    from axiscal.machine import builtin_names, load_machine

    name = next(n for n in builtin_names() if any(axis.name == "C" for axis in load_machine(n).axes))
    return load_machine(name).text


def test_a_foot_beyond_the_travel_is_refused() -> None:
    description = _described(LEVEL)
    with pytest.raises(ReadingError, match="a foot of the level stands outside the travel"):
        placed_pose(description.setups[0], description.machine, {"X": 0.02})
    assert placed_pose(description.setups[0], description.machine, {"X": 0.0499995})[0] == 0.05  # as rounded to um
    with pytest.raises(ReadingError, match="X = 900 mm is outside the travel"):
        placed_pose(description.setups[0], description.machine, {"X": 0.9})


def test_it_sees_neither_offset_nor_inclination_of_a_way() -> None:
    hidden = hidden_of(Case(_described(LEVEL)))
    told = [one.text for one in hidden if "EZX" in one.names]
    assert any("slope" in text for text in told)


def test_a_survey_gives_the_straightness_back() -> None:
    description = _described(LEVEL)
    machine, rng = Simulator(description.machine, description.setups).drawn(4), np.random.default_rng(4)
    setup, readings = description.setups[0], list[Reading]()
    for place in np.linspace(0.05, 0.75, 15):
        pose = (float(place), 0.15)
        readings.append(Reading("survey", pose, (1, 0), machine.read_all(setup, pose, (1, 0), rng)[0]))
    estimation = concluded(Case(description), readings)
    belief, function = estimation.knowledge.belief, estimation.case.errors.names["EZX"]
    places = np.linspace(0.0, 0.8, 81)
    rows = np.zeros((81, len(belief.mean)))
    rows[:, function.columns] = function.basis.rows(places)
    line = np.stack([np.ones(81), places - 0.4], axis=1)
    free = np.eye(81) - line @ np.linalg.pinv(line)
    index = [f.name for f in machine.model.functions].index("EZX")
    truth = free @ machine.curves[index](places)
    left, std = truth - free @ rows @ belief.mean, np.linalg.norm(free @ rows @ belief.factor, axis=1)
    assert np.sqrt(np.mean(truth**2)) > 3e-6
    assert np.all(np.abs(left) < 4 * std + 1e-6)
    assert np.sqrt(np.mean(std**2)) < 1e-6


def test_a_level_is_planned_on_a_way_that_has_no_rest() -> None:
    text = f'machine = "bed.toml"\nusual = "off"\n[target]\nreadings = 4\n[[setups]]\nname = "survey"\n{LEVEL}'
    bed = MACHINE.replace(', rest = "0.2 um"', "")
    case = Case(campaign_from_texts(text, "campaign.toml", bed, "bed.toml"))
    assert len(proposed(case, Limits(4), 100).plan.places) == 4


def test_a_slope_between_two_feet_is_no_point_of_a_curve() -> None:
    """Between the knots one foot stands as high as the other: no height follows from the slope."""
    case = Case(_described(LEVEL))
    readings = [Reading("survey", (x, 0.1), (1, 1), 1e-6) for x in (0.1, 0.4, 0.6)]
    found = {curve.name: curve.points for curve in curves(concluded(case, readings), readings, None)}
    assert found["EZX"] == []
