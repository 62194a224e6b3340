"""All readings moved at once: better, inside the travel, off rasters only."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.planning.plan.exchange import relocated
from axiscal.planning.plan.task import Task
from tests.generators.designs import levered, random_poses


def drawn(asked: Task, seed: int, count: int) -> Places:
    generator = np.random.default_rng(seed)
    poses, approaches = random_poses(asked, generator, count)
    setups = generator.integers(len(asked.observation.setups), size=count)
    return Places(setups, poses, approaches)


@pytest.mark.parametrize("seed", range(4))
def test_readings_of_random_plans_come_to_lie_better(seed: int) -> None:
    asked = levered(50)
    places = drawn(asked, seed, 6)
    found = relocated(asked, places)
    assert asked.after(found).value < 0.98 * asked.after(places).value
    np.testing.assert_array_equal(found.setups, places.setups)
    np.testing.assert_array_equal(found.approaches, places.approaches)
    for axis, at in zip(asked.observation.machine.axes, found.poses.T, strict=True):
        assert np.all((axis.travel[0] <= at) & (at <= axis.travel[1]))


def test_what_stands_on_a_raster_stays() -> None:
    asked = levered(50)
    setups = tuple(replace(s, raster=(0.1, 0.05, 0.05)) for s in asked.observation.setups)
    asked = replace(asked, observation=Observation(asked.observation.errors, setups))
    places = drawn(asked, 0, 5)
    assert relocated(asked, places) is places
