"""Sizes that readings may teach: a factor exp θ on what is stated, of all errors or set-ups that are alike.

    θ = f (x - x₀),    x ~ N(0, 1),    f the logarithm of the factor within which the size is known

The stated size is the median, x₀ = 0. Of a reversal, a scale, drift, cycle and growth it is the root mean square,
x₀ = f: a size without readings adds the variance that is stated.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np

from axiscal_core.errors import Curved, Sure
from axiscal_core.model import Model
from axiscal_core.refusals import Array

Kind = Literal["std", "length", "scale", "reversal", "rest", "drift", "cycle", "growth", "way", "noise"]
SURE: dict[Sure, float] = {"roughly": 3.0, "well": 1.5, "exactly": 1.0}
FACTORS: dict[Kind, float] = {
    "std": 3.0, "length": 2.5, "scale": 3.0, "reversal": 3.0, "rest": 5.0, "drift": 4.0, "cycle": 4.0, "growth": 4.0,
    "way": 6.0, "noise": 2.0,
}  # fmt: skip
"""Within which each is known, at most: 38 measured curves, nine ISO 230-2 tests, and assumptions for the last three."""
_ROOTS = frozenset({"scale", "reversal", "drift", "cycle", "growth"})
_FARTHEST = 7.0  # of θ, a factor of a thousand: beyond it lies nothing but overflow
_LARGEST: dict[Kind, float] = {
    "length": _FARTHEST, "noise": math.log(30), "cycle": math.log(60), "drift": math.log(30), "growth": math.log(30)
}  # fmt: skip
_MOST = math.log(10.0)  # of θ of others: what would have to be ten times as large contradicts


class Size(NamedTuple):
    """One size.  owners : errors or set-ups by name; spread : f"""

    kind: Kind
    owners: tuple[str, ...]
    spread: float


class Sizes:
    """All sizes of a case, in the order of θ."""

    def __init__(self, of: list[Size]) -> None:
        self.of = of
        self._index = {(size.kind, owner): i for i, size in enumerate(of) for owner in size.owners}
        self.spreads = np.array([size.spread for size in of])
        self.stated = np.array([size.spread if size.kind in _ROOTS else 0.0 for size in of])
        self.largest = np.array([_LARGEST.get(size.kind, _MOST) for size in of])

    def __len__(self) -> int:
        return len(self.of)

    def index(self, kind: Kind, owner: str) -> int:
        """Return the number of a size; -1 where it is exact."""
        return self._index.get((kind, owner), -1)

    def theta(self, x: Array) -> tuple[Array, Array]:
        """Return θ and dθ/dx.  x : (..., k)"""
        theta = self.spreads * (x - self.stated)
        inside = (theta > -_FARTHEST) & (theta < self.largest)
        return np.clip(theta, -_FARTHEST, self.largest), np.where(inside, self.spreads, 0.0)


def sizes_of(case: Model) -> Sizes:
    """Return the sizes of a case."""
    kinds: tuple[Kind, ...] = ("std", "length", "scale", "reversal")
    found = [size for kind in kinds for size in _of_errors(case, kind)]
    if case.usual:
        found += [Size("rest", owners, math.log(FACTORS["rest"])) for owners in _rests(case)]
        passing: tuple[Kind, ...] = ("drift", "cycle", "growth")
        found += [Size(kind, tuple(case.setups), math.log(FACTORS[kind])) for kind in passing]
        turning = tuple(term.name for _, term in case.machine.curves if term.error.kind == "reversal" and term.linear)
        found += [Size("way", turning, math.log(FACTORS["way"]))] if turning else []
    if case.usual or case.sure != "exactly":
        found += [Size("noise", (name,), math.log(FACTORS["noise"])) for name in case.setups]
    return Sizes(found)


def _of_errors(case: Model, kind: Kind) -> list[Size]:
    """Return the sizes of one kind: one for errors that are alike and as surely known."""
    groups = dict[tuple[float, tuple[bool, ...]], list[str]]()
    for _, term in case.machine.curves:
        alike, factor = _alike(term, kind), min(SURE[term.error.sure or case.sure], FACTORS[kind])
        if alike is not None and factor > 1:
            groups.setdefault((factor, alike), []).append(term.name)
    return [Size(kind, tuple(names), math.log(factor)) for (factor, _), names in groups.items()]


def _alike(term: Curved, kind: Kind) -> tuple[bool, ...] | None:
    """Return what errors have in common that share a size; None where an error has no such size."""
    if term.error.kind != ("reversal" if kind == "reversal" else "motion"):
        return None
    if kind == "scale":
        return (term.linear,) if term.ramp is not None else None
    if kind == "length":
        return (term.linear,) if term.length is not None else None
    return (term.linear, term.error.component >= 3, term.error.period is not None)


def _rests(case: Model) -> list[tuple[str, ...]]:
    groups = dict[bool, list[str]]()
    for _, term in case.machine.curves:
        if term.rest:
            groups.setdefault(term.linear, []).append(term.name)
    return [tuple(names) for names in groups.values()]
