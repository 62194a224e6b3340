"""What is believed of one error along its axis, against draws of whole machines from the same belief."""

from __future__ import annotations

import numpy as np

from axiscal.belief import Belief
from axiscal.error_model.model import ErrorModel
from axiscal.error_model.volume import whole_travel
from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine import load_machine


def test_the_band_of_a_curve_is_the_scatter_of_machines_drawn_from_the_belief() -> None:
    model, rng = ErrorModel(load_machine("one-axis")), np.random.default_rng(1)
    root = 1e-6 * rng.standard_normal((model.size, model.size))
    belief = Belief(1e-6 * rng.standard_normal(model.size), root @ root.T)
    function, at = model.names["EXX"], np.array([0.0, 0.13, 0.512, 1.0])
    found = Estimate(model, belief, whole_travel(model)).curve("EXX", at)
    drawn = belief.sample(rng, 100_000)[:, function.columns] @ function.basis.rows(at).T
    drawn += function.rest * rng.standard_normal(drawn.shape)
    assert function.rest > 0
    np.testing.assert_allclose(found.std, drawn.std(axis=0), rtol=0.01)
    np.testing.assert_array_less(np.abs(found.mean - drawn.mean(axis=0)), 5 * found.std / np.sqrt(len(drawn)))
