"""Errors that wear off between two campaigns: the machine's own part if its type is known, else all that is stated.

An error is a = μ + d, where μ ~ N(m̄, S) is the part of all sisters and d ~ N(0, C₀) is the machine's. It keeps μ and a
share of d. The rest of d comes anew. With K = diag(κ), κ = ρ of errors that age and 0 of renewed ones,

    a' = K a + (I − K) μ + ε,    ε ~ N(0, (1 − ρ²) C₀) among what ages, N(0, C₀) among what is new

A campaign that knew a ~ N(m, C) says by G = S (S + C₀)⁻¹ what all sisters have, too:

    μ ~ N(m̃, M),    m̃ = m̄ + G (m − m̄),    M = S − G (S + C₀ − C) Gᵀ,    cov(a, μ) = C Gᵀ

so that a' has the mean m̃ + K (m − m̃). Renewed errors and others have parts of S in common. Without a known type
m̄ = 0, S = 0 and C₀ is as stated.

How much of what a campaign found is left after a time: learnt from machines that were measured again.

Each error keeps ρ(Δt) = ρ₁ y^Δt, Δt in years: set-ups and warm-ups at once leave ρ₁ < 1, a year leaves y. A second
campaign with the data equation z₂ is as probable as

    p(z₂ | ρ m₁, ρ² C₁ + (1 − ρ²) C₀)

with m₁, C₁ after the first one and C₀ as stated. A known type changes both moments (`wearing`). The prior is
ρ₁, y ~ Beta(9, 1); averages are over a grid, weighted by it and the product over pairs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.model import ErrorModel
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inference.data_equation import DataEquation, log_evidence
from axiscal.estimation.promise.problem import Inherited
from axiscal.estimation.type_prior import individual, is_type_text, over, type_prior
from axiscal.numerics import Array

YEAR = 365.25 * 86400.0
"""s."""
_GRID = np.arange(0.505, 1.0, 0.01)
"""Places for ρ₁ and for y: half a percent off is nothing."""
_KEPT = 9.0
"""Of the Beta(9, 1): nine tenths are kept as a rule, as where a campaign says nothing else."""

_SISTER = 0.5
"""A machine that is less probably one of its type ages as stated."""
_NOTHING = 1e-10
"""A direction of so small a share of the variance is rounding: nothing is said of it."""


class Worn(NamedTuple):
    """Knowledge of a campaign, in a part that stays and one that wears off.

    found : N(m, C); stays : N(m̃, M); link : (n, n) cov(a, μ); own : (n, n) C₀
    """

    found: Inherited
    stays: Inherited
    link: Array
    own: Array

    def covariance(self, rho: float, square: float, renewed: NDArray[np.bool_]) -> Array:
        """Return that of a' where ρ is certain, averaged over ρ.

        rho, square : the means of ρ and ρ²; renewed : (n,) bool
        """
        ages = (~renewed).astype(float)
        both = square * np.outer(ages, ages)
        one = rho * ages[:, None] - both
        none = 1 - rho * (ages[:, None] + ages) + both
        linked = one * self.link
        new = (1 - square) * np.outer(ages, ages) + np.outer(renewed, renewed)
        found = both * self.found.covariance + linked + linked.T + none * self.stays.covariance + new * self.own
        return np.asarray(found)

    def left(self, rho: float, square: float | None = None, renewed: NDArray[np.bool_] | None = None) -> Inherited:
        """Return what there is of it.

        rho, square : the means of ρ and ρ², which is ρ² where nobody says; renewed : (n,) bool, nothing where not said
        """
        mean_square = rho**2 if square is None else square
        new = np.zeros(len(self.found.mean), dtype=bool) if renewed is None else renewed
        moving = (self.found.mean - self.stays.mean) * ~new
        scattered = (mean_square - rho**2) * np.outer(moving, moving)
        return Inherited(self.stays.mean + rho * moving, self.covariance(rho, mean_square, new) + scattered)


class Wearing(NamedTuple):
    """mean : (n,) m̄; own : (n, n) C₀, what wears off; common : (n, n) S, how little is known of what stays"""

    mean: Array
    own: Array
    common: Array

    @classmethod
    def as_stated(cls, errors: ErrorModel) -> Self:
        """Return that of a machine of no known type: all wears off."""
        return cls(np.zeros(errors.size), errors.prior_covariance(), np.zeros((errors.size, errors.size)))

    @classmethod
    def of(cls, known: Estimation) -> Self:
        """Return that of a machine, by what its type has taught where it was measured by that."""
        errors, text = known.case.errors, known.stated.description.prior_text
        if not is_type_text(text):
            return cls.as_stated(errors)
        if known.membership is not None and known.membership.sister < _SISTER:
            return cls.as_stated(errors)
        found = type_prior(text)
        mean, covariance = over(found, errors)
        own = individual(found, errors)
        return cls(mean, own, covariance - own)

    def worn(self, found: Inherited) -> Worn:
        """Return what a campaign knew, taken apart."""
        if not np.any(self.common):
            nothing = np.zeros_like(self.common)
            return Worn(found, Inherited(self.mean, nothing), nothing, self.own)
        whole = self.common + self.own
        gain = self.common @ _inverse(whole)
        stays = self.common - gain @ (whole - found.covariance) @ gain.T
        mean = self.mean + gain @ (found.mean - self.mean)
        return Worn(found, Inherited(mean, (stays + stays.T) / 2), found.covariance @ gain.T, self.own)


def _inverse(covariance: Array) -> Array:
    """Return the inverse of a covariance where it says something: unknowns are metres and radians."""
    std = np.sqrt(np.diagonal(covariance))
    scale = np.where(std > 0, std, 1.0)
    values, vectors = np.linalg.eigh(covariance / scale[:, None] / scale)
    kept = values > _NOTHING * values[-1]
    roots = vectors[:, kept] / np.sqrt(values[kept]) / scale[:, None]
    inverse: Array = roots @ roots.T
    return inverse


def found_by(known: Estimation) -> Inherited:
    """Return what a campaign knows of the errors of its machine."""
    size, belief = known.case.errors.size, known.printed.belief
    factor = belief.factor[:size]
    return Inherited(belief.mean[:size], factor @ factor.T)


class Pair(NamedTuple):
    """Two campaigns of one machine: years between them, what the first knew, what the second one read, what wears."""

    years: float
    first: Inherited
    second: DataEquation
    wears: Wearing


class Aging(NamedTuple):
    """How probable each ρ₁ (first index) and y is, (g, g), sum 1; pairs : that it was learnt from"""

    weights: Array
    pairs: int

    def shares(self, years: float) -> Array:
        """Return ρ after a time in each cell of the grid, (g, g)."""
        shares: Array = _GRID[:, None] * _GRID**years
        return shares

    def kept(self, years: float) -> tuple[float, float]:
        """Return the means of ρ and of ρ² after a time."""
        rho = self.shares(years)
        return float(np.sum(self.weights * rho)), float(np.sum(self.weights * rho**2))

    @property
    def at_once(self) -> tuple[float, float]:
        """Mean and std of ρ₁."""
        return _moments(self.weights.sum(axis=1))

    @property
    def yearly(self) -> tuple[float, float]:
        """Mean and std of y."""
        return _moments(self.weights.sum(axis=0))


def _moments(weights: Array) -> tuple[float, float]:
    mean = float(weights @ _GRID)
    return mean, float(np.sqrt(weights @ (_GRID - mean) ** 2))


def aging(pairs: Sequence[Pair]) -> Aging:
    """Return what machines that were measured again say; without any, what is believed beforehand."""
    logs = (_KEPT - 1) * (np.log(_GRID)[:, None] + np.log(_GRID))
    for pair in pairs:
        rho = _GRID[:, None] * _GRID**pair.years
        # one evidence for each distinct share, to a thousandth: the grid's products lie denser than that
        shares = np.round(rho, 3)
        worn = pair.wears.worn(pair.first)
        found = {share: log_evidence(pair.second, worn.left(share)) for share in np.unique(shares).tolist()}
        logs = logs + np.vectorize(found.__getitem__)(shares)
    weights = np.exp(logs - logs.max())
    return Aging(weights / weights.sum(), len(pairs))
