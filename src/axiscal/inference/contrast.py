"""A test for the end: the largest contrast of the readings with any departure, beside what chance makes of it.

    T = max_h −log₁₀ p_h,    p_h = P(χ²_r ≥ |Q_hᵀ y|²)

y and b whitened by the model, Q_h an orthonormal base of the r columns of b. The threshold is the 95 % point of T over
draws of y from the model, so that the places, periods and families that were tried are counted for what they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.numerics.from_scipy import chi_square_tails

_QUANTILE = 0.95
_DRAWS, _FEWEST_DRAWS, _PRODUCTS = 4000, 1000, 1e9
"""Draws of the threshold, fewer where they would take seconds: 1,000 know their 95 % point to 0.7 percent points."""
_AT_ONCE = 250
"""Draws at once: of memory, not of the result."""
_SEED = 5
"""Any seed: a verdict is to be the same every time."""
_FLAT = 1e-6
"""A second column that is so nearly a multiple of the first tells nothing of its own."""
_FARTHEST = 300.0
"""−log₁₀ of the smallest number: farther is certain."""


@dataclass(frozen=True, slots=True)
class Contrast:
    """value : T; threshold : what chance exceeds in one campaign of twenty"""

    value: float
    threshold: float

    @property
    def fires(self) -> bool:
        """Whether chance alone hardly makes such a contrast."""
        return self.value > self.threshold


NO_CONTRAST = Contrast(0.0, _FARTHEST)
"""Of too few readings."""


def contrast(parts: Array, y: Array) -> Contrast:
    """Return the largest contrast.  parts : (m, h, 2) whitened columns, the second one zero where there is one"""
    bases = _bases(parts)
    return Contrast(float(_largest(y[None], *bases)[0]), _threshold(parts, bases))


def contrasts(parts: Array, draws: Array) -> Array:
    """Return T of many campaigns at the same places, (n,).  draws : (n, m) whitened readings"""
    return _largest(draws, *_bases(parts))


def threshold(parts: Array) -> float:
    """Return what T exceeds by chance in one campaign of twenty."""
    return _threshold(parts, _bases(parts))


def _threshold(parts: Array, bases: tuple[Array, Array]) -> float:
    """Return the same with the bases of the departures."""
    count = int(np.clip(_PRODUCTS / max(parts.size, 1), _FEWEST_DRAWS, _DRAWS))
    rng = np.random.default_rng(_SEED)
    blocks = [rng.standard_normal((min(_AT_ONCE, count - at), len(parts))) for at in range(0, count, _AT_ONCE)]
    return float(np.quantile(np.concatenate([_largest(block, *bases) for block in blocks]), _QUANTILE))


def explained_squares(parts: Array, y: Array) -> Array:
    """Return what each departure of any size takes off |y|², (h,).  parts : (m, h, 2) whitened"""
    first, second, flat = _orthogonal(parts)
    squares: Array = (y @ first) ** 2 + np.where(flat, 0.0, (y @ second) ** 2)
    return squares


def _bases(parts: Array) -> tuple[Array, Array]:
    """Return the bases of departures with one column, (m, a), and of those with two, (m, b, 2)."""
    first, second, flat = _orthogonal(parts)
    return first[:, flat], np.stack([first[:, ~flat], second[:, ~flat]], axis=2)


def _orthogonal(parts: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return orthonormal columns of each departure, (m, h) each, and which have only the first, (h,)."""
    sizes = np.linalg.norm(parts, axis=0)
    ahead = np.argmax(sizes, axis=1)
    pick = np.arange(parts.shape[1])
    larger, smaller = parts[:, pick, ahead], parts[:, pick, 1 - ahead]
    scale = np.maximum(sizes.max(axis=1), np.finfo(float).tiny)
    first = larger / scale
    beside = smaller / scale
    beside = beside - first * np.sum(first * beside, axis=0)
    size = np.linalg.norm(beside, axis=0)
    return first, beside / np.maximum(size, _FLAT), size < _FLAT


def _largest(draws: Array, single: Array, double: Array) -> Array:
    """Return T of each draw.  draws : (n, m)"""
    one = ((draws @ single) ** 2).max(axis=1, initial=0.0)
    two = np.sum((draws @ double.reshape(len(double), -1)).reshape(len(draws), -1, 2) ** 2, axis=2)
    both = two.max(axis=1, initial=0.0)
    surprise: Array = np.maximum(_surprise(1, one), _surprise(2, both))
    return surprise


def _surprise(degrees: int, squares: Array) -> Array:
    """Return −log₁₀ P(χ² ≥ square) of each square."""
    tails = chi_square_tails(degrees, squares)
    with np.errstate(divide="ignore"):
        return np.where(tails > 0, -np.log10(tails), _FARTHEST)
