"""What is believed of one error along its axis, against draws of whole machines from the same belief."""

from __future__ import annotations

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import whole_travel
from axiscal.estimation.belief import Belief
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


def test_what_readings_say_of_a_rest_is_in_the_deviation_of_its_cell_alone() -> None:
    model = ErrorModel(load_machine("one-axis"))
    index = list(model.terms).index(model.names["EXX"])
    cells = np.zeros(model.terms[index].cell_count)
    belief = Belief(np.zeros(model.size), np.zeros((model.size, model.size)))
    low, high = whole_travel(model)[0]
    poses = np.linspace(low, high, 101)[:, None]
    found = model.terms[index].cells(poses[:, 0])
    inside = found == found[30]
    cells[found[30]] = 3e-6
    assert 0 < inside.sum() < len(poses)
    known = Estimate(model, belief, whole_travel(model), rests={index: cells})
    expected = np.where(inside[:, None], 3e-6 * model.levers(poses)[index], 0.0)
    np.testing.assert_allclose(known.deviation(poses, np.ones_like(poses)), expected, rtol=0, atol=1e-15)
    assert np.abs(expected).max() == 3e-6
