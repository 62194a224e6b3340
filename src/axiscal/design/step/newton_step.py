"""Newton's step uphill on several axes at once, from values on a small stencil around each place."""

from __future__ import annotations

import itertools

import numpy as np

from axiscal.numerics import Array

_STEP = 3e-5
"""A share of the travel: second differences keep six digits, of rounding (1e-16/h²) and of bending (h²)."""


def stencil(size: int) -> Array:
    """Return the offsets at which the second-order Taylor polynomial is read off, in shares of the travel, (p, size).

    0, ±e_i, ±(e_i + e_j), times a small step.
    """
    unit = np.eye(size)
    pairs = [unit[i] + unit[j] for i, j in itertools.combinations(range(size), 2)]
    return _STEP * np.array([np.zeros(size), *unit, *-unit, *pairs, *(-p for p in pairs)])


def derivatives(values: Array, size: int) -> tuple[Array, Array]:
    """Return gradient (n, size) and Hessian (n, size, size) from the values (n, p) on the stencil."""
    middle, up, down = values[:, 0], values[:, 1 : size + 1], values[:, size + 1 : 2 * size + 1]
    pairs = values[:, 2 * size + 1 :]
    half = pairs.shape[1] // 2
    bend = np.zeros((len(values), size, size))
    bend[:, np.arange(size), np.arange(size)] = up + down - 2 * middle[:, None]
    for p, (i, j) in enumerate(itertools.combinations(range(size), 2)):
        single = up[:, i] + down[:, i] + up[:, j] + down[:, j]
        mixed = (pairs[:, p] + pairs[:, half + p] - single + 2 * middle) / 2
        bend[:, i, j] = bend[:, j, i] = mixed
    return (up - down) / (2 * _STEP), bend / _STEP**2


def ascent(slope: Array, bend: Array, share: Array) -> Array:
    """Return Newton's steps (n, size) towards a maximum; an axis at its end that would leave is held.

    share : (n, size) of the travel, 0 and 1 at its ends. Directions that bend upwards are followed uphill all the same.
    """
    held = ((share <= 0) & (slope < 0)) | ((share >= 1) & (slope > 0))
    free = ~held
    bend = np.where(free[:, :, None] & free[:, None, :], bend, 0.0)
    slope = np.where(free, slope, 0.0)
    values, vectors = np.linalg.eigh(bend)
    turned = np.einsum("nij,ni->nj", vectors, slope)
    along = turned / np.maximum(np.abs(values), 1e-12 * np.abs(values).max(axis=1, keepdims=True) + 1e-300)
    steps: Array = np.einsum("nij,nj->ni", vectors, along)
    return np.clip(steps, -0.2, 0.2)
