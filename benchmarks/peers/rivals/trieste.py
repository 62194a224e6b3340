"""Trieste: the reduction of the integrated variance, one reading at a time or all of them jointly.

Its own defaults: the samples and climbs that `automatic_optimizer_selector` takes, as its own rules do.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import gpflow
import numpy as np
import tensorflow as tf
from trieste.acquisition.function import IntegratedVarianceReduction
from trieste.acquisition.optimizer import automatic_optimizer_selector, batchify_joint
from trieste.data import Dataset
from trieste.models.gpflow import GaussianProcessRegression
from trieste.space import Box

from benchmarks.peers.features import Features
from benchmarks.peers.problems import TRAVEL, Array, Posed


class _Splines(gpflow.kernels.Kernel):
    """k(s, t) = f(s)ᵀ f(t)."""

    def __init__(self, features: Features) -> None:
        super().__init__()
        axes, self._pieces = features.coefficients.shape[:2]
        self._width = features.width
        by_power = np.moveaxis(features.coefficients.reshape(axes * self._pieces, 4, -1), 1, 0)
        self._powers = [tf.constant(np.ascontiguousarray(power)) for power in by_power]
        self._first = tf.constant(self._pieces * np.arange(axes), dtype=tf.int32)

    def _rows(self, X: Any) -> Any:
        piece = tf.floor(X / self._width)
        u = (X - piece * self._width)[..., None]
        index = tf.cast(piece, tf.int32) + self._first
        found = tf.gather(self._powers[0], index)
        for power in self._powers[1:]:
            found = found * u + tf.gather(power, index)
        return tf.reshape(found, tf.concat([tf.shape(X)[:-1], [-1]], 0))

    def K(self, X: Any, X2: Any = None) -> Any:  # noqa: N802 - the library's name
        rows = self._rows(X)
        if X2 is None:
            return tf.matmul(rows, rows, transpose_b=True)
        return tf.tensordot(rows, self._rows(X2), [[-1], [-1]])

    def K_diag(self, X: Any) -> Any:  # noqa: N802 - the library's name
        return tf.reduce_sum(self._rows(X) ** 2, -1)


class _Search:
    """A model that has seen nothing yet, and the acquisition function over it."""

    def __init__(self, posed: Posed, features: Features) -> None:
        tf.random.set_seed(1)
        self.space = Box([0.0] * posed.case.axes, [TRAVEL] * posed.case.axes)
        self.nothing = features.nothing
        data = (self.nothing, np.zeros((1, 1)))
        regression = gpflow.models.GPR(data, _Splines(features), noise_variance=posed.case.noise**2)
        self.model = GaussianProcessRegression(regression)
        builder = IntegratedVarianceReduction(tf.constant(features.places))
        self.gain = builder.prepare_acquisition_function(self.model)

    def learn(self, taken: Array) -> None:
        """Condition on the readings taken; their values do not matter."""
        positions = np.concatenate([self.nothing, taken])
        data = Dataset(tf.constant(positions), tf.zeros((len(positions), 1), tf.float64))
        self.model.update(data)


def picker(posed: Posed, fewest: bool = False) -> Callable[[Array], Array]:
    """Return the greedy step of the exact integrated variance."""
    search = _Search(posed, Features.of(posed, fewest))

    def pick(taken: Array) -> Array:
        search.learn(taken)
        found: Array = np.asarray(automatic_optimizer_selector(search.space, search.gain))[0]
        return found

    return pick


def fewest_picker(posed: Posed) -> Callable[[Array], Array]:
    """Return the same over the fewest places that are exact."""
    return picker(posed, fewest=True)


def planner(posed: Posed) -> Callable[[], Array]:
    """Return the batch of all readings, climbed jointly."""
    search = _Search(posed, Features.of(posed, fewest=True))
    together = batchify_joint(automatic_optimizer_selector, posed.case.readings)
    return lambda: np.asarray(together(search.space, search.gain))
