"""Gains of readings, from their rows and from a scorer, and the series that follow them along an axis."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.polynomial.chebyshev import chebfit, chebval

from axiscal.measurement.candidates import breaks_along, smoothness_along
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import Scorer
from axiscal_core.roots import node_count, nodes


def gain_forms(rows: Array, factor: Array, weighted: Array, variance: float | Array) -> tuple[Array, Array]:
    """Return N = gᵀCWCg and D = σ² + gᵀCg, each (m,).

    rows : (m, n), the g; factor : (n, r), F with C = F Fᵀ; weighted : (w, r), W^½ F; variance : σ², scalar or (m,)
    """
    along = rows @ factor
    return np.sum((along @ weighted.T) ** 2, axis=1), variance + np.sum(along**2, axis=1)


def apart_from_series(
    observation: Observation, axis: int, pose: Array, approach: Array, factor: Array, weighted: Array
) -> float:
    """Return how far N and D of the first set-up are from their Chebyshev series between two breaks, over the largest.

    pose, approach : (q,), of the other axes; factor, weighted : as of `gain_forms`
    """
    count, inside, worst = node_count(*smoothness_along(observation, axis, 0)), np.linspace(-0.999, 0.999, 21), 0.0
    for left, right in pairwise(breaks_along(observation, axis, 0)):
        at = np.tile(pose, (count + len(inside), 1))
        at[:, axis] = left + (right - left) * (1 + np.concatenate([nodes(count), inside])) / 2
        seen = observation.rows(0, at, np.tile(approach, (len(at), 1)))
        for form in gain_forms(seen.rows, factor, weighted, seen.variances):
            series = chebval(inside, chebfit(nodes(count), form[:count], count - 1))
            worst = max(worst, float(np.abs(series - form[count:]).max() / np.abs(form).max()))
    return worst


def gains_of(scorer: Scorer, lattice: Places) -> Array:
    """Return the gain of every candidate, (m,)."""
    result = np.empty(len(lattice))
    for setup in np.unique(lattice.setups).tolist():
        result[lattice.setups == setup] = scorer.gains_at(setup, *lattice.in_setup(setup))
    return result
