"""The belief: the posterior over all coefficients, and how each reading changes it.

    belief = Belief(mean, covariance)
    belief = belief.update(rows, values, variances)
    belief.predict(rows).std

A belief is frozen: an update returns a new one, and carries the innovations by which a bad reading is seen.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from axiscal.exceptions import ShapeError
from axiscal.numerics import Array, gaussian


class Prediction(NamedTuple):
    """Mean (m,) and standard deviation (m,) of linear combinations of the coefficients."""

    mean: Array
    std: Array


@dataclass(frozen=True, slots=True)
class Innovations:
    """What the last update was surprised by: each reading minus its prediction, in the order of the update.

    value : (m,); std : (m,) the standard deviation that the belief gave it, noise included
    """

    value: Array
    std: Array

    @property
    def chi_square(self) -> float:
        """The sum of the squared standardised innovations: chi-square with `degrees` degrees of freedom."""
        return float(np.sum((self.value / self.std) ** 2))

    @property
    def degrees(self) -> int:
        """Number of readings in the update."""
        return len(self.value)


_NONE = Innovations(np.zeros(0), np.zeros(0))
"""Before the first reading."""


class Updated(NamedTuple):
    """The belief after many readings, with the innovations of each at its turn.

    losses : (m, n), each row d takes d dᵀ off the covariance, in the order of the readings
    """

    belief: Belief
    losses: Array


@dataclass(frozen=True, init=False, eq=False, slots=True)
class Belief:
    """A multivariate normal over the coefficients A, in factorised form.

    mean : (n,); covariance : (n, n) positive semidefinite, may be singular
    Raises CovarianceError or ShapeError.
    """

    mean: Array
    factors: gaussian.Factors = field(repr=False)
    innovations: Innovations = field(repr=False)

    def __init__(self, mean: ArrayLike, covariance: ArrayLike) -> None:
        centre = np.array(mean, dtype=float)
        factors = gaussian.factorise(np.asarray(covariance, dtype=float))
        if centre.shape != factors.diagonal.shape or not np.all(np.isfinite(centre)):
            raise ShapeError(f"The mean has shape {centre.shape}; the covariance asks for ({len(factors.diagonal)},).")
        _fill(self, centre, factors, _NONE)

    @property
    def size(self) -> int:
        """Number of coefficients."""
        return len(self.mean)

    @property
    def covariance(self) -> Array:
        """The covariance C = U D Uᵀ, (n, n)."""
        factor = gaussian.root(self.factors)
        return factor @ factor.T

    @property
    def factor(self) -> Array:
        """F (n, n) with C = F Fᵀ."""
        return gaussian.root(self.factors)

    def update(self, rows: ArrayLike, values: ArrayLike, variances: ArrayLike) -> Belief:
        """Return the belief after readings value_i = row_iᵀ A + v_i with independent v_i ~ N(0, variance_i).

        rows : (m, n) or (n,); values, variances : (m,) or scalars; variances > 0
        One reading, several, or all at once give the same posterior to rounding, in any order.
        The readings are taken in one by one (B&H eq. 21-23; as a vector B&H eq. 31-33). Raises ShapeError.
        """
        table, read, noise = self._readings(rows, values, variances)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            done = gaussian.condition(self.factors, self.mean, table, read, noise)
        if not all(np.all(np.isfinite(result)) for result in (done.mean, *done.factors, done.variance)):
            raise ShapeError("Rows, values and variances lie so far apart in size that the update overflows.")
        surprise = Innovations(done.innovation, np.sqrt(done.variance))
        return _fill(Belief.__new__(Belief), done.mean, done.factors, surprise)

    def update_many(self, rows: Array, values: Array, noise: Array, used: Array, reading: NDArray[np.intp]) -> Updated:
        """Return the belief after many updates, made all at once, with the innovations of each.

        rows : (m, n); values, noise : (m,); used : (m,) the variances of the updates, infinite for none
        reading : (m,) ascending; numbers of one reading are predicted from what was known before the first of them
        Hundreds of updates cost no more than a few made one by one.  Raises ShapeError.
        """
        table, read, own = self._readings(rows, values, noise)
        counted = np.concatenate([[0], np.cumsum(np.isfinite(used))])
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            done = gaussian.condition_at_once(
                self.factors, self.mean, table, read, used, counted[np.searchsorted(reading, reading)]
            )
        if not all(np.all(np.isfinite(result)) for result in (done.mean, *done.factors, done.variance)):
            raise ShapeError("Rows, values and variances lie so far apart in size that the update overflows.")
        surprise = Innovations(read - done.expected, np.sqrt(done.variance + own))
        return Updated(_fill(Belief.__new__(Belief), done.mean, done.factors, surprise), done.losses)

    def _readings(self, rows: ArrayLike, values: ArrayLike, variances: ArrayLike) -> tuple[Array, Array, Array]:
        table = np.atleast_2d(np.asarray(rows, dtype=float))
        read = np.atleast_1d(np.asarray(values, dtype=float))
        noise = np.asarray(variances, dtype=float)
        if read.ndim != 1 or noise.shape not in {(), (1,), read.shape}:
            raise ShapeError(f"Readings of shape {read.shape} cannot have variances of shape {noise.shape}.")
        noise = np.broadcast_to(noise, read.shape)
        if table.shape != (len(read), self.size):
            wanted = (len(read), self.size)
            raise ShapeError(f"{wanted[0]} readings of {wanted[1]} coefficients need rows {wanted}, got {table.shape}.")
        if not (np.all(np.isfinite(table)) and np.all(np.isfinite(read)) and np.all(np.isfinite(noise))):
            raise ShapeError("A row, value or variance is not finite.")
        if np.any(noise <= 0):
            raise ShapeError("The variance of a reading must be positive.")
        return table, read, noise

    def predict(self, rows: ArrayLike) -> Prediction:
        """Return mean and standard deviation of rowᵀ A for each row (B&H eq. 18-20).  rows : (m, n) or (n,)."""
        table = np.atleast_2d(np.asarray(rows, dtype=float))
        if table.ndim != 2 or table.shape[1] != self.size or not np.all(np.isfinite(table)):
            raise ShapeError(f"Finite rows of {self.size} coefficients expected, got shape {table.shape}.")
        return Prediction(table @ self.mean, np.sqrt(gaussian.variances(self.factors, table)))

    def extended(self, variances: ArrayLike) -> Belief:
        """Return the belief with independent zero-mean variables appended.  variances : (k,) >= 0.

        Raises ShapeError.
        """
        extra = np.array(variances, dtype=float)
        if extra.ndim != 1 or not np.all(np.isfinite(extra)) or np.any(extra < 0):
            raise ShapeError("The variances of new variables must be finite, not negative, and one in a row.")
        mean = np.concatenate([self.mean, np.zeros(len(extra))])
        return _fill(Belief.__new__(Belief), mean, gaussian.extend(self.factors, extra), _NONE)

    def sample(self, generator: np.random.Generator, count: int) -> Array:
        """Return draws from the belief, a normal density (B&H eq. 16): (count, n)."""
        return self.mean + generator.standard_normal((count, self.size)) @ gaussian.root(self.factors).T


def _fill(belief: Belief, mean: Array, factors: gaussian.Factors, innovations: Innovations) -> Belief:
    for array in (mean, *factors):
        array.flags.writeable = False
    object.__setattr__(belief, "mean", mean)
    object.__setattr__(belief, "factors", factors)
    object.__setattr__(belief, "innovations", innovations)
    return belief
