"""How much a draw with large sizes may count: as much as it adds to U, and not as much as it adds to a variance.

Sizes are Student-t in the logarithm, so a mean square over them is that of the few largest draws, or none at all. What
is promised is a share of 95 %. With T the mean square over the volume at each draw, F the normal's share within k√T and
k = 1.96, T* solves Σ w F(k √(T*/T)) = 0.95, and draws are cut at the T_cap with Σ w min(T, T_cap) = T*.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.numerics.from_scipy import normal_share

_K, _LEVEL = 1.959963984540054, 0.95
_HALVINGS = 60


@dataclass(frozen=True, eq=False)
class Volume:
    """What unknowns do over the volume.

    root : V (r, n), |V x|² is the mean square of the tool's deviation by answered unknowns x, the first n of them
    rests : mean squares by the rests of the terms whose size varies, m²; size_at : the number of the θ of each
    """

    root: Array
    rests: Array
    size_at: NDArray[np.intp]

    def square(self, covariance: Array, apart: Array, theta: Array) -> float:
        """Return T of one draw, m².  covariance : (k, k); apart : (k,) its mean less that of all; theta : (s,)"""
        size = self.root.shape[1]
        spread = np.sum((self.root @ covariance[:size, :size]) * self.root)
        moved = self.root @ apart[:size]
        return float(spread + moved @ moved + self.rests @ np.exp(2 * theta[self.size_at]))


def shares_that_count(squares: Array, weights: Array) -> Array:
    """Return by which factor each draw's covariance counts, (d,) at most 1.  squares : T (d,); weights : (d,)"""
    if not np.max(squares) > 0:
        return np.ones_like(squares)
    wanted = _solved(lambda t: float(weights @ (2 * normal_share(_K * np.sqrt(t / squares)) - 1)), _LEVEL, squares)
    if wanted >= float(weights @ squares):
        return np.ones_like(squares)
    cap = _solved(lambda t: float(weights @ np.minimum(squares, t)), wanted, squares)
    result: Array = np.minimum(1.0, cap / squares)
    return result


def _solved(rising: Callable[[float], float], level: float, squares: Array) -> float:
    """Return where a function of a mean square that does not fall reaches a level, by bisection in the logarithm."""
    low, high = float(np.log(squares[squares > 0].min())) - 3.0, float(np.log(squares.max())) + 3.0
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if rising(float(np.exp(middle))) < level else (low, middle)
    return float(np.exp(high))
