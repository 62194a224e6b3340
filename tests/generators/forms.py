"""Gains of readings, from their rows and from a scorer."""

from __future__ import annotations

import numpy as np

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.gains.gain import Scorer


def gain_forms(rows: Array, factor: Array, weighted: Array, variance: float | Array) -> tuple[Array, Array]:
    """Return N = gᵀCWCg and D = σ² + gᵀCg, each (m,).

    rows : (m, n), the g; factor : (n, r), F with C = F Fᵀ; weighted : (w, r), W^½ F; variance : σ², scalar or (m,)
    """
    along = rows @ factor
    return np.sum((along @ weighted.T) ** 2, axis=1), variance + np.sum(along**2, axis=1)


def gains_of(scorer: Scorer, lattice: Places) -> Array:
    """Return the gain of every candidate, (m,)."""
    result = np.empty(len(lattice))
    for setup in np.unique(lattice.setups).tolist():
        result[lattice.setups == setup] = scorer.gains_at(setup, *lattice.in_setup(setup))
    return result
