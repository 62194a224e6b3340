"""A product of low rank taken off a table, against the whole product."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.planning.gains.covariance import take_off


@pytest.mark.parametrize("shape", [(1, 1), (3, 40_000), (700, 90)])
@pytest.mark.parametrize("in_place", [True, False])
def test_a_product_is_taken_off_block_by_block(shape: tuple[int, int], in_place: bool) -> None:
    rng = np.random.default_rng(0)
    table, left, right = rng.normal(size=shape), rng.normal(size=(shape[0], 3)), rng.normal(size=(3, shape[1]))
    expected, before = table - left @ right, table.copy()
    into = table if in_place else np.full_like(table, np.nan)
    take_off(table, left, right, into)
    np.testing.assert_allclose(into, expected, rtol=1e-12, atol=1e-12)
    assert in_place or np.array_equal(table, before)
