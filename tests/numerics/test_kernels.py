"""Roots are the same whichever eigenvectors a BLAS leaves, so that a seed is the same machine on every computer."""

import numpy as np
import pytest

from axiscal_core.eigen import settled, unique_root


def test_other_eigenvectors_of_the_same_covariance_are_settled_alike() -> None:
    """Signs at random, and equal eigenvalues turned at random, as another BLAS might leave them."""
    rng = np.random.default_rng(0)
    vectors = np.linalg.qr(rng.standard_normal((7, 7)))[0]
    values = np.array([0.0, 0.0, 1.0, 2.0, 2.0, 2.0, 5.0])
    once = settled(values, vectors)
    np.testing.assert_allclose((once * values) @ once.T, (vectors * values) @ vectors.T, atol=1e-13)
    for _ in range(20):
        other = vectors * rng.choice([-1.0, 1.0], 7)
        for part in ([0, 1], [3, 4, 5]):
            other[:, part] = other[:, part] @ np.linalg.qr(rng.standard_normal((len(part), len(part))))[0]
        np.testing.assert_allclose(settled(values, other), once, atol=1e-13)


def test_a_wave_has_its_sign_from_the_first_of_its_ends() -> None:
    """Both ends of an odd shape are as far from zero: the last digit must not decide which of them is positive."""
    wave = np.array([-1.0, -0.3, 0.0, 0.3, 1.0])
    for nudge in (-1e-15, 1e-15):
        one = wave + np.array([nudge, 0, 0, 0, 0])
        for sign in (-1, 1):
            found = settled(np.ones(1), sign * one[:, None] / np.linalg.norm(one))[:, 0]
            np.testing.assert_allclose(found, -wave / np.linalg.norm(wave), atol=1e-13)


@pytest.mark.parametrize("rank", [3, 6])
def test_a_root_is_of_any_rank_and_hardly_moved_by_last_digits(rank: int) -> None:
    rng = np.random.default_rng(rank)
    unit = np.diag([1.0, 1e-6, 1e-3, 1e-6, 1e-5, 0.0])  # metres beside micrometres, and one that is known
    part = unit @ rng.standard_normal((6, rank))
    covariance = part @ part.T
    root = unique_root(covariance)
    std = np.append(np.sqrt(np.diagonal(covariance)[:-1]), 1.0)
    np.testing.assert_allclose(root @ root.T / np.outer(std, std), covariance / np.outer(std, std), atol=1e-13)
    bent = rng.standard_normal((6, 6))
    other = unique_root(covariance * (1 + 1e-16 * (bent + bent.T)))
    assert np.max(np.abs(other - root) / std[:, None]) < 1e-7
