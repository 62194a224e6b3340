"""Roots and Gram matrices of criteria: one J by both, and neither taken for the other."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation.accuracy.criterion import Gram, Root, joint_root, value
from axiscal.estimation.belief import Belief
from axiscal.estimation.knowledge import Knowledge
from axiscal.exceptions import ShapeError
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.gains.gain import Scorer
from axiscal.planning.step.best_step import best_step
from tests.generators.designs import levered


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
    assert root.gram.value(covariance) == pytest.approx(expected, rel=1e-12)
    again = root.gram.root
    assert again.matrix.shape == (rank, 6)
    assert again.value(factor) == pytest.approx(expected, rel=1e-12)
    assert value(Belief(np.zeros(8), covariance), root) == pytest.approx(expected, rel=1e-9)


def test_a_root_is_refused_as_a_gram_matrix() -> None:
    with pytest.raises(ShapeError, match="square and symmetric"):
        Gram(np.ones((2, 5)))
    with pytest.raises(ShapeError, match="square and symmetric"):
        Gram(np.array([[1.0, 2.0], [0.0, 1.0]]))


def test_a_gram_matrix_is_refused_as_a_root() -> None:
    """Of all types alike in shape: only the root may be given, to the checker of types and when it runs."""
    asked = levered(20)
    gram = joint_root(asked.observation.errors).gram
    knowledge = Knowledge(asked.observation, asked.belief)
    for wrong in (gram, gram.matrix):
        with pytest.raises(ShapeError, match="Root is asked for"):
            best_step(knowledge, wrong, asked.lattice)  # type: ignore[arg-type]
        with pytest.raises(ShapeError, match="Root is asked for"):
            Covariance.of(asked.observation, asked.belief, wrong)  # type: ignore[arg-type]
        with pytest.raises(ShapeError, match="Root is asked for"):
            Scorer.of(asked.observation, asked.belief, wrong)  # type: ignore[arg-type]
        with pytest.raises(ShapeError, match="Root is asked for"):
            value(asked.belief, wrong)  # type: ignore[arg-type]
