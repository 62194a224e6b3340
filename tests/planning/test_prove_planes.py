"""Bounds for readings anywhere over two axes that do not add up: below every plan, above |Z b|² at every place."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.machine import machine_from_text
from axiscal.measurement.place import Places
from axiscal.planning.bound.prove import largest_on_plane, planar, prove
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task
from tests.generators.designs import problem, random_poses
from tests.generators.planes import bed, probe, table, warped

WARPED = warped((5, 4))
LEVERED = WARPED.replace("EZXY", "EAX = { std = '200 urad', knots = 4, length = '110 mm' }\nEZXY")


def _asked(text: str) -> Task:
    machine = machine_from_text(text)
    return problem(machine, (probe(machine),), 300)


@pytest.mark.long
@pytest.mark.parametrize("text", [WARPED, LEVERED], ids=["a plane", "with lever arms"])
def test_the_bound_lies_below_every_plan_and_is_closed(text: str) -> None:
    asked = _asked(text)
    plan = make_plan(asked, Limits(readings=30), bounded=False)
    proof = prove(asked.state, asked.lattice, plan.places)
    assert proof.bound.everywhere
    assert proof.gap < 0.01
    assert 0.6 * plan.value < proof.bound.value <= plan.value
    generator = np.random.default_rng(0)
    for _ in range(60):
        poses, approaches = random_poses(asked, generator, 30)
        places = Places.of_setup(0, poses, np.abs(approaches))
        assert proof.bound.value <= asked.state.after_readings(places).value


@pytest.mark.parametrize("text", [WARPED, LEVERED], ids=["a plane", "with lever arms"])
def test_no_place_is_above_what_encloses_it(text: str) -> None:
    asked = _asked(text)
    observation, generator = asked.state.observation, np.random.default_rng(2)
    reach = generator.standard_normal((observation.size, 5))
    side = np.ones(2)
    found = largest_on_plane(observation, 0, side, reach, 0.0, 60_000)
    machine = observation.machine
    low, high = np.array([axis.travel for axis in machine.axes]).T
    poses = generator.uniform(low, high, (20_000, 2))
    lengths = np.sum((observation.rows(0, poses, np.ones_like(poses)).rows @ reach) ** 2, axis=1)
    assert lengths.max() <= found.upper
    assert found.upper == pytest.approx(found.lengths[0], rel=1e-5)
    at = observation.rows(0, found.places[:1], np.ones((1, 2))).rows @ reach
    assert float(np.sum(at**2)) == pytest.approx(found.lengths[0], rel=1e-9)


def test_only_two_linear_axes_that_read_one_number_are_boxed() -> None:
    asked = _asked(WARPED)
    assert planar(asked.state.observation, 0)
    three = problem(bed(), (probe(bed()),), 50)
    assert not planar(three.state.observation, 0)
    turning = problem(table(), (replace(probe(table()), moves=(0, 1)),), 50)
    assert not planar(turning.state.observation, 0)
