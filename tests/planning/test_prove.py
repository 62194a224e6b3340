"""Bounds for readings anywhere: below every plan, close to it where plans are known to be good."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
import pytest

from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.entry import ErrorEntry
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup, Unknown
from axiscal.planning.bound.lower_bound import lower_bound, prove
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.plan.exchange import relocated
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task
from tests.generators.designs import problem, random_poses, splines


def test_seven_readings_on_seven_knots_anywhere() -> None:
    asked = splines(1, 7, 0.1, 300)
    plan = make_plan(asked, Limits(readings=7))
    proof = prove(asked.state, asked.lattice, plan.places, 1e-2)
    assert proof.bound.everywhere
    assert proof.gap <= 1e-2 + 1e-9
    assert plan.value / proof.bound.value == pytest.approx(1.01, abs=1e-4)
    generator = np.random.default_rng(2)
    for _ in range(20):
        some = relocated(asked.state, Places.of_setup(0, *random_poses(asked, generator, 7)))
        assert proof.bound.value <= asked.state.after_readings(some).value


@pytest.mark.parametrize(("knots", "readings", "most"), [(7, 3, 1.067), (15, 20, 1.103)])
def test_boxes_lose_nothing_of_what_weights_prove(knots: int, readings: int, most: float) -> None:
    """Few readings leave most directions whatever they are, which boxes alone would have to find out one by one."""
    asked = splines(1, knots, 0.1 if knots == 7 else 0.03, 300)
    plan = make_plan(asked, Limits(readings=readings), bounded=False)
    with patch("axiscal.planning.bound.boxes._BOXES", 20):
        proof = prove(asked.state, asked.lattice, plan.places, 5e-3)
    assert plan.value / proof.bound.value < most


def plates(rest: float = 0.0) -> Task:
    """Return three slides that add up, with reversal, and a set-up along each of two directions."""
    axes = tuple(Axis(name, False, (0.0, 0.5)) for name in "XYZ")
    errors = [ErrorEntry(n, 1e-5, knots=4, rest=rest) for n in ("EXX", "EXY", "EYY", "EYX", "EZZ", "EYZ")]
    errors.append(ErrorEntry("EXX_reversal", 4e-6))
    machine = Machine("m", axes, 0.1, tuple(errors), "", "")
    setups = tuple(
        Setup(n, "probe", way, (0, 1, 2), (0.2,) * 3, 1e-6, (Unknown("zero", 1e-4),), 600.0, 1.0, 3.0, raster, "both")
        for n, way, raster in (("x", (1.0, 0.0, 0.0), (0.01, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0), (0.0,) * 3))
    )
    return problem(machine, setups, 400)


@pytest.mark.long
def test_no_search_beats_a_proof_with_several_set_ups_sides_and_a_raster() -> None:
    asked = plates(1e-6)
    plan = make_plan(asked, Limits(readings=9), bounded=False)
    bound = prove(asked.state, asked.lattice, plan.places, 0.05).bound.value
    assert bound <= plan.value
    generator = np.random.default_rng(0)
    for _ in range(200):
        poses, approaches = random_poses(asked, generator, 9)
        places = Places(np.array([generator.integers(2) for _ in poses]), poses, approaches)
        assert bound <= asked.state.after_readings(places).value
    pool = Pool(asked.observation, asked.lattice)
    assert 0.9 * lower_bound(pool, asked.state, plan.places, np.ones(len(pool) + 9), 9.0).value < bound


def test_a_plan_without_readings_leaves_what_there_was() -> None:
    asked = splines(1, 4, 0.1, 50)
    assert prove(asked.state, asked.lattice, Places.none(1)).bound.value == pytest.approx(asked.state.value)
