"""Bounds for readings anywhere over axes that do not add up: below every plan, above |Z b|² at every place."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.machine import Machine, machine_from_text
from axiscal.measurement.reading import Places
from axiscal.planning.bound.lower_bound import largest_seen, prove
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits
from axiscal.planning.step.ground import regions
from tests.generators.designs import problem, random_poses
from tests.generators.planes import bed, probe, table, warped

WARPED = warped((5, 4))
LEVERED = WARPED.replace("EZXY", "EAX = { std = '200 urad', knots = 4, length = '110 mm' }\nEZXY")


@pytest.mark.long
def test_the_bound_lies_below_every_plan_and_is_closed() -> None:
    machine = machine_from_text(LEVERED)
    asked = problem(machine, (probe(machine),), 300)
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


@pytest.mark.parametrize(
    ("machine", "moves", "gap"),
    [
        (machine_from_text(WARPED), None, 1e-6),
        (machine_from_text(LEVERED), None, 1e-6),
        (bed(), None, 0.02),
        (table(), (0, 1), 0.02),
    ],
    ids=["a plane", "with lever arms", "three axes", "one turns"],
)
def test_no_place_is_above_what_encloses_it(machine: Machine, moves: tuple[int, ...] | None, gap: float) -> None:
    """Lever arms and sines are polynomials of a degree that follows them."""
    setup = probe(machine) if moves is None else replace(probe(machine), moves=moves)
    observation, generator = problem(machine, (setup,), 50).state.observation, np.random.default_rng(3)
    reach = np.sqrt(observation.prior_variances())[:, None] * generator.standard_normal((observation.size, 3))
    each = [largest_seen(region, observation.setups[0].noise * reach, 1e-14, gap) for region in regions(observation, 0)]
    poses = np.tile(np.array(setup.park), (20_000, 1))
    for axis in setup.moves:
        poses[:, axis] = generator.uniform(*setup.span(machine.axes[axis], axis), len(poses))
    found = Places.joined([one.places for one in each])
    seen, top = (
        float(np.max(np.sum((observation.rows(0, at, np.ones_like(at)).rows @ reach) ** 2, axis=1)))
        for at in (poses, found.poses)
    )
    assert seen * (1 - gap) <= top <= max(one.upper for one in each)
    assert seen <= max(one.upper for one in each)
