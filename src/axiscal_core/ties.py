"""Ties: values that differ by rounding alone count as equal, and of equal ones the first is taken.

Mirror images gain the same, and the last bit of a sum would choose between them. Another thread, another library or
another order of the unknowns would then make another plan. The shares here are coarser than rounding and finer than
what matters.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal_core.refusals import Array

TIE = 1e-12
"""Share of the larger value within which two computed afresh count as equal: they keep fourteen digits."""
ALIKE = 1e-8
"""The same for values that are brought up to date many times, or climbed to: they keep nine digits or more."""


def first_best(values: Array, share: float) -> int:
    """Return the index of the first of the largest values.  values : (n,), not all −∞"""
    return int(first_best_each(values[None], share)[0])


def first_best_each(values: Array, share: float) -> NDArray[np.intp]:
    """Return for every row the index of the first of its largest values, (m,).  values : (m, n)"""
    best = values.max(axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        least = np.where(np.isfinite(best), best - share * np.abs(best), best)
    found: NDArray[np.intp] = (values >= least).argmax(axis=1)
    return found


def ranked(values: Array, share: float, most: int | None = None) -> NDArray[np.intp]:
    """Return the indices from the largest value down, equal ones in the order in which they stand; `most` at the most.

    values : (n,), those that cannot be are −∞
    """
    kept = np.arange(len(values))
    if most is not None and 0 < most < len(values):
        least = np.partition(values, -most)[-most]
        kept = np.flatnonzero(values >= (least - share * np.abs(least) if np.isfinite(least) else least))
    down = kept[np.argsort(-values[kept], kind="stable")]
    falling = values[down]
    with np.errstate(invalid="ignore"):
        lower = falling[:-1] - falling[1:] > share * np.abs(falling[:-1])
    group = np.concatenate([[0], np.cumsum(lower)])[: len(down)]
    return down[np.lexsort((down, group))][:most]


def surely_more(values: Array, than: Array, share: float) -> NDArray[np.bool_]:
    """Return which values are larger by more than rounding, (n,).  values, than : (n,), than perhaps −∞"""
    return values > than + share * np.where(np.isfinite(than), np.abs(than), 0.0)
