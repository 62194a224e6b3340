"""Short ways, against the exact shortest by dynamic programming."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from axiscal.design.cost import approach_seconds, travel_seconds
from axiscal.design.route import route, route_seconds, travel_table
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.numerics import Array

MILL = Machine("m", tuple(Axis.named(n, False, (0.0, 0.6)) for n in "XYZ"), 0.1, (), "", "")


def shortest(table: Array, first: Array) -> float:
    """Return the time of the shortest way through all places (Held and Karp 1962)."""
    count = len(table)
    best = {(1 << i, i): float(first[i]) for i in range(count)}
    for size in range(2, count + 1):
        for places in itertools.combinations(range(count), size):
            mask = sum(1 << i for i in places)
            for last in places:
                before = mask & ~(1 << last)
                best[mask, last] = min(best[before, i] + table[i, last] for i in places if i != last)
    return min(best[(1 << count) - 1, i] for i in range(count))


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("sided", [False, True])
@pytest.mark.parametrize("begun", [False, True])
def test_within_three_percent_of_the_shortest(seed: int, sided: bool, begun: bool) -> None:
    generator = np.random.default_rng(seed)
    poses = generator.uniform(0, 0.6, (int(generator.integers(2, 10)), 3))
    approaches = generator.choice([-1.0, 1.0], poses.shape) * sided
    table = travel_table(MILL, poses, approaches)
    first = approach_seconds(MILL, np.zeros(3), poses, approaches) if begun else np.zeros(len(poses))
    order = route(table, first if begun else None)
    assert sorted(order) == list(range(len(poses)))
    way = float(first[order[0]]) + route_seconds([int(i) for i in order], table)
    assert way <= 1.03 * shortest(table, first)


def test_the_wrong_side_costs_the_overrun() -> None:
    start, stop = np.array([0.1, 0.1, 0.1]), np.array([0.3, 0.1, 0.1])
    any_side, right, wrong = (approach_seconds(MILL, start, stop, np.array([s, 0.0, 0.0])) for s in (0.0, 1.0, -1.0))
    assert any_side == right == travel_seconds(MILL, start, stop)
    past = stop + np.array([MILL.axes[0].overrun, 0.0, 0.0])
    assert wrong == travel_seconds(MILL, start, past) + travel_seconds(MILL, past, stop)


def test_a_standing_axis_still_has_to_arrive() -> None:
    here = np.array([0.2, 0.2, 0.2])
    assert approach_seconds(MILL, here, here, np.array([1.0, 0.0, 0.0])) > 0
    assert approach_seconds(MILL, here, here, np.zeros(3)) == 0
