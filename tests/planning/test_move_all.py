"""All readings moved at once: never worse, inside the travel, off rasters only, and the gradient is that of J."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.planning.plan.exchange import relocated
from axiscal.planning.plan.task import Limits, Task
from axiscal.planning.proposal import proposed
from tests.generators.campaigns import on
from tests.generators.designs import levered, random_poses
from tests.generators.texts import machine_text, setup_text

TABLE = machine_text(
    "w-C'-b-t", {"C": (0, 360)}, {"ECC": 'std = "20 urad", knots = 8, length = "90 deg"'}, name="table"
)
ALONE = setup_text(
    "table", "autocollimator", direction="z", moves=["C"], noise="0.5 urad", unknowns={"zero": "100 urad"}
)


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


def test_where_no_error_moves_the_tool_point_a_plan_is_made_and_its_readings_stay() -> None:
    """A table read alone: its tool point lies on its axis, and nothing that it does counts."""
    plan = proposed(Case(on(TABLE, ALONE, target={"readings": 4})), Limits(4))
    assert len(plan.places) == 4
    assert plan.accuracy.rms == 0


def test_what_stands_on_a_raster_stays() -> None:
    asked = levered(50)
    setups = tuple(replace(s, raster=(0.1, 0.05, 0.05)) for s in asked.observation.setups)
    asked = replace(asked, observation=Observation(asked.observation.errors, setups))
    places = drawn(asked, 0, 5)
    assert relocated(asked, places) is places
