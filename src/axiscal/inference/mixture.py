"""All scales that the readings leave possible, each with its weight: draws about the most probable ones.

A band made at one set of scales is too narrow where the readings hardly tell the scales. So they are averaged over
(Rue, Martino and Chopin 2009): draws θ_l from a multivariate t about the most probable logarithms θ̂, its shape the
inverse curvature H of minus the log posterior there (Laplace), weights w_l ∝ p(θ_l | y) / q(θ_l). It has as many
degrees of freedom as there are scales, six at the least: with six and dozens of scales the factor that all parts of a
draw share, 0.7 to 1.7, alone left a few of them. A curvature counts as no flatter than the scales' own prior.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array

_FREEDOM = 6
"""At the least: tails heavier than a normal's, so that no scale is proposed too seldom; the weights make any proposal
right."""
_SEED = 48
"""Any seed: an estimate is to be the same every time."""
_FEWEST, _MOST, _NUMBERS = 48, 192, 12_000
"""Draws: as many as time allows; how many of them count is looked at, and said where they are too few."""
POOR = 5.0
"""Fewer draws' worth than this are doubled, once."""
_NOTHING = 1e-3
"""Weight of a draw that counts for nothing."""


@dataclass(frozen=True, eq=False, slots=True)
class Mixture:
    """Draws of the logarithms of the scales' factors.

    logs : (l, n), the first one the most probable; weights : (l,), sum 1
    whole : log ∫ of the density
    """

    logs: Array
    weights: Array
    whole: float = 0.0

    @property
    def size(self) -> float:
        """How many equally good draws they are worth: 1/Σw² (ESS)."""
        return float(1.0 / np.sum(self.weights**2))

    def parts(self) -> Iterator[tuple[Array, float]]:
        """Yield the draws that count with their weights, which sum to 1."""
        logs, weights = self.kept()
        yield from zip(logs, weights.tolist(), strict=True)

    def kept(self) -> tuple[Array, Array]:
        """Return them at once, (k, n) and (k,)."""
        counts = self.weights > _NOTHING
        return self.logs[counts], self.weights[counts] / self.weights[counts].sum()

    def mean_square(self, index: int) -> float:
        """Return the mean square of the factor of one scale."""
        return float(sum(weight * np.exp(2 * logs[index]) for logs, weight in self.parts()))


def mixture(density: Callable[[Array], float], best: Array, curvature: Array, prior: Array, numbers: int) -> Mixture:
    """Return draws about the most probable logarithms.

    density : log p(θ | y) up to a constant; best : (n,) θ̂; curvature : (n, n) H; prior : (n, n) precision of the prior
    numbers : of the readings: the more, the costlier a draw
    """
    root = _root(curvature, prior)
    count = int(np.clip(_NUMBERS // max(numbers, 1), _FEWEST, _MOST))
    found = _drawn(density, best, root, count)
    return found if found.size >= POOR else _drawn(density, best, root, 2 * count)


def _drawn(density: Callable[[Array], float], best: Array, root: Array, count: int) -> Mixture:
    rng, size, freedom = np.random.default_rng(_SEED), len(best), max(_FREEDOM, len(best))
    draws = rng.standard_normal((count, size)) * np.sqrt(freedom / rng.chisquare(freedom, (count, 1)))
    draws[0] = 0.0
    logs = best + draws @ root.T
    proposed = -(freedom + size) / 2 * np.log1p(np.sum(draws**2, axis=1) / freedom)
    ratios = np.array([density(each) for each in logs]) - proposed
    weights = np.exp(ratios - ratios.max())
    volume = math.lgamma(freedom / 2) - math.lgamma((freedom + size) / 2) + size / 2 * math.log(freedom * math.pi)
    whole = float(ratios.max() + np.log(np.mean(weights)) + np.linalg.slogdet(root)[1]) + volume
    return Mixture(logs, weights / weights.sum(), whole)


def _root(curvature: Array, prior: Array) -> Array:
    """Return R with R Rᵀ the inverse of the curvature, where that is no flatter than the prior, (n, n).

    The symmetric one in units of the prior: columns along the directions of the curvature would change their sign, or
    turn where two of them curve alike, by the last digit of a curvature, and with them every draw.
    """
    whitening = np.linalg.inv(np.linalg.cholesky(prior))
    values, vectors = np.linalg.eigh(whitening @ curvature @ whitening.T)
    root: Array = whitening.T @ (vectors / np.sqrt(np.maximum(values, 1.0))) @ vectors.T
    return root
