"""A product of low rank taken off a table, which costs what fetching and writing the table costs."""

from __future__ import annotations

import numpy as np

from axiscal.numerics import Array

_NEAR = 32768
"""Numbers that stay in the cache while a product is taken off: of speed, not of the result."""


def take_off(table: Array, left: Array, right: Array, into: Array) -> None:
    """Subtract a product of low rank, into = table − left right: 2 m k j operations, 16 m k bytes.

    A few rows at a time, so that the product is taken off while it is near.
    table, into : (m, k), perhaps the same; left : (m, j); right : (j, k)
    """
    height = max(1, _NEAR // max(table.shape[1], 1))
    for start in range(0, len(table), height):
        near = slice(start, start + height)
        np.subtract(table[near], left[near] @ right, out=into[near])
