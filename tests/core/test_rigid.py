"""Turns, cross products and products of low rank against scipy's and numpy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from axiscal_core.from_scipy import sparse_product, take_off
from axiscal_core.rigid import cross, turned_about


def test_turns_about_one_direction_are_those_of_their_rotation_vectors() -> None:
    rng = np.random.default_rng(1)
    angles = np.concatenate([[0.0, 1e-12, -np.pi, np.pi], rng.uniform(-7, 7, 40)])
    for direction in [*np.eye(3), *rng.normal(size=(5, 3))]:
        unit = direction / np.linalg.norm(direction)
        expected = Rotation.from_rotvec(angles[:, None] * unit).as_matrix()
        np.testing.assert_allclose(turned_about(unit, angles), expected, atol=2e-15)


def test_cross_products_of_stacks_are_those_of_numpy() -> None:
    rng = np.random.default_rng(2)
    first, second = rng.normal(size=(4, 6, 3)), rng.normal(size=(6, 3))
    np.testing.assert_array_equal(cross(first, second), np.cross(first, second))
    assert cross(np.zeros((0, 3)), np.zeros((0, 3))).shape == (0, 3)


def test_a_product_of_few_entries_is_that_of_the_whole_matrix() -> None:
    rng = np.random.default_rng(3)
    whole = rng.normal(size=(9, 5)) * (rng.random((9, 5)) < 0.4)
    rows, columns = np.nonzero(whole)
    right = rng.normal(size=(5, 4))
    found = sparse_product(whole[rows, columns], rows, columns, (9, 5))(right)
    np.testing.assert_allclose(found, whole @ right, atol=1e-14)


@pytest.mark.parametrize("shape", [(1, 1), (3, 40_000), (700, 90)])
@pytest.mark.parametrize("rank", [0, 1, 3])
def test_a_product_is_taken_off_in_place(shape: tuple[int, int], rank: int) -> None:
    rng = np.random.default_rng(0)
    tables, left, right = (
        rng.normal(size=(2, *shape)),
        rng.normal(size=(shape[0], 5)),
        rng.normal(size=(rank, shape[1])),
    )
    expected, other = tables[0] - left[:, :rank] @ right, tables[1].copy()
    take_off(tables[0], left[:, :rank], right)
    np.testing.assert_allclose(tables[0], expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(tables[1], other)
