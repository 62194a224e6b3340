"""The splines as a kernel, for libraries that plan readings of a Gaussian process.

A sum of splines with C0 = I is the process with k(s, t) = f(s)ᵀ f(t), f the splines' rows; so a library with this
kernel solves exactly the same problem. J is an integral of variances, so the sum of those at a few quadrature nodes
with their weights (`nodes_root`), which is exact here. These libraries average over places with equal weights and know
nothing of a single axis; so each weighted node stands in as a place beyond the travel. One more place sees nothing at
all: a library that must have a first reading is given that one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.peers import evaluator
from benchmarks.peers.problems import TRAVEL, Array, Posed


@dataclass(frozen=True, eq=False, slots=True)
class Features:
    """Piecewise cubics with pieces of one width.

    coefficients : (q, pieces, 4, knots), highest power first, in the distance from the start of the piece
    places : (w, q) whose variances add up to J; nothing : (1, q) a place that sees nothing; reach : their end
    """

    width: float
    coefficients: Array
    places: Array
    nothing: Array
    reach: float

    @classmethod
    def of(cls, posed: Posed, fewest: bool = False) -> Features:
        """Return the features of a problem, with quadrature nodes as places, or the fewest places that are exact."""
        case = posed.case
        root = evaluator.weight_root(posed) if fewest else evaluator.nodes_root(posed)
        width = TRAVEL / (case.knots - 1)
        beyond = np.concatenate([root, np.zeros((1, case.size))]).reshape(len(root) + 1, case.axes, case.knots)
        inside = np.moveaxis(evaluator.spline(case).c, 0, 1)
        pieces = np.zeros((case.axes, case.knots + len(beyond), 4, case.knots))
        pieces[:, : case.knots - 1] = inside
        pieces[:, case.knots - 1] = _continued(inside[-1], width)
        pieces[:, case.knots :, 3] = np.moveaxis(beyond, 1, 0)
        middles = width * (case.knots + 0.5 + np.arange(len(beyond)))
        places = np.repeat(middles[:, None], case.axes, axis=1)
        return cls(width, pieces, places[:-1], places[-1:], float(middles[-1] + width))

    def __call__(self, positions: Array) -> Array:
        """Return the rows at positions (m, q), (m, size)."""
        piece = np.floor(positions / self.width).astype(np.intp)
        u = (positions - piece * self.width)[:, :, None]
        cubic = self.coefficients[np.arange(positions.shape[1]), piece]
        found = ((cubic[:, :, 0] * u + cubic[:, :, 1]) * u + cubic[:, :, 2]) * u + cubic[:, :, 3]
        return np.asarray(found.reshape(len(positions), -1), dtype=np.float64)


def _continued(cubic: Array, width: float) -> Array:
    """Return a cubic (4, knots) with its powers taken from the end of its piece, for the very end of the travel."""
    a, b, c, d = cubic
    return np.stack(
        [a, 3 * a * width + b, (3 * a * width + 2 * b) * width + c, ((a * width + b) * width + c) * width + d]
    )
