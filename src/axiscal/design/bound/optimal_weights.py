"""The weights on a support of readings that leave least, by a primal-dual interior point method."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.covariance import informed
from axiscal.numerics import Array

_NEWTON = 60
"""Steps of Newton, which end where the weights settle; what is left early costs another round."""
_BARRIER = 0.2
"""By this factor the barrier sinks at each step; interior points converge with any from 0.1 to 0.5."""


def optimal_weights(
    along: Array, owner: NDArray[np.intp], weighted: Array, weights: Array, costs: Array, limit: float
) -> Array:
    """Return the weights (s,) that minimise J over costs·x = limit, x ≥ 0, by a primal-dual interior point method.

    along : R^-½ G F (m, r); owner : (m,) to which reading each number belongs, in order; weighted : V F (w, r)
    ∂²J = 2 (G S Gᵀ) ∘ (G S W S Gᵀ), summed over the rows of each reading, positive semidefinite as a product of such.
    """
    scale = limit / costs
    along = along * np.sqrt(scale[owner])[:, None]
    if along.shape[1] > len(along):  # what no reading sees does not matter
        basis = np.linalg.qr(along.T)[0]
        along, weighted = along @ basis, weighted @ basis
    x = np.maximum(weights / scale, 1e-6 / len(weights))
    x /= x.sum()
    slopes = _curvatures(along, owner, weighted, x)[0]
    level = float(slopes @ x)
    if not level > 0:  # nothing that may be read tells anything
        return weights
    dual = np.maximum(level - slopes, 0.05 * level)
    for _ in range(_NEWTON):
        slopes, bend = _curvatures(along, owner, weighted, x)
        barrier = _BARRIER * float(x @ dual) / len(x)
        residual = slopes - level + dual
        move, shift = _newton(bend + np.diag(dual / x), residual - dual + barrier / x)
        dual_move = barrier / x - dual - dual / x * move
        share = min(1.0, 0.95 * _room(x, move), 0.95 * _room(dual, dual_move))
        x, dual, level = x + share * move, dual + share * dual_move, level + share * shift
        x /= x.sum()
        if x @ dual < 1e-6 * abs(level) and np.abs(residual).max() < 1e-5 * abs(level):
            break
    result: Array = x * scale
    return result


def _curvatures(along: Array, owner: NDArray[np.intp], weighted: Array, x: Array) -> tuple[Array, Array]:
    """Return d = −∂J/∂x (s,) and ∂²J (s, s).  along : G F (m, r); owner : (m,) in 0…s−1; weighted : V F (w, r)."""
    scaled = along * np.sqrt(x[owner])[:, None]
    both = informed(np.vstack([along, weighted]), scaled)
    seen, reach = both[: len(along)], both[len(along) :]
    reached = seen @ reach.T
    target = reached @ reached.T
    slopes: Array = np.diagonal(target).copy()
    bend: Array = 2 * (seen @ seen.T) * target
    if len(x) < len(along):
        first = np.searchsorted(owner, np.arange(len(x)))
        slopes = np.add.reduceat(slopes, first)
        bend = np.add.reduceat(np.add.reduceat(bend, first, axis=0), first, axis=1)
    return slopes, bend


def _newton(system: Array, right: Array) -> tuple[Array, float]:
    """Solve system·move + shift·1 = right with Σ move = 0."""
    solved = np.linalg.solve(system, np.column_stack([right, np.ones(len(right))]))
    shift = float(solved[:, 0].sum() / solved[:, 1].sum())
    return solved[:, 0] - shift * solved[:, 1], shift


def _room(x: Array, move: Array) -> float:
    """Return how far x may go along a move before an entry vanishes."""
    falling = move < 0
    return float((x[falling] / -move[falling]).min(initial=1e300))
