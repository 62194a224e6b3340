"""Bounds for readings anywhere: below every plan, close to it where plans are known to be good."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.design.plan import make_plan
from axiscal.design.problem import Limits
from axiscal.design.prove import prove
from axiscal.design.state import Point
from axiscal.exceptions import PlanError
from tests.unit.design_cases import levered, random_poses, splines


def test_seven_readings_on_seven_knots_anywhere() -> None:
    asked = splines(1, 7, 0.1, 300)
    plan = make_plan(asked, Limits(readings=7))
    proof = prove(asked.state, [0], plan.points, 7)
    assert proof.bound.everywhere
    assert proof.gap < 5e-3
    assert plan.value / proof.bound.value == pytest.approx(1.056, abs=3e-3)


def test_three_stacked_splines_cannot_be_measured_better() -> None:
    asked = splines(3, 7, 0.01, 500)
    plan = make_plan(asked, Limits(readings=20), bounded=False)
    proof = prove(asked.state, [0], plan.points, 20)
    assert 1.0 <= plan.value / proof.bound.value < 1.005


@pytest.mark.parametrize("seed", range(5))
def test_no_random_plan_is_below_it(seed: int) -> None:
    generator = np.random.default_rng(seed)
    asked = splines(2, 4, 10.0 ** generator.uniform(-2, 0), 100)
    poses, approaches = random_poses(asked, generator, 6)
    points = [Point(0, p, np.abs(a)) for p, a in zip(poses, approaches, strict=True)]
    bound = prove(asked.state, [0], points, 6).bound.value
    assert 0 < bound <= asked.state.with_points(points).value
    assert bound <= make_plan(asked, Limits(readings=6), bounded=False).value


def test_lever_arms_are_refused() -> None:
    asked = levered(50)
    with pytest.raises(PlanError, match="simply add up"):
        prove(asked.state, [0], [Point(0, asked.lattice.poses[0], asked.lattice.approaches[0])], 1)
