"""Plain NumPy: the exact gain of 100,000 random candidates for every reading."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.peers import evaluator
from benchmarks.peers.features import Features
from benchmarks.peers.problems import TRAVEL, Array, Posed

_CANDIDATES = 100_000
_CHUNK = 5000


def picker(posed: Posed) -> Callable[[Array], Array]:
    """Return the best of fresh random candidates, in chunks that stay in the cache."""
    case, features, draw = posed.case, Features.of(posed), np.random.default_rng(1)
    root = evaluator.weight_root(posed)

    def pick(taken: Array) -> Array:
        spread = evaluator.covariance(case, taken)
        weighted = spread @ root.T
        best, found = -np.inf, np.zeros(case.axes)
        for _ in range(_CANDIDATES // _CHUNK):
            tried = draw.uniform(0.0, TRAVEL, (_CHUNK, case.axes))
            seen = features(tried)
            lowered = np.sum((seen @ weighted) ** 2, axis=1)
            gains = lowered / (case.noise**2 + np.einsum("ij,ij->i", seen @ spread, seen))
            if gains.max() > best:
                best, found = float(gains.max()), tried[gains.argmax()]
        return found

    return pick
