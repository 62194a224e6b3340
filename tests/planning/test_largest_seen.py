"""Proofs on charts: what is seen is never more than is said, and what is said is nearly reached."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.exceptions import PlanError
from axiscal.measurement.candidates import chart_candidates
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.bound.lower_bound import largest_seen, scattered
from axiscal.planning.step.ground import regions
from tests.generators.campaigns import built_in

BALLS = """
[[artefacts]]
name = "balls"
balls = { low = ["200 mm", "0 mm", "-80 mm"], high = ["-100 mm", "170 mm", "120 mm"] }
"""
HELD = BALLS + '[[setups]]\nname = "it"\ninstrument = "rtest"\nartefact = "balls"\nball = ["low"]\n'
CASES = {
    "one axis turns": HELD + 'moves = ["C"]\napproach = "-"\n',
    "balls one after another": HELD.replace('ball = ["low"]\n', "") + 'moves = ["B"]\n',
    "all on a raster": HELD + 'raster = { B = "30 deg", C = "45 deg" }\napproach = "both"\n',
    "a bar in a plane": (
        '[[setups]]\nname = "it"\ninstrument = "ballbar"\nlength = "150 mm"\n'
        'station = ["0 mm", "0 mm", "100 mm"]\nplane = "zx"\napproach = "both"\n'
    ),
    "a bar and an axis in step": (
        '[[setups]]\nname = "it"\ninstrument = "ballbar"\nlength = "100 mm"\nstation = ["50 mm", "0 mm", "100 mm"]\n'
        'plane = "xy"\narc = ["10 deg", "200 deg"]\nturning = { C = 1.0 }\n'
    ),
    "a diagonal": (
        '[[setups]]\nname = "it"\ninstrument = "interferometer"\napproach = "both"\n'
        'along = [["-200 mm", "-200 mm", "50 mm"], ["200 mm", "200 mm", "300 mm"]]\n'
    ),
}


@cache
def case(name: str) -> Case:
    return Case(built_in(CASES[name], "dmu60"))


def along(observation: Observation, seed: int) -> Array:
    """Four directions of all unknowns, each as large as its prior: rows along them are of one size."""
    std = np.sqrt(observation.prior_variances())
    return std[:, None] * np.random.default_rng(seed).standard_normal((observation.size, 4))


def lengths(observation: Observation, poses: Array, approaches: Array, reach: Array) -> Array:
    seen = observation.rows_each(0, poses, approaches)
    total: Array = np.sum([np.sum((each.rows @ reach) ** 2, axis=1) for each in seen], axis=0)
    return total


@pytest.mark.parametrize("name", CASES)
def test_no_reading_is_above_the_bound_and_one_is_near_it(name: str) -> None:
    found, gap = case(name), 0.02
    observation, (setup,) = found.observation, found.description.setups
    assert setup.chart is not None
    reach = along(observation, 3)
    poses, approaches = chart_candidates(observation.machine, setup, setup.chart, 2000)
    best = float(lengths(observation, poses, approaches, reach).max())
    each = [largest_seen(region, setup.noise * reach, 0.3 * best, gap) for region in regions(observation, 0)]
    places, upper = Places.joined([one.places for one in each]), max(one.upper for one in each)
    reached = float(lengths(observation, places.poses, places.approaches, reach).max())
    assert best <= upper * (1 + 1e-9)
    assert reached <= upper * (1 + 1e-9)
    assert upper <= reached * (1 + max(gap, (reached / best / 0.3 - 1) / 4) + 1e-7)
    assert setup.chart.feasible(places.poses).all()


def test_a_level_that_nothing_reaches_is_what_is_said() -> None:
    observation = case("one axis turns").observation
    reach = along(observation, 1)
    level = 1e3 * float(np.sum(reach**2))
    for region in regions(observation, 0):
        largest = largest_seen(region, observation.setups[0].noise * reach, level, 0.01)
        assert largest.upper == pytest.approx(level, rel=1e-7)
        assert not len(largest.places)


def test_two_coordinates_are_refused_with_what_would_help() -> None:
    free = Case(built_in(HELD, "dmu60"))
    with pytest.raises(PlanError, match="2 coordinates without steps, more than 1"):
        regions(free.observation, 0)


def test_of_neighbours_the_first_of_the_order_is_taken() -> None:
    places = np.array([[0.0, 0.0], [0.1, 0.05], [0.3, 0.0], [0.05, 0.5], [0.9, 0.9]])
    order = np.array([1, 0, 2, 3, 4])
    assert scattered(places, order, 5, 0.1) == [1, 2, 3, 4]
    assert scattered(places, order, 2, 0.1) == [1, 2]
    assert scattered(places, order[:0], 5, 0.1) == []
