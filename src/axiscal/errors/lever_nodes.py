"""Nodes at which the levers of a machine are sampled along each axis, so that products of two follow from them exactly.

Every lever is affine in each linear coordinate and of first order in the sine and cosine of each rotary one. So three
nodes are enough on a linear axis, and five on a rotary one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.numerics import Array
from axiscal.numerics.quadrature import gauss

_GAUSS = 10
"""Points of Gauss: exact for degree 19, and squares of cubics times levers have 8."""
_SHORT_TURN = 1.0
"""rad: over less, the moments of sine and cosine cancel, so polynomials stand for them; near it both hold."""
_POLYNOMIAL_NODES = 12
"""Sine and cosine over half a radian either way to rounding."""


def quadrature(knots: list[Array], bounds: tuple[float, float]) -> tuple[Array, Array]:
    """Composite Gauss-Legendre between all knots in the bounds, weights summing to one."""
    start, stop = bounds
    inner = np.unique(np.concatenate([*knots, np.linspace(start, stop, 5)]))
    breaks = np.concatenate([[start], inner[(inner > start) & (inner < stop)], [stop]])
    nodes, weights = gauss(breaks, _GAUSS)
    return nodes.ravel(), weights.ravel() / (stop - start)


def lagrange(points: Array, bounds: tuple[float, float], rotary: bool) -> tuple[Array, Array]:
    """Return the nodes (k,) and the Lagrange functions at the points (m, k): the space products of levers live in."""
    start, stop = bounds
    middle: float = (start + stop) / 2
    half: float = (stop - start) / 2
    trigonometric = rotary and half > _SHORT_TURN / 2
    count = 5 if trigonometric else _POLYNOMIAL_NODES if rotary else 3
    even: Array = np.arange(count, dtype=float)
    offsets: Array = -np.cos(np.pi * (even + 0.5) / count) * half
    if trigonometric:
        offsets = half * (2 * even + 1 - count) / count
    space = _trigonometric if trigonometric else np.polynomial.chebyshev.chebvander
    scale = 1.0 if trigonometric else half
    at_nodes = space(offsets / scale, 4 if trigonometric else count - 1)
    at_points = space((points - middle) / scale, 4 if trigonometric else count - 1)
    functions: Array = np.asarray(np.linalg.solve(at_nodes.T, at_points.T).T, dtype=float)
    return middle + offsets, functions


def _trigonometric(angle: Array, order: int) -> Array:
    harmonics = [f(n * angle) for n in range(1, order // 2 + 1) for f in (np.cos, np.sin)]
    return np.stack([np.ones_like(angle), *harmonics], axis=1)


def averaged(plain: Sequence[Array], values: Array, kept: tuple[int, ...]) -> Array:
    """Average an array (..., grid) over every axis that is not kept.  plain : of each axis E[ℓ_i] (k,)"""
    lead = values.ndim - len(plain)
    for k in reversed(range(len(plain))):
        if k not in kept:
            values = np.tensordot(values, plain[k], axes=([lead + k], [0]))
    return values
