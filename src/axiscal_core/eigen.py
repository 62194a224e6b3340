"""Eigenvectors that are the same on every processor: one seed draws one machine anywhere."""

from __future__ import annotations

import numpy as np

from axiscal_core.refusals import Array

_EQUAL = 1e-8  # eigenvalues that differ by a smaller share are equal: rounding turns their eigenvectors
_NEAR = 1e-6  # entries of one that differ by a smaller share are equally large: rounding decides which is larger
_EPS = float(np.finfo(np.float64).eps)


def unique_root(covariance: Array) -> Array:
    """Return F (..., n, n) with F Fᵀ a covariance of any rank; negative eigenvalues count as zero.

    F is the symmetric root of the correlation matrix times the standard deviations. Eigenvectors alone would leave
    their signs, and turns among equal eigenvalues, to the BLAS at hand: one seed would draw another machine there.
    """
    std = np.sqrt(np.maximum(np.diagonal(covariance, axis1=-2, axis2=-1), 0.0))
    scale = np.where(std > 0, std, 1.0)
    values, vectors = np.linalg.eigh(covariance / scale[..., :, None] / scale[..., None, :])
    half = vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :]
    return np.asarray(scale[..., :, None] * (half @ np.swapaxes(vectors, -1, -2)))


def root_of(covariance: Array) -> Array:
    """Return F (..., n, n) with F Fᵀ a covariance: upper triangular, in a tenth of the time, where it is not singular.

    The correlation matrix has the root, so that variances of any scale keep their digits.
    """
    std = np.sqrt(np.maximum(np.diagonal(covariance, axis1=-2, axis2=-1), 0.0))[..., None]
    scale = np.where(std > 0, std, 1.0)
    try:
        alike = covariance / scale / scale.swapaxes(-1, -2)
        return np.asarray(scale * np.linalg.cholesky(alike[..., ::-1, ::-1])[..., ::-1, ::-1])
    except np.linalg.LinAlgError:
        return unique_root(covariance)


def of_rank(rows: Array) -> Array:
    """Return rows with the products Z Zᵀ of these, no more columns of them than rows.  rows : Z (r, q)"""
    count, columns = rows.shape
    return rows if columns <= count else np.asarray(np.linalg.qr(rows.T, mode="r")).T


def settled(values: Array, vectors: Array) -> Array:
    """Return eigenvectors whose signs are settled, and their turn where eigenvalues are equal, (n, k).

    values : (k,), in order; vectors : (n, k), orthonormal
    The first vector of equal ones is the projection of that unit vector which is nearest to all of them, and so on.
    """
    apart = np.abs(np.diff(values)) > _EQUAL * np.abs(values[1:]) + 4 * len(vectors) * _EPS * np.max(np.abs(values))
    found = np.empty_like(vectors)
    for part in np.split(np.arange(len(values)), 1 + np.flatnonzero(apart)):
        left = vectors[:, part]
        for column in part:
            lengths = np.linalg.norm(left, axis=1)
            nearest = np.argmax(lengths > (1 - _NEAR) * lengths.max())  # the first one where several are as near
            found[:, column] = left @ left[nearest] / lengths[nearest]
            left = left - np.outer(found[:, column], found[:, column] @ left)
    return found
