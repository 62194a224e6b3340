"""What wears off, against machines that are drawn one by one."""

from __future__ import annotations

import numpy as np

from axiscal.estimation.promise.problem import Inherited
from axiscal.numerics import Array
from axiscal.ports.fleet.worn_machine import Wearing

SIZE, MACHINES = 5, 200_000


def _covariance(rng: np.random.Generator) -> Array:
    root = rng.standard_normal((SIZE, SIZE))
    return np.asarray(root @ root.T)


def test_what_is_left_is_that_of_machines_drawn_one_by_one() -> None:
    rng = np.random.default_rng(3)
    mean, fresh, known = rng.standard_normal(SIZE), _covariance(rng), 0.1 * _covariance(rng)
    found, wears, renewed = (
        Inherited(rng.standard_normal(SIZE), known),
        Wearing(mean, fresh),
        np.zeros(SIZE, dtype=bool),
    )
    renewed[1] = True
    a, anew, new = (
        rng.multivariate_normal(m, c, MACHINES)
        for m, c in ((found.mean, known), (np.zeros(SIZE), fresh), (mean, fresh))
    )
    later = np.where(renewed, new, mean + 0.9 * (a - mean) + np.sqrt(0.19) * anew)
    scale = np.sqrt(np.diagonal(fresh))
    spread = np.cov(later.T) / np.outer(scale, scale)
    np.testing.assert_allclose(wears.covariance(found, 0.81, renewed) / np.outer(scale, scale), spread, atol=0.02)
    left = wears.left(found, 0.9)
    np.testing.assert_allclose(left.mean[~renewed] / scale[~renewed], (later.mean(axis=0) / scale)[~renewed], atol=0.02)
    np.testing.assert_array_equal(left.covariance, wears.covariance(found, 0.81, np.zeros(SIZE, dtype=bool)))
