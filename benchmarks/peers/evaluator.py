"""One evaluator of J for all, from positions alone: SciPy's splines, Gauss's quadrature, a plain inverse.

It shares nothing with axiscal, so that neither side judges itself.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.peers.problems import TRAVEL, Array, CriterionName, Posed, Stacked


def spline(case: Stacked) -> CubicSpline:
    """Return the unit splines of one axis: at t it gives the (knots,) values that weigh the control values."""
    return CubicSpline(np.linspace(0.0, TRAVEL, case.knots), np.eye(case.knots), bc_type="natural")


def rows(case: Stacked, positions: Array) -> Array:
    """Return what readings at positions (m, q) see of the control values, (m, size)."""
    unit = spline(case)
    return np.concatenate([unit(positions[:, axis]) for axis in range(case.axes)], axis=1)


def weight(case: Stacked, criterion: CriterionName) -> Array:
    """Return W of J = tr(W C), (size, size); four Gauss nodes an interval are exact for splines squared."""
    nodes, shares = _quadrature(case)
    seen = spline(case)(nodes)
    gram, mean = seen.T @ (shares[:, None] * seen), shares @ seen / TRAVEL
    if criterion == "joint":
        return np.asarray(np.kron(np.eye(case.axes), gram), dtype=np.float64)
    apart = 1.0 - np.eye(case.axes)
    return np.kron(np.eye(case.axes), gram / TRAVEL) + np.kron(apart, np.outer(mean, mean))


def _quadrature(case: Stacked) -> tuple[Array, Array]:
    places, shares = np.polynomial.legendre.leggauss(4)
    width = TRAVEL / (case.knots - 1)
    starts = width * np.arange(case.knots - 1)
    nodes = starts[:, None] + width * (places + 1.0) / 2.0
    return nodes.ravel(), np.tile(width * shares / 2.0, case.knots - 1)


def weight_root(posed: Posed) -> Array:
    """Return V (w, size) with W = VᵀV: the fewest linear forms whose variances add up to J."""
    values, vectors = np.linalg.eigh(weight(posed.case, posed.criterion))
    kept = values > 1e-12 * values[-1]
    root: Array = (vectors[:, kept] * np.sqrt(values[kept])).T
    return root


def nodes_root(posed: Posed) -> Array:
    """Return V (w, size) with W = VᵀV, one linear form for each quadrature node of each axis.

    `volume`: the variance of a sum is that of its parts about their means, and of the sum of the means.
    """
    case, (nodes, shares) = posed.case, _quadrature(posed.case)
    seen = spline(case)(nodes)
    if posed.criterion == "joint":
        return np.asarray(np.kron(np.eye(case.axes), np.sqrt(shares)[:, None] * seen), dtype=np.float64)
    mean = shares @ seen / TRAVEL
    about = np.sqrt(shares / TRAVEL)[:, None] * (seen - mean)
    return np.concatenate([np.kron(np.eye(case.axes), about), np.tile(mean, case.axes)[None]])


def covariance(case: Stacked, positions: Array) -> Array:
    """Return C after readings at positions (m, q), in information form."""
    seen = rows(case, positions)
    inverse = np.linalg.inv(np.eye(case.size) + seen.T @ seen / case.noise**2)
    return np.asarray((inverse + inverse.T) / 2.0, dtype=np.float64)


def value(posed: Posed, positions: Array) -> float:
    """Return J after readings at positions (m, q)."""
    return float(np.sum(weight(posed.case, posed.criterion) * covariance(posed.case, positions)))


def gain(posed: Posed, taken: Array, position: Array) -> float:
    """Return by how much one more reading at position (q,) lowers J after those taken (m, q)."""
    before = covariance(posed.case, taken)
    row = rows(posed.case, position[None])[0]
    carried = before @ row
    lowered = carried @ weight(posed.case, posed.criterion) @ carried
    return float(lowered / (posed.case.noise**2 + row @ carried))
