"""The estimate of all readings against plain conditioning: in parts, repeated, used again, with bad ones."""

from __future__ import annotations

import numpy as np
import pytest

import axiscal as ac
from axiscal.estimation.knowledge import Knowledge
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup

NOISE, REST = 0.3e-6, 0.3e-6
"""Of one reading, and of EXX of the built-in machine of one axis: what no spline follows."""


def laser() -> Observation:
    """Return a laser on one axis that is always come to from below."""
    setup = Setup("laser", "interferometer", (1.0, 0.0, 0.0), (0,), (0.5,), NOISE, (), 600.0, 1.0, 3.0, (0.0,), "+")
    return Observation(ac.ErrorModel(ac.load_machine("one-axis")), (setup,))


@pytest.mark.parametrize("one_by_one", [True, False])
def test_reading_one_place_400_times_leaves_the_rest(one_by_one: bool) -> None:
    """The spline there is known as by one reading whose noise is the rest, and a twentieth of the instrument's."""
    observation = laser()
    knowledge, errors = Knowledge.before(observation), observation.errors
    row = errors.rows(np.array([[0.37]]), np.ones((1, 1)))[0, 0]
    prior = float(row @ errors.prior_covariance() @ row)
    if one_by_one:
        for _ in range(400):
            knowledge = knowledge.read([Reading("laser", (0.37,), (1,), 0.0)])
    else:
        knowledge = knowledge.read([Reading("laser", (0.37,), (1,), 0.0)] * 400)
    std = float(np.linalg.norm(row @ knowledge.belief.factor[: errors.size]))
    assert std == pytest.approx((1 / prior + 1 / (REST**2 + NOISE**2 / 400)) ** -0.5, rel=1e-6)
    assert f"{std * 1e6:.3f}" == "0.300"
