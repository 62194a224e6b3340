"""What wears off between two campaigns: of a machine whose type is known what is its own, else all that is stated.

An error a = μ + d keeps what all sisters have, μ ~ N(m̄, S), and a share of its own, d ~ N(0, C₀), the rest of which
comes anew: with K = diag(κ), κ = ρ of what ages and 0 of what was renewed,

    a' = K a + (I − K) μ + ε,    ε ~ N(0, (1 − ρ²) C₀) among what ages, N(0, C₀) among what is new

A campaign that knew a ~ N(m, C) says by G = S (S + C₀)⁻¹ what all sisters have, too:

    μ ~ N(m̃, M),    m̃ = m̄ + G (m − m̄),    M = S − G (S + C₀ − C) Gᵀ,    cov(a, μ) = C Gᵀ

so that a' has the mean m̃ + K (m − m̃), and what is not renewed and what is have parts of S in common. Where no type is
known m̄ = 0, S = 0 and C₀ is as stated.
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.model import ErrorModel
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.type_prior import TypePrior, individual, is_type_text, over, type_prior
from axiscal.fleet.sister_records import other_machine
from axiscal.numerics import Array
from axiscal.promise.problem import Inherited

_SISTER = 0.5
"""A machine that is less probably one of its type ages as stated."""
_NOTHING = 1e-10
"""A direction of so small a share of the variance is rounding: nothing is said of it."""


class Worn(NamedTuple):
    """What a campaign knew, taken apart into what stays and what wears off.

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
    def of(cls, known: Estimation, taught: TypePrior | None = None) -> Self:
        """Return that of a machine that was measured by what its type has taught, or is of the type `taught`."""
        errors, text = known.case.errors, known.stated.description.prior_text
        found = type_prior(text) if is_type_text(text) else taught
        if found is None or other_machine(errors.machine, found.machine):
            return cls.as_stated(errors)
        if known.membership is not None and known.membership.sister < _SISTER:
            return cls.as_stated(errors)
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
    size, belief = known.case.errors.size, known.banded.knowledge.belief
    factor = belief.factor[:size]
    return Inherited(belief.mean[:size], factor @ factor.T)
