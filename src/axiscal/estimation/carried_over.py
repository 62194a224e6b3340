"""A belief over the errors of one description, read as one over those of another: curves at the knots of today's."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.estimation.promise.problem import Inherited
from axiscal.numerics import Array
from axiscal_core.machine import Machine

_ALIKE = 1e-9
"""Of the whole: what is less is rounding."""


class Across(NamedTuple):
    """errors : of today; matrix : (size, before) from the unknowns of before to those of today

    rests : (size,) variances that the rests of before give them; known : the names of errors that both have
    """

    errors: Machine
    matrix: Array
    rests: Array
    known: frozenset[str]

    def beyond(self) -> Array:
        """Return S (size, k): S Sᵀ is what today's prior holds of common errors and the other description cannot.

        With P = M M⁺ the part of the coefficients that the other knots reach, S = (I − P) L for C₀ = L Lᵀ.
        """
        root, parts = self.errors.root(), [np.zeros((self.errors.size, 0))]
        for term in self.errors.terms:
            own, held = root[term.columns, term.columns], self.matrix[term.columns]
            left = own - held @ np.linalg.pinv(held, rcond=_ALIKE) @ own
            if term.name in self.known and np.linalg.norm(left) > _ALIKE * np.linalg.norm(own):
                part = np.zeros((self.errors.size, left.shape[1]))
                part[term.columns] = left
                parts.append(part)
        return np.hstack(parts)

    def prior(self, mean: Array, covariance: Array, extra: Array) -> Inherited:
        """Return a belief over today's errors; those that are new are as their prior states.

        mean : (k,); covariance : (k, k); extra : (n, n) covariance to add
        """
        result: Array = self.matrix @ covariance @ self.matrix.T + extra
        for term in self.errors.terms:
            if term.name not in self.known:
                result[term.columns, term.columns] = term.covariance
        return Inherited(self.matrix @ mean, result)


def carried_over(before: Machine, errors: Machine) -> Across:
    """Return how a belief over the errors of one model becomes one over those of another."""
    matrix, rests = np.zeros((errors.size, before.size)), np.zeros(errors.size)
    others = {term.name: term for term in before.terms}
    both = [(term, others[term.name]) for term in errors.terms if term.name in others]
    for term, other in both:
        matrix[term.columns, other.columns] = term.taken_from(other)
        rests[term.columns] = term.loosened(other.rest)
    return Across(errors, matrix, rests, frozenset(term.name for term, _ in both))
