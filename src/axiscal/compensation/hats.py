"""Piecewise linear functions on given points, and the one nearest to a curve in the least-squares sense.

A control that interpolates does not show the curve at the points but the line between them. Values taken from the
curve itself lie on one side of every bend; the least-squares values spread what is left evenly to both sides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array
from axiscal.numerics.quadrature import gauss

_CUBIC = np.linalg.pinv(np.vander(np.polynomial.legendre.leggauss(5)[0], 4, increasing=True))
"""Mathematics: from the values at five points of Gauss to the cubic's coefficients."""
_NODES = np.polynomial.legendre.leggauss(5)[0]
"""Mathematics."""
_OUTSIDE = 1e-6
"""Weight of what lies outside, so that every hat has a value: small against 1, or it would pull at the inside."""


@dataclass(frozen=True, eq=False, slots=True)
class Hats:
    """Hat functions on `points`, with a quadrature that is exact for them times any spline on `knots`.

    nodes : (5 n,) and weights, five in every stretch between two breaks, weighing little outside `bounds`
    closed : the last point is the first one of the next turn
    """

    points: Array
    nodes: Array
    weights: Array
    closed: bool

    @classmethod
    def on(cls, points: Array, knots: Array, bounds: tuple[float, float], closed: bool = False) -> Hats:
        """Return the hats on points (n,) increasing; knots : where the curve has its breaks."""
        breaks = np.unique(np.concatenate([points, knots, bounds]))
        breaks = breaks[(breaks >= points[0]) & (breaks <= points[-1])]
        breaks = breaks[np.r_[True, np.diff(breaks) > 1e-12 * (points[-1] - points[0])]]
        nodes, weights = gauss(breaks, 5)
        middle = nodes[:, 2]
        inside = (middle > bounds[0]) & (middle < bounds[1])
        share = np.where(inside, 1.0, _OUTSIDE if inside.any() else 1.0)
        return cls(points, nodes.ravel(), (share[:, None] * weights).ravel(), closed)

    def best(self) -> Array:
        """Return the map (points, nodes) from a curve at the nodes to the best values at the points."""
        shape = self._shape()
        weighted = shape * self.weights[:, None]
        scale = 1 / np.sqrt(np.sum(weighted * shape, axis=0))
        normal = (scale[:, None] * (shape.T @ weighted)) * scale
        values = scale[:, None] * np.linalg.solve(normal, scale[:, None] * weighted.T)
        return np.vstack([values, values[:1]]) if self.closed else values

    def carried(self, at: Array) -> Array:
        """Return the map (len(at), nodes) from a curve at the nodes to it elsewhere: one cubic on every stretch."""
        nodes = self.nodes.reshape(-1, 5)
        half = (nodes[:, 4] - nodes[:, 0]) / (_NODES[4] - _NODES[0])
        stretch = np.clip(np.searchsorted(nodes[:, 2] + half, at), 0, len(nodes) - 1)
        share = (at - nodes[stretch, 2]) / half[stretch]
        result = np.zeros((len(at), len(self.nodes)))
        columns = 5 * stretch[:, None] + np.arange(5)
        np.put_along_axis(result, columns, np.vander(share, 4, increasing=True) @ _CUBIC, axis=1)
        return result

    def departure(self, curve: Array, values: Array) -> float:
        """Return the largest distance within the bounds between a piecewise cubic and the line through values.

        curve : (nodes,) the cubic at the nodes; values : (points,)
        On each stretch the difference is one cubic, known from its five nodes; it is largest at an end or where its
        slope, a quadratic, vanishes.
        """
        within = self.weights.reshape(-1, 5)[:, 2]
        apart = (curve - np.interp(self.nodes, self.points, values)).reshape(-1, 5)
        kept = apart[within >= 0.5 * np.max(within) * _least(within)]
        return float(np.max(np.abs(_extremes(kept @ _CUBIC.T))))

    def _shape(self) -> Array:
        shape = np.array([np.interp(self.nodes, self.points, unit) for unit in np.eye(len(self.points))]).T
        if not self.closed:
            return shape
        shape[:, 0] += shape[:, -1]
        return shape[:, :-1]


def _least(within: Array) -> float:
    """Stretches outside the bounds weigh a millionth; anything above a thousandth of the widest is inside."""
    return 1e-3 if np.min(within) < 1e-3 * np.max(within) else 0.0


def _extremes(cubics: Array) -> Array:
    """Return the values of cubics on [-1, 1] where they can be largest, (n, 4).  cubics : (n, 4), rising powers."""
    a, b, c = cubics[:, 1], 2 * cubics[:, 2], 3 * cubics[:, 3]
    root = np.sqrt(np.maximum(b * b - 4 * a * c, 0.0))
    q = -(b + np.where(b < 0, -root, root)) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        turns = np.stack([q / c, a / q], axis=1)
    turns = np.where(np.isfinite(turns) & (np.abs(turns) <= 1), turns, 1.0)
    at = np.hstack([turns, -np.ones((len(cubics), 1)), np.ones((len(cubics), 1))])
    values: Array = np.einsum("nk,nmk->nm", cubics, at[:, :, None] ** np.arange(4))
    return values
