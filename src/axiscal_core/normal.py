"""A normal, sharpened by readings (B&H eq. 16-20 and 31-33).

>>> known = Normal(np.zeros(2), np.eye(2)).read([[1.0, 0.0]], [1.0], [1.0])
>>> known.mean, known.std
(array([0.5, 0. ]), array([0.70710678, 1.        ]))
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from axiscal_core.eigen import unique_root
from axiscal_core.refusals import Array, InputError, finite, whole


@dataclass(frozen=True, eq=False)
class Normal:
    """mean : (..., n); covariance : (..., n, n).  Several normals side by side have further axes in front."""

    mean: Array
    covariance: Array

    @property
    def std(self) -> Array:
        """Standard deviations, as the mean."""
        return np.asarray(np.sqrt(np.maximum(np.diagonal(self.covariance, axis1=-2, axis2=-1), 0.0)))

    def read(self, rows: ArrayLike, values: ArrayLike, covariance: ArrayLike) -> Normal:
        """Return the normal after y = rows x + v (eq. 31-33).

        rows : (m, n); values : (m,); covariance : of v, (m, m), or the variances (m,)
        """
        h = finite("Normal.read", "rows", rows, (None, self.mean.shape[-1]))
        y = finite("Normal.read", "values", values, (len(h),))
        wide = np.ndim(covariance) == 2
        noise = finite("Normal.read", "covariance", covariance, (len(h),) * (1 + wide))
        reach = self.covariance @ h.T
        try:
            root = np.linalg.cholesky(h @ reach + (noise if wide else np.diag(noise)))
        except np.linalg.LinAlgError as fault:
            raise InputError("Normal.read", "covariance", "leaves readings without noise", "Give more") from fault
        half = np.linalg.solve(root, np.column_stack([reach.T, y - h @ self.mean]))
        gain, innovation = half[:, :-1], half[:, -1]
        return Normal(self.mean + gain.T @ innovation, self.covariance - gain.T @ gain)

    def through(self, rows: ArrayLike) -> Normal:
        """Return the normal of rows x: of what a spline is at places, for example (eq. 18, 20).  rows : (m, n)"""
        h = finite("Normal.through", "rows", rows, (None, self.mean.shape[-1]))
        return Normal(h @ self.mean, h @ self.covariance @ h.T)

    def sample(self, count: int, seed: int = 0) -> Array:
        """Return draws, (count, n)."""
        root, some = unique_root(self.covariance), whole("Normal.sample", "count", count, 1)
        generator = np.random.default_rng(whole("Normal.sample", "seed", seed, 0))
        return np.asarray(self.mean + generator.standard_normal((some, len(root))) @ root.T)
