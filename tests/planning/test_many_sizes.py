"""Plans over several draws of sizes and lengths, against J of each draw computed anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.description.usual import TEACH_LENGTHS
from axiscal.estimation.case import Case
from axiscal.estimation.promise.posterior import Drawn
from axiscal.estimation.promise.problem import problem
from axiscal.measurement.reading import Places, Reading
from axiscal.numerics import Array
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import left_by
from axiscal.planning.gains.many_sizes import ManyScores
from axiscal.planning.likely_sizes import COUNT, likely_states
from axiscal.planning.next_readings import posed
from axiscal.planning.plan.exchange import relocated
from axiscal.planning.plan.task import Limits, Task
from axiscal.planning.proposal import proposed
from tests.generators.texts import machine_text

MACHINE = machine_text(
    "w-b-X-Y-t",
    {"X": (0, 300), "Y": (0, 200)},
    {"EZX": 'std = "50 um", length = "100 mm", knots = 7', "EZY": 'std = "50 um", length = "80 mm", knots = 7'},
)
CAMPAIGN = """
machine = "bed.toml"
sure = "roughly"
[target]
readings = 9
[[setups]]
name = "probe"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
reach = { X = ["0 mm", "300 mm"], Y = ["0 mm", "200 mm"] }
noise = "2 um"
"""


def _case(campaign: str = CAMPAIGN) -> Case:
    return Case(campaign_from_texts(campaign, "campaign.toml", MACHINE, "bed.toml"))


@pytest.fixture(scope="module")
def task() -> Task:
    case = _case()
    return posed(case, case.knowledge, candidates=150)


def _readings(count: int) -> list[Reading]:
    at = np.random.default_rng(3).uniform(0, 0.2, (count, 2))
    return [Reading("probe", tuple(pose), (0, 0), 1e-5 * k) for k, pose in enumerate(at.tolist())]


def test_gains_and_losses_are_those_of_the_geometric_mean(task: Task) -> None:
    scores = ManyScores(Pool(task.observation, task.lattice), task.drawn)
    for index in (3, 80, 140):
        before, gain = scores.value, scores.enter(index)
        assert before - scores.value == pytest.approx(gain, rel=1e-9)
    assert scores.value == pytest.approx(left_by(task.drawn, scores.places), rel=1e-9)
    gains, own = scores.without(1)
    fewer = scores.places.without(1)
    for index in (0, 77):
        there = Places.joined([fewer, scores.pool.lattice.single(index)])
        expected = left_by(task.drawn, fewer) - left_by(task.drawn, there)
        assert gains[index] == pytest.approx(expected, rel=1e-6)
    assert scores.losses()[1] == pytest.approx(own, rel=1e-9)
    other = scores.fork()
    assert other.leave(1) == pytest.approx(own, rel=1e-9)
    np.testing.assert_allclose(other.gains, gains, rtol=1e-8)
    before, gain = scores.value, scores.exchange(1, 77)
    assert before - scores.value == pytest.approx(gain, rel=1e-9)
    np.testing.assert_allclose(scores.among([0]).gains, scores.gains, rtol=1e-12)


def test_readings_move_to_where_the_geometric_mean_is_lower(task: Task) -> None:
    places = task.lattice.within(slice(0, 50, 6))
    moved = relocated(task.drawn, places)
    assert left_by(task.drawn, moved) < 0.95 * left_by(task.drawn, places)


def test_lengths_are_drawn_from_a_fifth_of_the_travel_to_all_of_it(task: Task) -> None:
    machines = [state.observation.machine for state in task.drawn]
    shares = [machine.errors[0].length / 0.3 for machine in machines if machine.errors[0].length]
    assert len(shares) == COUNT
    assert 0.2 <= min(shares) < 0.25
    assert 0.6 < max(shares) <= 1.0
    assert len({round(machine.planes[0].std, 9) for machine in machines}) == COUNT


def test_known_sizes_are_not_drawn() -> None:
    case = _case(CAMPAIGN.replace('"roughly"', '"exactly"').replace("[target]", 'usual = "off"\n[target]'))
    assert posed(case, case.knowledge, candidates=50).drawn == ()


@pytest.mark.parametrize("count", [TEACH_LENGTHS - 1, TEACH_LENGTHS])
def test_few_readings_teach_no_length(count: int) -> None:
    case, readings = _case(), _readings(count)
    posed_ones = problem(case.observation, readings, case.sizes)
    thetas = np.full((3, len(case.sizes)), np.log(0.5))
    drawn = Drawn(posed_ones, thetas, np.full(3, 1 / 3))
    states = likely_states(case, case.yardstick.root, readings, [drawn])
    lengths = {round(state.observation.machine.errors[0].length or 0.0, 9) for state in states}
    assert (lengths == {0.05}) == (count == TEACH_LENGTHS)
    assert {round(state.observation.machine.errors[0].std, 12) for state in states} == {25e-6}


def _theta_of(shares: Array, few: bool) -> Array:
    sizes = replace(_case().sizes, few=few)
    x = np.tile(shares[:, None], len(sizes))
    theta, slope = sizes.theta(x)
    index = [size.kind for size in sizes.of].index("length")
    apart = sizes.theta(x + 1e-6)[0] - sizes.theta(x - 1e-6)[0]
    np.testing.assert_allclose(slope, apart / 2e-6, atol=1e-6)
    return np.asarray(theta[:, index] / sizes.spreads[index])


def test_a_length_of_few_readings_comes_from_its_longer_half() -> None:
    x = np.linspace(-3, 3, 13)
    np.testing.assert_allclose(_theta_of(x, few=False), x, atol=1e-12)
    longer = _theta_of(x, few=True)
    assert np.all(longer > 0)
    assert longer[6] == pytest.approx(0.6745, abs=1e-4)  # the median of half a normal


def test_a_plan_leaves_less_over_all_sizes_than_one_for_the_sizes_as_stated(task: Task) -> None:
    exactly = _case(CAMPAIGN.replace('"roughly"', '"exactly"').replace("[target]", 'usual = "off"\n[target]'))
    sure, unsure = (proposed(case, Limits(9), 150).plan.places for case in (exactly, _case()))
    assert left_by(task.drawn, unsure) < left_by(task.drawn, sure)
