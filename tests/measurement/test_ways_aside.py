"""Ways in touch aside of what is in the way: every place on them can be taken, and their time is that of their legs."""

from __future__ import annotations

import math
from itertools import pairwise, permutations

import numpy as np
import pytest

from axiscal.measurement.charts.kinds import Held
from axiscal.measurement.travel import short_way, way_seconds
from axiscal.numerics import Array
from axiscal.numerics.short_way import route, route_seconds
from tests.generators.kinematics import in_travel, stem, tip
from tests.measurement.test_charts import BALLS, DMU, held
from tests.measurement.test_travel import NEST


def reachable(chart: Held, count: int) -> Array:
    """Return places of a 15 deg raster that can be taken."""
    values = [math.radians(15) * np.arange(math.ceil(low / 15), high // 15 + 1) for low, high in ((0, 345), (-30, 120))]
    grid = np.stack([each.ravel() for each in np.meshgrid(*values, indexing="ij")], axis=1)
    taken = grid[chart.feasible(chart.poses(grid))]
    return taken[np.random.default_rng(3).permutation(len(taken))[:count]]


@pytest.mark.parametrize("ball", BALLS)
def test_a_way_in_touch_can_be_gone_at_every_place(ball: str) -> None:
    chart = held(ball)
    places = reachable(chart, 24)
    aside = gone = 0
    for start, stop in pairwise(places):
        legs = chart.between(start, stop)
        if legs is None:
            continue
        gone += 1
        aside += len(legs) > 2
        np.testing.assert_array_equal(legs[[0, -1]], [start, stop])
        for a, b in pairwise(legs):
            for pose in chart.poses(a + np.linspace(0, 1, 40)[:, None] * (b - a)):
                assert in_travel(DMU, pose)
                assert np.linalg.norm(tip(DMU, pose) - BALLS[ball]) < 1e-9
                assert math.degrees(math.acos(np.clip(stem(DMU, pose)[2], -1, 1))) <= 100 + 1e-6
    assert gone >= 12  # between the others the tool goes off and comes back
    assert aside >= 1 or ball != "low"  # of the others all that are tried go straight, or not at all


def test_an_order_counts_what_ways_really_take() -> None:
    """Against all orders of seven places, with the seconds of ways that go straight, aside, or off and back."""
    poses, free = held().poses(reachable(held(), 40)[4:11]), np.zeros((7, 5))
    real = way_seconds(DMU, NEST, poses[:, None], poses[None], free[None])
    thought = way_seconds(DMU, NEST, poses[:, None], poses[None], free[None], straight=True)
    assert np.any(real > thought + 0.1)
    shortest = min(route_seconds(list(each), real) for each in permutations(range(7)))
    order, ways = short_way(DMU, NEST, poses, free)
    assert ways == pytest.approx(real[order[:-1], order[1:]])
    assert ways.sum() <= 1.03 * shortest
    assert ways.sum() <= route_seconds(route(thought).tolist(), real) + 1e-9
