"""Weights on many candidates at once, each by itself: no second derivative, whose price grows as their cube.

A slope d_i above its level λ c_i wants more weight, and Newton's step of that weight alone, while the others stay, is
(1 − λ c_i/d_i)/(2 k_i), k_i = tr(B_i S B_iᵀ) with its whitened rows B_i and S the covariance now. Neighbours want the
same and all get it, so a share of it is given. A slope below its level loses, x_i ← x_i (d_i/λ c_i)^p (the
multiplicative algorithm: Yu 2010). Any weights prove a bound.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.design.bound.certificate import Dual
from axiscal.design.gains.covariance import Covariance, informed
from axiscal.numerics import Array

_SHARE = 0.3
"""Of Newton's step: a tenth and a half lead to the same, more slowly and by longer ways round."""
_POWER = 0.4
"""Up to a half no turn overshoots; a little below it, since shares of steps are given beside it."""
_NOUGHT = 1e-300
"""No division by nought."""


class Turn(NamedTuple):
    """weights : (s,); dual : the matrix they lead to; slopes : d (s,) with it"""

    weights: Array
    dual: Dual
    slopes: Array


def turns(
    state: Covariance, along: Array, owner: NDArray[np.intp], weights: Array, costs: Array, limit: float
) -> Iterator[Turn]:
    """Yield weights turn by turn, as they stand first; m r² operations each.

    along : R^-½ G F (m, r); owner : (m,) to which reading each number belongs, in order; weights, costs : (s,)
    """
    first = np.searchsorted(owner, np.arange(len(weights)))
    seen = informed(along, along * np.sqrt(weights[owner])[:, None])
    spread = np.maximum(np.add.reduceat(np.sum(seen**2, axis=1), first), _NOUGHT)
    while True:
        dual = Dual.of(state, along * np.sqrt(weights[owner])[:, None])
        slopes = np.add.reduceat(np.sum((along @ dual.z.T) ** 2, axis=1), first)
        yield Turn(weights, dual, slopes)
        above = np.maximum(slopes / (costs * float(slopes @ weights) / limit), _NOUGHT)
        scaled = weights * above**_POWER
        grown = weights + _SHARE * (1 - 1 / above) / (2 * spread)
        weights = np.where(above > 1, np.maximum(scaled, grown), scaled)
        weights = weights * (limit / float(costs @ weights))
