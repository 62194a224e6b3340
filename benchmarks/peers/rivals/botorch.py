"""BoTorch: the negative integrated posterior variance, climbed as its tutorials do."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from botorch.acquisition.active_learning import qNegIntegratedPosteriorVariance
from botorch.models import SingleTaskGP
from botorch.optim import optimize_acqf
from gpytorch.kernels import Kernel
from gpytorch.means import ZeroMean

from benchmarks.peers.features import Features
from benchmarks.peers.problems import TRAVEL, Array, Posed

_RESTARTS, _SAMPLES = 10, 512


class _Splines(Kernel):
    """k(s, t) = f(s)ᵀ f(t)."""

    def __init__(self, features: Features) -> None:
        super().__init__()
        axes, pieces = features.coefficients.shape[:2]
        self._width = features.width
        by_power = np.moveaxis(features.coefficients.reshape(axes * pieces, 4, -1), 1, 0)
        self._powers = [torch.from_numpy(np.ascontiguousarray(power)) for power in by_power]
        self._first = pieces * torch.arange(axes)

    def _rows(self, x: Any) -> Any:
        piece = torch.floor(x.detach() / self._width)
        u = (x - piece * self._width)[..., None]
        index = piece.long() + self._first
        found = self._powers[0][index]
        for power in self._powers[1:]:
            found = found * u + power[index]
        return found.flatten(-2)

    def forward(self, x1: Any, x2: Any, diag: bool = False, **_: Any) -> Any:
        if diag:
            return (self._rows(x1) * self._rows(x2)).sum(-1)
        return self._rows(x1) @ self._rows(x2).transpose(-1, -2)


def picker(posed: Posed) -> Callable[[Array], Array]:
    """Return the greedy step of the integrated variance."""
    torch.set_num_threads(1)
    torch.manual_seed(1)
    warnings.simplefilter("ignore")  # of its own, on inputs that are not scaled to the unit cube
    features = Features.of(posed)
    kernel, places = _Splines(features), torch.from_numpy(features.places)
    bounds = torch.tensor([[0.0] * posed.case.axes, [TRAVEL] * posed.case.axes], dtype=torch.float64)

    def pick(taken: Array) -> Array:
        positions = torch.from_numpy(np.concatenate([features.nothing, taken]))
        values = torch.zeros((len(positions), 1), dtype=torch.float64)
        noise = torch.full_like(values, posed.case.noise**2)
        model = SingleTaskGP(
            positions, values, noise, covar_module=kernel, mean_module=ZeroMean(), outcome_transform=None
        )
        gain = qNegIntegratedPosteriorVariance(model, places)
        found, _ = optimize_acqf(gain, bounds, q=1, num_restarts=_RESTARTS, raw_samples=_SAMPLES)
        position: Array = found.numpy()[0]
        return position

    return pick
