"""The sizes that readings may teach, as functions of standard normal numbers.

θ = f q(x), x ~ N(0, 1), q the quantile of Student's t of four degrees. In x the prior is exactly normal, so a size of
which readings tell nothing is drawn exactly. With the tail p = Φ(−|x|) and α = 4 p (1 − p) (Shaw 2006, eq. 37)

    q = ±2 √( cos(⅓ φ)/√α − 1 ) = ±2 √( 2 sin(⅔ φ) sin(⅓ φ)/√α ),    φ = arccos √α
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.description.causes import BAD, CYCLE, NOISE
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import normal_share

Kind = Literal["std", "length", "rest", "reversal", "together", "drift", "cycle", "growth", "way", "noise"]
_FARTHEST = 7.0
"""Of |θ|, a factor of a thousand: beyond it lies nothing but overflow."""
_LARGEST: dict[Kind, float] = {"noise": math.log(BAD.size / NOISE.size), "cycle": math.log(BAD.size / CYCLE.size)}
"""Of θ: where either is larger every reading is a bad one, and what they contradict is neither."""
_FARTHEST_X = 30.0
"""Of |x|: its tail of 1e-197 still has a power of 2.5."""


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

    @cached_property
    def _largest(self) -> Array:
        """The largest θ of each size, (k,)."""
        return np.array([_LARGEST.get(size.kind, _FARTHEST) for size in self.of])

    def at(self, x: Array) -> tuple[Array, Array]:
        """Return θ and dθ/dx, (..., k) each.  x : (..., k)"""
        near = np.minimum(np.abs(x), _FARTHEST_X)
        tail = normal_share(-near)
        root = np.sqrt(4 * tail * (1 - tail))
        third = np.arctan2(1 - 2 * tail, root) / 3  # the arc cosine of the root, but exact near x = 0 as well
        theta = self.spreads * np.sign(x) * 2 * np.sqrt(2 * np.sin(2 * third) * np.sin(third) / root)
        density = 0.375 * (root / np.cos(third)) ** 2.5  # since 1 + q²/4 = cos ⅓φ / √α
        slope = self.spreads * np.exp(-0.5 * near**2) / np.sqrt(2 * np.pi) / density
        within = (theta > -_FARTHEST) & (theta < self._largest)
        return np.clip(theta, -_FARTHEST, self._largest), np.where(within, slope, 0.0)


NONE_VARY = Sizes(())
"""All sizes are as stated."""
