"""Bounds for readings anywhere over axes that do not add up: below every plan, above |Z b|² at every place."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.machine import Machine, machine_from_text
from axiscal.measurement.reading import Places
from axiscal.planning.bound.lower_bound import largest_seen, prove
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task
from axiscal.planning.step.ground import regions
from tests.generators.designs import problem, random_poses
from tests.generators.planes import bed, probe, table, warped

WARPED = warped((5, 4))
LEVERED = WARPED.replace("EZXY", "EAX = { std = '200 urad', knots = 4, length = '110 mm' }\nEZXY")


def _asked(text: str) -> Task:
    machine = machine_from_text(text)
    return problem(machine, (probe(machine),), 300)


@pytest.mark.long
def test_the_bound_lies_below_every_plan_and_is_closed() -> None:
    asked = _asked(LEVERED)
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
    observation, generator = _asked(text).state.observation, np.random.default_rng(2)
    reach = generator.standard_normal((observation.size, 5))
    (region,) = regions(observation, 0)
    found = largest_seen(observation, 0, region, reach, 1e-3, 1e-6)
    low, high = np.array([axis.travel for axis in observation.machine.axes]).T
    poses = generator.uniform(low, high, (20_000, 2))
    lengths = np.sum((observation.rows(0, poses, np.ones_like(poses)).rows @ reach) ** 2, axis=1)
    assert lengths.max() <= found.upper
    at = observation.rows(0, found.places.poses[:1], np.ones((1, 2))).rows @ reach
    top = float(np.sum(at**2))
    assert lengths.max() * (1 - 1e-6) <= top <= found.upper


@pytest.mark.parametrize(("machine", "moves"), [(bed(), None), (table(), (0, 1))], ids=["three axes", "one turns"])
def test_three_axes_and_one_that_turns_are_boxed(machine: Machine, moves: tuple[int, ...] | None) -> None:
    """Lever arms and sines are polynomials of a degree that follows them: no place of many is above the bound."""
    setup = probe(machine) if moves is None else replace(probe(machine), moves=moves)
    observation = problem(machine, (setup,), 50).state.observation
    generator = np.random.default_rng(3)
    std = np.sqrt(observation.prior_variances())
    reach = std[:, None] * generator.standard_normal((observation.size, 3))
    each = [largest_seen(observation, 0, region, reach, 1e-14, 0.02) for region in regions(observation, 0)]
    poses = np.tile(np.array(setup.park), (20_000, 1))
    for axis in setup.moves:
        poses[:, axis] = generator.uniform(*setup.span(machine.axes[axis], axis), len(poses))
    lengths = np.sum((observation.rows(0, poses, np.ones_like(poses)).rows @ reach) ** 2, axis=1)
    assert lengths.max() <= max(one.upper for one in each)
