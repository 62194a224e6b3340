"""A normal, sharpened by readings (B&H eq. 16-20 and 31-33).

>>> known = Normal(np.zeros(2), np.eye(2)).read([[1.0, 0.0]], [1.0], [1.0])
>>> known.mean, known.std
(array([0.5, 0. ]), array([0.70710678, 1.        ]))
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from axiscal_core.eigen import root_of, unique_root
from axiscal_core.from_scipy import solution, triangle_over
from axiscal_core.refusals import Array, InputError, finite, spread, whole


@dataclass(frozen=True, eq=False, init=False)
class Normal:
    """mean : (..., n); covariance : (..., n, n); degrees : of freedom, where it is a multivariate t of that covariance

    Several normals side by side have further axes in front.  raises InputError for what is no covariance
    """

    mean: Array
    degrees: float

    def __init__(self, mean: ArrayLike, covariance: ArrayLike, degrees: float = math.inf) -> None:
        centre = finite("Normal", "mean", mean, (None,) * max(np.ndim(covariance) - 1, 1))
        wide = spread("Normal", "covariance", covariance, centre.shape[-1], centre.shape[:-1])
        vars(self).update(mean=centre, covariance=wide, degrees=degrees)

    @classmethod
    def of_factor(cls, mean: Array, factor: Array, degrees: float = math.inf) -> Self:
        """Return the normal of F (..., n, k), of covariance F Fᵀ: F has twice the digits of that."""
        found = cls.__new__(cls)
        vars(found).update(mean=mean, factor=factor, degrees=degrees)
        return found

    @cached_property
    def covariance(self) -> Array:
        """C, (..., n, n)."""
        return self.factor @ self.factor.swapaxes(-1, -2)

    @cached_property
    def factor(self) -> Array:
        """F with F Fᵀ the covariance, (..., n, k)."""
        return root_of(self.covariance)

    @property
    def size(self) -> int:
        """The number of variables, n."""
        return int(self.mean.shape[-1])

    @property
    def std(self) -> Array:
        """Standard deviations, as the mean."""
        return np.asarray(np.sqrt(np.maximum(np.diagonal(self.covariance, axis1=-2, axis2=-1), 0.0)))

    def read(self, rows: ArrayLike, values: ArrayLike, covariance: ArrayLike) -> Normal:
        """Return the normal after y = rows x + v (B&H eq. 31-33).

        rows : (m, n); values : (m,); covariance : of v, (m, m), or the variances (m,)
        """
        h = finite("Normal.read", "rows", rows, (None, self.mean.shape[-1]))
        y = finite("Normal.read", "values", values, (len(h),))
        if np.ndim(covariance) == 2:
            noise, turn = np.linalg.eigh(spread("Normal.read", "covariance", covariance, len(h)))
            h, y = turn.T @ h, turn.T @ y
        elif (noise := finite("Normal.read", "covariance", covariance, (len(h),))).min(initial=0.0) < 0:
            raise InputError(
                "Normal.read", "covariance", "holds a variance below zero", "Give variances, not deviations"
            )
        mean, root = sharpened(self.mean[:, None], self.factor, h, y[:, None], np.maximum(noise, 0.0))
        return Normal.of_factor(mean[:, 0], root, self.degrees)

    def through(self, rows: ArrayLike) -> Normal:
        """Return the normal of rows x: of what a spline is at places, for example (B&H eq. 18-20).  rows : (m, n)"""
        h = finite("Normal.through", "rows", rows, (None, self.mean.shape[-1]))
        return Normal.of_factor(h @ self.mean, h @ self.factor, self.degrees)

    def among(self, kept: NDArray[np.intp]) -> Normal:
        """Return the normal of some variables.  kept : (k,) which"""
        felt = self.factor[kept]
        felt = felt[:, np.any(felt, axis=0)]  # before the first reading nothing is rounded so
        spare = len(kept) - felt.shape[1]
        root = np.pad(felt, ((0, 0), (0, spare))) if spare >= 0 else np.asarray(np.linalg.qr(felt.T, mode="r")).T
        return Normal.of_factor(self.mean[kept], root, self.degrees)

    def wider(self, stds: Array) -> Normal:
        """Return the normal with independent variables of mean zero behind the others.  stds : (k,)"""
        before, more = self.factor, len(stds)
        factor = np.zeros(np.add(before.shape, more))
        factor[: len(before), : before.shape[1]] = before
        factor[len(before) :, before.shape[1] :] = np.diag(stds)
        return Normal.of_factor(np.append(self.mean, np.zeros(more)), factor, self.degrees)

    def sample(self, count: int, seed: int = 0) -> Array:
        """Return draws of the density (B&H eq. 16), (count, n)."""
        root, some = unique_root(self.covariance), whole("Normal.sample", "count", count, 1)
        generator = np.random.default_rng(whole("Normal.sample", "seed", seed, 0))
        return np.asarray(self.mean + generator.standard_normal((some, len(root))) @ root.T)


def sharpened(means: Array, root: Array, rows: Array, values: Array, variances: Array) -> tuple[Array, Array]:
    """Return means and root after y = rows x + v, for several y, value by value (eq. 21-23; Potter's square root).

    F P, P a reflection, has one column that is seen, and that shrinks by σ/√(σ² + |h F|²). It is that of the largest
    entry of h F: so columns of what is known well do not mix with larger ones.
    means : (n, c); root : F (n, k); rows : (m, n); values : (m, c); variances : of v, (m,)
    """
    for row, value, variance in zip(rows, values, variances, strict=True):
        seen = row @ root
        if not (total := variance + seen @ seen) > 0:
            raise InputError("Normal.read", "covariance", "leaves readings without noise", "Give more")
        means = means + np.outer(root @ seen, (value - row @ means) / total)
        if np.any(seen):
            largest = np.argmax(np.abs(seen))
            seen[largest] += np.copysign(np.linalg.norm(seen), seen[largest])
            root = root - np.outer(root @ seen, seen * (2 / (seen @ seen)))
            root[:, largest] *= np.sqrt(variance / total)
    return means, root


class Conditioned(NamedTuple):
    """Root and mean after readings, and what was known before each of them.

    expected, variance : (m,) of each row's value without its noise, given the readings that count before it
    losses : (m, n), each row d takes d dᵀ off the covariance; zero where a reading does not count
    """

    root: Array
    mean: Array
    expected: Array
    variance: Array
    losses: Array


def condition(
    root: Array, mean: Array, rows: Array, values: Array, noise: Array, before: NDArray[np.intp]
) -> Conditioned:
    """Return root and mean after the readings value_i = row_iᵀ a + v_i, v_i ~ N(0, noise_i), all at once.

    rows : (m, n); values : (m,); noise : (m,) variances, infinite where a reading does not count
    before : (m,) how many of the readings that count come before each
    With C = F Fᵀ, W = rows F and W Wᵀ + N = L Lᵀ over those that count, row i of X = L⁻¹ W is what reading i takes
    away: C_k = F (1 − Σ_{i≤k} x_i x_iᵀ) Fᵀ, and X Wᵀ is Lᵀ above its diagonal. In the end F R⁻¹ replaces F, with RᵀR =
    1 + Wᵀ N⁻¹ W. Both triangles come from QR of roots, so wide priors keep their digits (Bierman 1977, ch. IV). Of R
    the sharpest readings come first, so that their order does not matter. The same numbers as B&H eq. 21-23 and 31-33.
    """
    counts, seen = np.isfinite(noise), rows @ root
    own, std, left = seen[counts], np.sqrt(noise[counts]), (values - rows @ mean)[counts]
    upper = triangle_over(std, own.T)
    solved = solution(upper.T, np.column_stack([own, left]))
    learnt = np.empty((len(own), len(rows)))
    learnt[:, counts], learnt[:, ~counts] = upper, solved[:, :-1] @ seen[~counts].T
    learnt[np.arange(len(learnt))[:, None] >= before] = 0.0
    variance = np.maximum(np.einsum("ij,ij->i", seen, seen) - np.einsum("ij,ij->j", learnt, learnt), 0.0)
    expected = rows @ mean + solved[:, -1] @ learnt
    losses = np.zeros_like(rows)
    losses[counts] = solved[:, :-1] @ root.T
    size = root.shape[1]
    told = (np.column_stack([own, left]) / std[:, None])[np.argsort(std, kind="stable")]
    triangle = triangle_over(np.append(np.ones(size), 0.0), told)[:size]
    after = solution(triangle[:, :size].T, root.T).T
    return Conditioned(after, mean + after @ triangle[:, size], expected, variance, losses)
