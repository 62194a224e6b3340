"""The prior of a machine from machines of its type.

The prior is a mixture of beliefs, so that a stranger is noticed and its band still covers. Without those of one axis a
machine after a crash is a stranger as a whole, and needs as many readings as one. With d the doubt that this machine is
a sister at all, the weights are:
- type: 1 − d; the same with six times its covariance: 0.3 d
- a sister with one axis hit or renewed, its errors off by what is stated besides: 0.3 d, as much for each axis
- stated prior in the sizes that were learnt: 0.2 d; stated prior twice as wide: 0.2 d

A belief over the errors of one description is read as one over those of another: curves at the knots of today's.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.description.type_text import TypePrior
from axiscal.errors.model import ErrorModel
from axiscal.estimation.case import Rival
from axiscal.estimation.promise.problem import Inherited
from axiscal.numerics import Array

LOOSE, WIDE = 6.0, 4.0
"""Factors on variances of the second and the last belief: two beliefs between the type and anything at all."""
_DOUBTS = (0.3, 0.3, 0.2, 0.2)
"""Shares of the doubt; any near would do: the readings decide within a few of them."""
SISTER = "like its sisters"
_LOOSE = "like its sisters, and 2.4 times as far from them"
_SIZED, _WIDE = "as stated, in the sizes of its type", "as stated, and up to twice as large"


def rivals(found: TypePrior, errors: ErrorModel, doubt: float | None = None) -> tuple[Rival, ...]:
    """Return the beliefs of a machine that may be of a type, side by side; errors that it did not have are as stated.

    errors : of the machine, whose curves may have other knots; doubt : instead of the type's own
    """
    doubted = found.doubt if doubt is None else doubt
    prior = over(found, errors)
    stated = errors.prior_covariance()
    sized = stated.copy()
    for term in errors.terms:
        if term.name in found.learned:
            sized[term.columns, term.columns] *= found.learned[term.name].scale
    zero, axes = np.zeros(errors.size), errors.machine.axes
    loose, one, known, wide = (doubted * share for share in _DOUBTS)
    return (
        Rival(SISTER, 1 - doubted, prior),
        Rival(_LOOSE, loose, Inherited(prior.mean, LOOSE * prior.covariance)),
        *(
            Rival(f"like its sisters but for {axis.name}", one / len(axes), _changed(prior, errors, index))
            for index, axis in enumerate(axes)
        ),
        Rival(_SIZED, known, Inherited(zero, sized)),
        Rival(_WIDE, wide, Inherited(zero, WIDE * stated)),
    )


def _changed(prior: Inherited, errors: ErrorModel, axis: int) -> Inherited:
    """Return the belief of a sister of which one axis was hit or renewed: its errors are off by what is stated."""
    covariance = prior.covariance.copy()
    for term in errors.terms:
        if axis in term.axes:
            covariance[term.columns, term.columns] += term.covariance
    return Inherited(prior.mean, covariance)


def over(found: TypePrior, errors: ErrorModel) -> Inherited:
    """Return mean and covariance over the errors of a machine.

    Details that its knots resolve and those of the type do not are as stated, in the sizes of the type.
    """
    across = carried_over(ErrorModel(found.machine), errors)
    beyond = across.beyond()
    for term in errors.terms:
        if term.name in found.learned:
            beyond[term.columns] *= np.sqrt(found.learned[term.name].scale)
    return across.prior(found.mean, found.covariance, beyond @ beyond.T)


_ALIKE = 1e-9
"""Of the whole: what is less is rounding."""


class Across(NamedTuple):
    """errors : of today; matrix : (size, before) from the unknowns of before to those of today

    rests : (size,) variances that the rests of before give them; known : the names of errors that both have
    """

    errors: ErrorModel
    matrix: Array
    rests: Array
    known: frozenset[str]

    def beyond(self) -> Array:
        """Return S (size, k): S Sᵀ is what today's prior holds of common errors and the other description cannot.

        With P = M M⁺ the part of the coefficients that the other knots reach, S = (I − P) L for C₀ = L Lᵀ.
        """
        root, parts = self.errors.prior_root(), [np.zeros((self.errors.size, 0))]
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


def carried_over(before: ErrorModel, errors: ErrorModel) -> Across:
    """Return how a belief over the errors of one model becomes one over those of another."""
    matrix, rests = np.zeros((errors.size, before.size)), np.zeros(errors.size)
    others = {term.name: term for term in before.terms}
    both = [(term, others[term.name]) for term in errors.terms if term.name in others]
    for term, other in both:
        matrix[term.columns, other.columns] = term.taken_from(other)
        rests[term.columns] = term.loosened(other.rest)
    return Across(errors, matrix, rests, frozenset(term.name for term, _ in both))
