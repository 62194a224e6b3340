"""What is shown for how linear a machine is, against the exact chain on draws."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.actual import deviation_of
from axiscal.errors.linear_bound import linear_to
from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import whole_travel
from axiscal.estimation import located
from axiscal.machine import load_machine


@pytest.mark.parametrize("far", [0.0, 30.0, 100.0])
def test_the_cross_terms_of_mean_and_what_is_open_are_within_what_is_shown(far: float) -> None:
    """A machine far from nominal, its errors known to a hundredth: products with the mean outweigh the squares."""
    errors, rng = ErrorModel(load_machine("dmu60")), np.random.default_rng(3)
    mean, factor = far * errors.prior_root() @ rng.standard_normal(errors.size), 0.01 * errors.prior_root()
    box = whole_travel(errors)
    low, high = np.array(box).T
    poses = rng.uniform(low, high, (40, len(box)))
    sides = np.ones_like(poses)
    at_mean, rows = deviation_of(errors, mean, poses, sides).displacement, errors.rows(poses, sides)
    worst = 0.0
    for _ in range(30):
        step = factor @ rng.standard_normal(errors.size)
        beyond = deviation_of(errors, mean + step, poses, sides).displacement - at_mean - rows @ step
        worst = max(worst, float(np.max(np.linalg.norm(beyond, axis=1))))
    shown = located._beyond(errors, mean, factor, box)
    assert worst < shown
    squares = linear_to(errors, located._sizes(errors, 0.0 * mean, factor, box), box)
    assert far == 0.0 or worst > squares  # which is what was shown before


def test_without_a_mean_it_is_the_bound_of_what_is_open() -> None:
    errors = ErrorModel(load_machine("dmu60"))
    box, root = whole_travel(errors), errors.prior_root()
    sizes = located._sizes(errors, np.zeros(errors.size), root, box)
    assert located._beyond(errors, np.zeros(errors.size), root, box) == pytest.approx(linear_to(errors, sizes, box))


def test_no_size_leaves_out_a_mean_a_band_or_a_rest() -> None:
    """Against the largest of |m| + 2 s over 25 places of the travel, s by drawing from the belief and from the rest."""
    errors, rng = ErrorModel(load_machine("one-axis")), np.random.default_rng(4)
    mean, factor = 1e-6 * rng.standard_normal(errors.size), 1e-6 * rng.standard_normal((errors.size, errors.size))
    box, term = whole_travel(errors), errors.names["EXX"]
    (low, high) = box[term.axes[0]]
    rows, rest = term.rows(np.linspace(low, high, 25)), 20 * float(np.abs(factor).max())
    drawn = (mean + rng.standard_normal((20_000, errors.size)) @ factor.T)[:, term.columns] @ rows.T
    whole = drawn + rest * rng.standard_normal(drawn.shape)
    expected = np.max(np.abs(rows @ mean[term.columns]) + 2 * whole.std(axis=0))
    assert located._size(term, mean, factor, box, rest) == pytest.approx(expected, rel=0.02)
    bare = np.max(np.abs(rows @ mean[term.columns]) + 2 * drawn.std(axis=0))
    assert located._size(term, mean, factor, box, 0.0) == pytest.approx(bare, rel=0.02)
    assert expected > 3 * bare


def test_of_a_machine_that_is_known_exactly_the_rests_are_what_is_open() -> None:
    errors = ErrorModel(load_machine("one-axis"))
    nothing, box = np.zeros(errors.size), whole_travel(errors)
    rests = np.array([term.rest for term in errors.terms])
    assert rests.max() > 0
    known = np.zeros((errors.size, 1))
    assert located._sizes(errors, nothing, known, box) == pytest.approx(2 * rests)
    assert not located._sizes(errors, nothing, known, box, rests=False).any()
