"""A seed is the same machine on every computer, whichever kernel of BLAS multiplies there."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal_core.eigen import settled, unique_root
from tests.generators.kernels import kernels, under

_DRAWS = """
import numpy as np
from axiscal.machine import load_machine
from axiscal.measurement.simulation import Simulator
from tests.generators.planes import bed, poses_of, table

def scaled(values):
    return (np.asarray(values) / np.max(np.abs(values))).ravel().tolist()

found = {}
for name, machine in {"dmu60": load_machine("dmu60"), "bed": bed(), "table": table()}.items():
    model, poses = machine, poses_of(machine, 5)
    for term, drawn in zip(model.terms, Simulator(machine, ()).drawn(3).values(poses), strict=True):
        found[f"{term.name} of {name}"] = scaled(drawn)
    for plane in model.planes:
        found[f"shapes of {plane.name} of {name}"] = scaled(plane.rows(*plane.at(poses)))
"""
_ROUNDING = 1e-6
"""Share of the largest value. Of a singular covariance an eigenvalue is rounding, some 1e-16 of the variance, and its
root some 1e-8 of the deviation.
"""


def test_a_seed_draws_the_same_machine_under_every_kernel() -> None:
    ran = [under(kernel, _DRAWS) for kernel in kernels()]
    assert len({kernel for kernel, _ in ran}) == len(ran) >= 2  # each was taken as asked, and no two are the same one
    first = ran[0][1]
    assert len(first) >= 60
    for kernel, found in ran[1:]:
        assert found.keys() == first.keys()
        apart = {name: np.max(np.abs(np.subtract(found[name], first[name]))) for name in first}
        assert {name: gap for name, gap in apart.items() if gap > _ROUNDING} == {}, kernel


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
