"""The belief: the posterior over all coefficients, and how each reading changes it.

A belief is frozen: an update returns a new one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from axiscal.exceptions import ShapeError
from axiscal.numerics import Array, gaussian


@dataclass(frozen=True, slots=True)
class Innovations:
    """By what readings surprised: each of them minus its prediction, in their order.

    value : (m,); std : (m,) the standard deviation that the belief gave it, noise included
    """

    value: Array
    std: Array


class Updated(NamedTuple):
    """The belief after many readings.

    innovations : of each at its turn
    losses : (m, n), each row d takes d dᵀ off the covariance, in the order of the readings
    """

    belief: Belief
    innovations: Innovations
    losses: Array


@dataclass(frozen=True, init=False, eq=False, slots=True)
class Belief:
    """A multivariate normal over the coefficients A, or a multivariate t where its sizes were learnt.

    mean : (n,); covariance : (n, n) positive semidefinite, may be singular; factor : F (n, n) with C = F Fᵀ
    degrees : of freedom of the t; infinite for a normal
    Raises CovarianceError or ShapeError.
    """

    mean: Array
    factor: Array = field(repr=False)
    degrees: float

    def __init__(self, mean: ArrayLike, covariance: ArrayLike, degrees: float = math.inf) -> None:
        try:
            centre, wide = np.array(mean, dtype=float), np.asarray(covariance, dtype=float)
        except (TypeError, ValueError) as fault:
            raise ShapeError(f"Mean or covariance is no array of numbers: {fault}.") from None
        root = gaussian.root_of(wide)
        if centre.shape != root.shape[:1] or not np.all(np.isfinite(centre)):
            raise ShapeError(f"The mean has shape {centre.shape}; the covariance asks for ({len(root)},).")
        _fill(self, centre, root, degrees)

    @property
    def size(self) -> int:
        """Number of coefficients."""
        return len(self.mean)

    @property
    def covariance(self) -> Array:
        """The covariance C = F Fᵀ, (n, n)."""
        return self.factor @ self.factor.T

    def update_many(self, rows: Array, values: Array, noise: Array, used: Array, reading: NDArray[np.intp]) -> Updated:
        """Return the belief after many updates, made all at once, with the innovations of each.

        rows : (m, n); values, noise : (m,); used : (m,) the variances of the updates, infinite for none
        reading : (m,) ascending; numbers of one reading are predicted from what was known before the first of them
        Hundreds of updates cost no more than a few made one by one.  Raises ShapeError.
        """
        table, read, own = self._readings(rows, values, noise)
        counted = np.concatenate([[0], np.cumsum(np.isfinite(used))])
        after, done = self._updated(table, read, used, counted[np.searchsorted(reading, reading)])
        surprise = Innovations(read - done.expected, np.sqrt(done.variance + own))
        return Updated(after, surprise, done.losses)

    def _updated(
        self, rows: Array, values: Array, used: Array, before: NDArray[np.intp]
    ) -> tuple[Belief, gaussian.Conditioned]:
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            done = gaussian.condition(self.factor, self.mean, rows, values, used, before)
        if not all(np.all(np.isfinite(result)) for result in (done.mean, done.root, done.variance)):
            raise ShapeError("Rows, values and variances lie so far apart in size that the update overflows.")
        return _fill(Belief.__new__(Belief), done.mean, done.root, self.degrees), done

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

    def extended(self, variances: ArrayLike) -> Belief:
        """Return the belief with independent zero-mean variables appended.  variances : (k,) >= 0.

        Raises ShapeError.
        """
        extra = np.array(variances, dtype=float)
        if extra.ndim != 1 or not np.all(np.isfinite(extra)) or np.any(extra < 0):
            raise ShapeError("The variances of new variables must be finite, not negative, and one in a row.")
        size, count = self.size, len(extra)
        root = np.zeros((size + count, size + count))
        root[:size, :size], root[size:, size:] = self.factor, np.diag(np.sqrt(extra))
        mean = np.concatenate([self.mean, np.zeros(count)])
        return _fill(Belief.__new__(Belief), mean, root, self.degrees)

    def among(self, kept: NDArray[np.intp]) -> Belief:
        """Return the belief over some coefficients.  kept : (k,) which"""
        felt = self.factor[kept]
        felt = felt[:, np.any(felt, axis=0)]  # before the first reading nothing is rounded so
        spare = len(kept) - felt.shape[1]
        root = np.pad(felt, ((0, 0), (0, spare))) if spare >= 0 else np.asarray(np.linalg.qr(felt.T, mode="r")).T
        return _fill(Belief.__new__(Belief), self.mean[kept], root, self.degrees)


def _fill(belief: Belief, mean: Array, root: Array, degrees: float) -> Belief:
    for name, array in (("mean", mean), ("factor", root)):
        array.flags.writeable = False
        object.__setattr__(belief, name, array)
    object.__setattr__(belief, "degrees", degrees)
    return belief
