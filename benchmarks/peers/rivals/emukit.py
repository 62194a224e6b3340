"""Emukit: the reduction of the integrated variance over a GPy model, with its own optimiser's settings."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import GPy
import numpy as np
from emukit.core import ContinuousParameter, ParameterSpace
from emukit.core.optimization import GradientAcquisitionOptimizer
from emukit.experimental_design.acquisitions import IntegratedVarianceReduction
from emukit.model_wrappers import GPyModelWrapper

from benchmarks.peers.features import Features
from benchmarks.peers.problems import TRAVEL, Array, Posed


class _Splines(GPy.kern.Kern):
    """k(s, t) = f(s)ᵀ f(t)."""

    def __init__(self, features: Features) -> None:
        super().__init__(features.coefficients.shape[0], None, "splines")
        self._rows = features

    def K(self, X: Array, X2: Array | None = None) -> Array:  # noqa: N802 - the library's name
        rows = self._rows(X)
        result: Array = rows @ (rows if X2 is None else self._rows(X2)).T
        return result

    def Kdiag(self, X: Array) -> Array:  # noqa: N802 - the library's name
        return np.asarray(np.sum(self._rows(X) ** 2, axis=1))

    def update_gradients_full(self, *_: Any) -> None:
        """Nothing is fitted."""


def _space(posed: Posed, end: float) -> Any:
    return ParameterSpace([ContinuousParameter(f"t{axis}", 0.0, end) for axis in range(posed.case.axes)])


def picker(posed: Posed) -> Callable[[Array], Array]:
    """Return the greedy step of the integrated variance."""
    np.random.seed(1)  # noqa: NPY002 - the generator that the library draws from
    features = Features.of(posed)
    regression = GPy.models.GPRegression(
        features.nothing, np.zeros((1, 1)), _Splines(features), noise_var=posed.case.noise**2
    )
    model = GPyModelWrapper(regression)
    gain = IntegratedVarianceReduction(model, _space(posed, features.reach), features.places)
    optimizer = GradientAcquisitionOptimizer(_space(posed, TRAVEL))

    def pick(taken: Array) -> Array:
        positions = np.concatenate([features.nothing, taken])
        model.set_data(positions, np.zeros((len(positions), 1)))
        found: Array = optimizer.optimize(gain)[0][0]
        return found

    return pick
