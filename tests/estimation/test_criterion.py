"""Roots and Gram matrices of criteria: one J by both."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation.accuracy.criterion import Root
from axiscal.estimation.belief import Belief
from axiscal.numerics import Array


def _covariance(size: int, seed: int) -> Array:
    factor = np.random.default_rng(seed).standard_normal((size, size))
    return factor @ factor.T


@pytest.mark.parametrize("rank", [1, 3, 6])
def test_both_give_the_same_j_for_any_rank(rank: int) -> None:
    """Against tr(V C Vᵀ) written out, of a covariance with two unknowns more."""
    root, covariance = Root(np.random.default_rng(rank).standard_normal((rank, 6))), _covariance(8, rank)
    expected = np.trace(root.matrix @ covariance[:6, :6] @ root.matrix.T)
    factor: Array = np.asarray(np.linalg.cholesky(covariance), dtype=float)
    assert root.value(factor) == pytest.approx(expected, rel=1e-12)
    assert np.sum(root.gram * covariance[:6, :6]) == pytest.approx(expected, rel=1e-12)
    again = Root.of_gram(root.gram)
    assert again.matrix.shape == (rank, 6)
    assert again.value(factor) == pytest.approx(expected, rel=1e-12)
    assert root.value(Belief(np.zeros(8), covariance).factor) == pytest.approx(expected, rel=1e-9)
