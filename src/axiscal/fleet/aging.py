"""How much of what a campaign found is left after a time: learnt from machines that were measured again.

Each error keeps ρ(Δt) = ρ₁ y^Δt, Δt in years: ρ₁ < 1 is what every set-up and warm-up changes at once, y what a year
changes. A second campaign with the data equation z₂ is as probable as

    p(z₂ | ρ m₁, ρ² C₁ + (1 − ρ²) C₀)

m₁, C₁ after the first one and C₀ as stated; where the type of the machine is known, what that one leaves (`wearing`).
ρ₁, y ~ Beta(9, 1); the product over pairs on a grid is averaged over.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from axiscal.estimate.problem import Inherited
from axiscal.fleet.wearing import Wearing
from axiscal.inference.sisters.belonging import Moments, log_evidence
from axiscal.inference.sisters.data_equation import DataEquation
from axiscal.numerics import Array

YEAR = 365.25 * 86400.0
"""s."""
_GRID = np.arange(0.505, 1.0, 0.01)
"""Places for ρ₁ and for y: half a percent off is nothing."""
_KEPT = 9.0
"""Of the Beta(9, 1): nine tenths are kept as a rule, as where a campaign says nothing else."""


class Pair(NamedTuple):
    """Two campaigns of one machine: years between them, what the first knew, what the second one read, what wears."""

    years: float
    first: Inherited
    second: DataEquation
    wears: Wearing


class Aging(NamedTuple):
    """How probable each ρ₁ (first index) and y is, (g, g), sum 1; pairs : that it was learnt from"""

    weights: Array
    pairs: int

    def shares(self, years: float) -> Array:
        """Return ρ after a time in each cell of the grid, (g, g)."""
        shares: Array = _GRID[:, None] * _GRID**years
        return shares

    def kept(self, years: float) -> tuple[float, float]:
        """Return the means of ρ and of ρ² after a time."""
        rho = self.shares(years)
        return float(np.sum(self.weights * rho)), float(np.sum(self.weights * rho**2))

    @property
    def at_once(self) -> tuple[float, float]:
        """Mean and std of ρ₁."""
        return _moments(self.weights.sum(axis=1))

    @property
    def yearly(self) -> tuple[float, float]:
        """Mean and std of y."""
        return _moments(self.weights.sum(axis=0))


def _moments(weights: Array) -> tuple[float, float]:
    mean = float(weights @ _GRID)
    return mean, float(np.sqrt(weights @ (_GRID - mean) ** 2))


def aging(pairs: Sequence[Pair]) -> Aging:
    """Return what machines that were measured again say; without any, what is believed beforehand."""
    logs = (_KEPT - 1) * (np.log(_GRID)[:, None] + np.log(_GRID))
    for pair in pairs:
        rho = _GRID[:, None] * _GRID**pair.years
        # one evidence for each distinct share, to a thousandth: the grid's products lie denser than that
        shares = np.round(rho, 3)
        worn = pair.wears.worn(pair.first)
        found = {share: log_evidence(pair.second, Moments(*worn.left(share))) for share in np.unique(shares).tolist()}
        logs = logs + np.vectorize(found.__getitem__)(shares)
    weights = np.exp(logs - logs.max())
    return Aging(weights / weights.sum(), len(pairs))
