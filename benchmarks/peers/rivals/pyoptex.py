"""pyoptex: coordinate exchange over levels of every axis, all readings together, with J itself as the metric."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from pyoptex._seed import set_seed
from pyoptex.doe.fixed_structure import Factor, create_fixed_structure_design, create_parameters, default_fn
from pyoptex.doe.fixed_structure.metric import Metric

from benchmarks.peers import evaluator
from benchmarks.peers.features import Features
from benchmarks.peers.problems import TRAVEL, Array, Posed

_LEVELS = 101


class _Variance(Metric):
    """Minus J: the library's own I-optimality, with a prior, so that fewer readings than unknowns will do."""

    def __init__(self, posed: Posed) -> None:
        super().__init__()
        self._noise = posed.case.noise**2
        self._weight = evaluator.weight(posed.case, posed.criterion)
        self._before = float(np.trace(self._weight))

    def call(self, Y: Array, X: Array, params: Any) -> float:
        """Return −J of the readings X (m, size), J = tr W − tr((σ² + X Xᵀ)⁻¹ X W Xᵀ)."""
        inside = X @ X.T + self._noise * np.eye(len(X))
        return float(np.trace(np.linalg.solve(inside, X @ self._weight @ X.T))) - self._before


def planner(posed: Posed) -> Callable[[], Array]:
    """Return the best of the library's usual ten random starts."""
    case = posed.case
    set_seed(1)
    levels = np.linspace(0.0, TRAVEL, _LEVELS)
    factors = [Factor(f"t{axis}", None, "cont", 0.0, TRAVEL, levels) for axis in range(case.axes)]
    features, draw = Features.of(posed), np.random.default_rng(1)

    def rows(Y: Array) -> Array:
        return features((Y + 1.0) * TRAVEL / 2.0)

    def start(_: Any) -> tuple[Array, tuple[Array, Array]]:
        Y = draw.uniform(-1.0, 1.0, (case.readings, case.axes))
        return Y, (Y, rows(Y))

    parameters = create_parameters(factors, default_fn(factors, _Variance(posed), rows, init=start), case.readings)

    def plan() -> Array:
        design, _ = create_fixed_structure_design(parameters)
        positions: Array = design.to_numpy(dtype=float)
        return positions

    return plan
