"""The sizes that readings may teach, as functions of standard normal numbers.

θ = f q(x), x ~ N(0, 1), q the quantile of Student's t of four degrees. In x the prior is exactly normal, so a size of
which readings tell nothing is drawn exactly. With the tail p = Φ(−|x|) and α = 4 p (1 − p) (Shaw 2006, eq. 37)

    q = ±2 √( cos(⅓ arccos √α)/√α − 1 )
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.numerics.from_scipy import normal_share

Kind = Literal["std", "length", "rest", "reversal", "together", "drift", "cycle", "growth", "noise"]
_FARTHEST = 7.0
"""Of |θ|, a factor of a thousand: beyond it lies nothing but overflow."""


class Size(NamedTuple):
    """One size: a factor exp(θ) on what all its owners state.

    owners : errors or set-ups by name, in their order; spread : scale of θ
    """

    kind: Kind
    owners: tuple[str, ...]
    spread: float


@dataclass(frozen=True)
class Sizes:
    """All sizes that vary, in the order of θ."""

    of: tuple[Size, ...]

    def __len__(self) -> int:
        return len(self.of)

    @cached_property
    def _index(self) -> dict[tuple[Kind, str], int]:
        return {(size.kind, owner): i for i, size in enumerate(self.of) for owner in size.owners}

    def index(self, kind: Kind, owner: str) -> int:
        """Return the number of a size; −1 where it does not vary."""
        return self._index.get((kind, owner), -1)

    def indices(self, kind: Kind, owners: Sequence[str]) -> NDArray[np.intp]:
        """Return the numbers of the sizes of several owners, (n,)."""
        return np.array([self.index(kind, owner) for owner in owners], dtype=np.intp)

    @cached_property
    def spreads(self) -> Array:
        """Scales of the logarithms, (k,)."""
        return np.array([size.spread for size in self.of])

    def at(self, x: Array) -> tuple[Array, Array]:
        """Return θ and dθ/dx, (..., k) each.  x : (..., k)"""
        tail = normal_share(-np.abs(x))
        root = np.sqrt(np.maximum(4 * tail * (1 - tail), np.finfo(float).tiny))
        square = np.cos(np.arccos(np.minimum(root, 1.0)) / 3) / root - 1
        quantile = 2 * np.sqrt(np.maximum(square, 0.0))
        density = 0.375 * (1 + quantile**2 / 4) ** -2.5
        slope = self.spreads * np.exp(-0.5 * x**2) / np.sqrt(2 * np.pi) / density
        theta = self.spreads * np.sign(x) * quantile
        return np.clip(theta, -_FARTHEST, _FARTHEST), np.where(np.abs(theta) < _FARTHEST, slope, 0.0)
