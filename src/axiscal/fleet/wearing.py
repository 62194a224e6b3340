"""What wears off between two campaigns: of a machine whose type is known what is its own, else all that is stated.

An error a = μ + d keeps what all sisters have, μ ~ N(m̄, S), and the share ρ of its own, d, the rest of which comes
anew from N(0, C₀). Of what a campaign knew, N(m, C), there is then, what links a and μ after the readings left out,

    N(ρ m + (1 − ρ) m̄,  ρ² C + (1 − ρ²) C₀ + (1 − ρ)² S)

Where no type is known m̄ = 0, S = 0 and C₀ is as stated.
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from axiscal.error_model.model import ErrorModel
from axiscal.estimation.case import Inherited
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.type_prior import TypePrior, individual, is_type_text, over, type_prior
from axiscal.fleet.sister_records import other_machine
from axiscal.numerics import Array

_SISTER = 0.5
"""A machine that is less probably one of its type ages as stated."""


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

    def left_of(self, found: Inherited, kept: float) -> Inherited:
        """Return what there is of what a campaign knew.  kept : ρ"""
        mean = kept * found.mean + (1 - kept) * self.mean
        new = (1 - kept**2) * self.own + (1 - kept) ** 2 * self.common
        return Inherited(mean, kept**2 * found.covariance + new)
