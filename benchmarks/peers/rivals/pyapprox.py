"""pyapprox: the greedy reduction of the integrated variance over fixed candidates."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from pyapprox.surrogates.gaussianprocess.adaptive.ivar_sampler import IVARSampler
from pyapprox.util.backends.numpy import NumpyBkd

from benchmarks.peers import evaluator
from benchmarks.peers.problems import Array, Posed


def picker(posed: Posed) -> Callable[[Array], Array]:
    """Return its next sample; kernel matrices of the candidates are made before."""
    case, candidates = posed.case, posed.candidates

    def kernel(first: Array, second: Array) -> Any:
        return evaluator.rows(case, first.T) @ evaluator.rows(case, second.T).T

    seen = evaluator.rows(case, candidates)
    sampler = IVARSampler(np.ascontiguousarray(candidates.T), NumpyBkd(), nugget=case.noise**2)
    sampler.set_P(seen @ evaluator.weight(case, posed.criterion) @ seen.T)
    sampler.set_kernel(kernel)

    def pick(taken: Array) -> Array:
        found: Array = np.asarray(sampler.select_samples(1))[:, 0]
        return found

    return pick
