"""Functions of one or two coordinates that are sums of waves, or polynomials, known exactly from a few samples.

On a full turn with harmonics up to K, 2 K + 1 even samples give every coefficient. On a stretch K + 1 Chebyshev nodes
give a polynomial of degree K. Derivatives then follow term by term, and none is larger than the sum of the terms' own.
Those of cos kx and sin kx are up to k, k², k³. Those of T_k are up to k², k² (k² − 1)/3, k² (k² − 1)(k² − 4)/15 (V. A.
Markov 1892).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.numerics import Array

_MOST = {1: 8, 2: 4}
"""Harmonics, or degree, by number of coordinates: rows have four at most, eight where an axis turns in step."""


class Span(NamedTuple):
    """One coordinate.  around : a full turn of 2π comes back to the same values"""

    low: float
    high: float
    around: bool

    def nodes(self, most: int) -> Array:
        """Return where samples determine everything."""
        if self.around:
            turned: Array = self.low + 2 * np.pi / (2 * most + 1) * np.arange(2 * most + 1.0)
            return turned
        inner: Array = np.cos(np.pi * (np.arange(most + 1) + 0.5) / (most + 1))
        return self.low + (self.high - self.low) * (1 + inner) / 2

    def basis(self, most: int, values: Array, order: int = 0) -> Array:
        """Return the terms, or their derivatives of an order, at values (m,), (m, terms)."""
        if self.around:
            k = np.arange(1.0, most + 1)
            angle = np.outer(values, k) + order * np.pi / 2  # a derivative is a quarter turn ahead
            constant = np.full((len(values), 1), float(order == 0))
            return np.concatenate([constant, k**order * np.cos(angle), k**order * np.sin(angle)], axis=1)
        scale = 2 / (self.high - self.low)
        at = (values - self.low) * scale - 1
        terms = [np.polynomial.chebyshev.chebder(row, order) for row in np.eye(most + 1)]
        values_of: Array = np.stack([np.polynomial.chebyshev.chebval(at, term) for term in terms], axis=1)
        return scale**order * values_of

    def largest(self, most: int, order: int) -> Array:
        """Return how large each term, or its derivative of order 1 to 3, can be, (terms,)."""
        if self.around:
            k = np.arange(1.0, most + 1)
            return np.concatenate([[float(order == 0)], k**order, k**order])
        k, scale = np.arange(most + 1.0), 2 / (self.high - self.low)
        sizes = np.ones(most + 1)
        for step in range(order):
            sizes = sizes * (k**2 - step**2) / (2 * step + 1)
        return scale**order * np.abs(sizes)


@dataclass(frozen=True, eq=False, slots=True)
class Waves:
    """Many functions at once.  coefficients : (functions, terms), those of the last coordinate next to each other"""

    spans: tuple[Span, ...]
    coefficients: Array

    @classmethod
    def of(cls, function: Callable[[Array], Array], spans: Sequence[Span]) -> Waves:
        """Return the functions from their samples, exact where they are such sums.

        function : places (m, coordinates) -> values (functions, m)
        """
        most = _MOST[len(spans)]
        nodes = [span.nodes(most) for span in spans]
        grid = np.stack([g.ravel() for g in np.meshgrid(*nodes, indexing="ij")], axis=1)
        values = function(grid)
        inverse = np.ones((1, 1))
        for span, at in zip(spans, nodes, strict=True):
            inverse = np.kron(inverse, np.linalg.inv(span.basis(most, at)))
        return cls(tuple(spans), values @ inverse.T)

    def at(self, places: Array, *along: int) -> Array:
        """Return the values, or the derivatives along some coordinates, at places (m, coordinates): (functions, m)."""
        most, terms = _MOST[len(self.spans)], np.ones((len(places), 1))
        for number, (span, values) in enumerate(zip(self.spans, places.T, strict=True)):
            own = span.basis(most, values, along.count(number))
            terms = (terms[:, :, None] * own[:, None, :]).reshape(len(places), -1)
        derivatives: Array = self.coefficients @ terms.T
        return derivatives

    def most(self, *along: int) -> Array:
        """Return how large the derivative along some coordinates can be anywhere, (functions,)."""
        most = _MOST[len(self.spans)]
        terms: Array = np.ones(1)
        for number, span in enumerate(self.spans):
            terms = np.outer(terms, span.largest(most, along.count(number))).ravel()
        sizes: Array = np.abs(self.coefficients) @ terms
        return sizes
