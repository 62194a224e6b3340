"""The weights on a support of readings that leave least, by a primal-dual interior point method.

Each step looks ahead without the barrier first, which says how far the barrier may sink (Mehrotra 1992): what a step
costs is the second derivative, and with it both directions come from one factor.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.covariance import informed
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution_of_product
from axiscal.numerics.gaussian import lower_root

_NEWTON = 60
"""Steps of Newton, which end where the weights settle; what is left early costs another round."""
CLOSE = 1e-6
"""Share of J by which weights may be off unless said otherwise: far below what a bound is closed to."""
_RESIDUAL = 10.0
"""Times that share by which slopes may be off: they enter the bound by their products with weights."""
_WITHIN = 0.95
"""Share of the way to where a weight would vanish; any below one."""
_ROUNDING = float(np.finfo(float).eps)
"""Of what bends, in each number: readings that say the same do not bend between themselves, and neither do their duals
when they have gone."""


def optimal_weights(
    along: Array,
    owner: NDArray[np.intp],
    weighted: Array,
    weights: Array,
    costs: Array,
    limit: float,
    close: float = CLOSE,
) -> Array:
    """Return the weights (s,) that minimise J over costs·x = limit, x ≥ 0, by a primal-dual interior point method.

    along : R^-½ G F (m, r); owner : (m,) to which reading each number belongs, in order; weighted : V F (w, r)
    close : share of J by which they may be off
    ∂²J = 2 (G S Gᵀ) ∘ (G S W S Gᵀ), summed over the rows of each reading, positive semidefinite as a product of such.
    """
    scale = limit / costs
    along = along * np.sqrt(scale[owner])[:, None]
    if along.shape[1] > len(along):  # what no reading sees does not matter
        basis = np.linalg.qr(along.T)[0]
        along, weighted = along @ basis, weighted @ basis
    x = np.maximum(weights / scale, 1e-6 / len(weights))
    x /= x.sum()
    slopes, bend = _curvatures(along, owner, weighted, x)
    level = float(slopes @ x)
    if not level > 0:  # nothing that may be read tells anything
        return weights
    dual = np.maximum(level - slopes, 0.05 * level)
    for _ in range(_NEWTON):
        residual = slopes - level + dual
        move, shift, dual_move = _step(bend, x, dual, residual)
        share = min(1.0, _WITHIN * _room(x, move), _WITHIN * _room(dual, dual_move))
        x, dual, level = x + share * move, dual + share * dual_move, level + share * shift
        x /= x.sum()
        slopes, bend = _curvatures(along, owner, weighted, x)
        residual = slopes - level + dual
        if x @ dual < close * abs(level) and np.abs(residual).max() < _RESIDUAL * close * abs(level):
            break
    result: Array = x * scale
    return result


def _step(bend: Array, x: Array, dual: Array, residual: Array) -> tuple[Array, float, Array]:
    """Return how weights, their level and duals move."""
    system = bend.copy()
    system[np.diag_indices(len(x))] += np.maximum(dual / x, _ROUNDING * len(x) * np.trace(bend))
    lower = lower_root(system)
    ones = solution_of_product(lower, np.ones(len(x)))

    def moves(pushed: Array) -> tuple[Array, float, Array]:
        solved = solution_of_product(lower, residual - dual + pushed)
        shift = float(solved.sum() / ones.sum())
        move = solved - shift * ones
        return move, shift, pushed - dual - dual / x * move

    ahead, _, dual_ahead = moves(np.zeros(len(x)))
    share = min(1.0, _room(x, ahead), _room(dual, dual_ahead))
    gap = float(x @ dual)
    left = float((x + share * ahead) @ (dual + share * dual_ahead)) / gap
    return moves((left**3 * gap / len(x) - ahead * dual_ahead) / x)


def _curvatures(along: Array, owner: NDArray[np.intp], weighted: Array, x: Array) -> tuple[Array, Array]:
    """Return d = −∂J/∂x (s,) and ∂²J (s, s).  along : G F (m, r); owner : (m,) in 0…s−1; weighted : V F (w, r)."""
    scaled = along * np.sqrt(x[owner])[:, None]
    both = informed(np.vstack([along, weighted]), scaled)
    seen, reach = both[: len(along)], both[len(along) :]
    reached = seen @ reach.T
    target = reached @ reached.T
    slopes: Array = np.diagonal(target).copy()
    bend: Array = seen @ seen.T
    bend *= target
    bend *= 2
    if len(x) < len(along):
        first = np.searchsorted(owner, np.arange(len(x)))
        slopes = np.add.reduceat(slopes, first)
        bend = np.add.reduceat(np.add.reduceat(bend, first, axis=0), first, axis=1)
    return slopes, bend


def _room(x: Array, move: Array) -> float:
    """Return how far x may go along a move before an entry vanishes."""
    falling = move < 0
    return float((x[falling] / -move[falling]).min(initial=1e300))
