"""θ: logarithms of sizes that readings may teach, each a factor exp θ on what is stated of all that are alike.

    θ = f (x - x₀),    x ~ N(0, 1),    f the logarithm of the factor within which the size is known

The stated size is the median, x₀ = 0. Of a reversal, a scale, drift, cycle and growth it is the root mean square,
x₀ = f: a size without readings adds the variance that is stated.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal_core.refusals import Array

Sure = Literal["roughly", "well", "exactly"]
"""How well stated sizes are known: to a factor of 3, of 1.5, exactly."""
SURE: dict[Sure, float] = {"roughly": 3.0, "well": 1.5, "exactly": 1.0}
Kind = Literal["std", "length", "scale", "rest", "reversal", "together", "drift", "cycle", "growth", "way", "noise"]
_ROOTS: frozenset[Kind] = frozenset({"scale", "reversal", "drift", "cycle", "growth"})
"""Kinds whose stated size is a root mean square: one number, or one afternoon, tells of them."""
_FARTHEST = 7.0  # of |θ|, a factor of a thousand: beyond it lies nothing but overflow
_LARGEST: dict[Kind, float] = {
    "length": _FARTHEST, "noise": math.log(30), "cycle": math.log(60),
    "drift": math.log(30), "growth": math.log(30), "way": math.log(60),
}  # fmt: skip
"""Of θ: where noise or cycle are larger every reading is a bad one, of 30 noises, and what they contradict is neither.

Nobody states what passes while a machine is read: one of nine ISO 230-2 tests has 19 times the usual drift. Where a way
is 60 times as large, a part of a reversal is 3.6 times as large as the whole is stated.
"""
MANY = 12  # readings: fewer say that a size is worse than stated, and hardly that it is better
_MOST = math.log(10.0)  # of θ of other sizes: what would have to be more than ten times as large as stated contradicts


class Size(NamedTuple):
    """One size: a factor exp(θ) on what all its owners state.

    owners : errors or set-ups by name, in their order; spread : f
    """

    kind: Kind
    owners: tuple[str, ...]
    spread: float


@dataclass(frozen=True)
class Sizes:
    """All sizes that vary, in the order of θ.  share : of θ where that is better than stated, readings over `MANY`"""

    of: tuple[Size, ...]
    share: float = 1.0

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
    def stated(self) -> Array:
        """x of the sizes as stated, (k,)."""
        return np.array([size.spread if size.kind in _ROOTS else 0.0 for size in self.of])

    @cached_property
    def _largest(self) -> Array:
        """The largest θ of each size, (k,)."""
        return np.array([_LARGEST.get(size.kind, _MOST) for size in self.of])

    def theta(self, x: Array) -> tuple[Array, Array]:
        """Return θ and dθ/dx, (..., k) each.  x : (..., k)"""
        theta = self.spreads * (x - self.stated)
        within = (theta > -_FARTHEST) & (theta < self._largest)
        share = np.where(np.multiply([1 if s.kind == "length" else -1 for s in self.of], theta) > 0, self.share, 1.0)
        return share * np.clip(theta, -_FARTHEST, self._largest), np.where(within, share * self.spreads, 0.0)
