"""A normal, sharpened by readings (B&H eq. 16-20 and 31-33).

>>> known = Normal(np.zeros(2), np.eye(2)).read([[1.0, 0.0]], [1.0], [1.0])
>>> known.mean, known.std
(array([0.5, 0. ]), array([0.70710678, 1.        ]))
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from axiscal_core.eigen import unique_root
from axiscal_core.refusals import Array, InputError, finite, spread, whole


@dataclass(frozen=True, eq=False)
class Normal:
    """mean : (..., n); covariance : (..., n, n); factor : F (n, k) where that is F Fᵀ, which has twice its digits

    Several normals side by side have further axes in front.  raises InputError for what is no covariance
    """

    mean: Array
    covariance: Array
    factor: Array | None = None

    def __post_init__(self) -> None:
        if self.factor is not None:  # its square is a covariance
            return
        mean = finite("Normal", "mean", self.mean, (None,) * max(getattr(self.covariance, "ndim", 2) - 1, 1))
        covariance = spread("Normal", "covariance", self.covariance, mean.shape[-1], mean.shape[:-1])
        vars(self).update(mean=mean, covariance=covariance)

    @property
    def std(self) -> Array:
        """Standard deviations, as the mean."""
        return np.asarray(np.sqrt(np.maximum(np.diagonal(self.covariance, axis1=-2, axis2=-1), 0.0)))

    @cached_property
    def root(self) -> Array:
        """F with F Fᵀ the covariance, (..., n, k)."""
        return unique_root(self.covariance) if self.factor is None else self.factor

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
        mean, root = sharpened(self.mean[:, None], self.root, h, y[:, None], np.maximum(noise, 0.0))
        return Normal(mean[:, 0], root @ root.T, root)

    def through(self, rows: ArrayLike) -> Normal:
        """Return the normal of rows x: of what a spline is at places, for example (B&H eq. 18-20).  rows : (m, n)"""
        h = finite("Normal.through", "rows", rows, (None, self.mean.shape[-1]))
        root = h @ self.root
        return Normal(h @ self.mean, root @ root.T, root)

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
