"""The sizes of a case that readings may teach."""

from __future__ import annotations

import math

from axiscal_core.model import Model
from axiscal_core.terms import Term
from axiscal_core.theta import MANY, SURE, Kind, Size, Sizes

FACTORS: dict[Kind, float] = {
    "std": 3.0, "length": 2.5, "scale": 3.0, "reversal": 3.0, "rest": 5.0, "drift": 4.0, "cycle": 4.0, "growth": 4.0,
    "way": 6.0, "noise": 2.0,
}  # fmt: skip
"""Within which each is known, at most: 38 measured curves, nine ISO 230-2 tests, and assumptions for the last three."""


def sizes_of(case: Model, readings: int = MANY) -> Sizes:
    """Return the sizes of a case that so many readings may teach."""
    kinds: tuple[Kind, ...] = ("std", "length", "scale", "reversal")
    found = [size for kind in kinds for size in _of_errors(case, kind)]
    if case.usual:
        found += [Size("rest", owners, math.log(FACTORS["rest"])) for owners in _rests(case)]
        passing: tuple[Kind, ...] = ("drift", "cycle", "growth")
        found += [Size(kind, tuple(case.setups), math.log(FACTORS[kind])) for kind in passing]
        turning = tuple(term.name for term in case.machine.curves if term.kind == "reversal" and term.linear)
        found += [Size("way", turning, math.log(FACTORS["way"]))] if turning else []
    if case.usual or case.sure != "exactly":
        found += [Size("noise", (name,), math.log(FACTORS["noise"])) for name in case.setups]
    return Sizes(tuple(found), min(1.0, readings / MANY))


def _of_errors(case: Model, kind: Kind) -> list[Size]:
    """Return the sizes of one kind: one for errors that are alike and as surely known."""
    groups = dict[tuple[float, tuple[bool, ...]], list[str]]()
    for term in case.machine.curves:
        alike, factor = _alike(term, kind), min(SURE[term.error.sure or case.sure], FACTORS[kind])
        if alike is not None and factor > 1:
            groups.setdefault((factor, alike), []).append(term.name)
    return [Size(kind, tuple(names), math.log(factor)) for (factor, _), names in groups.items()]


def _alike(term: Term, kind: Kind) -> tuple[bool, ...] | None:
    """Return what errors have in common that share a size; None where an error has no such size."""
    if term.kind != ("reversal" if kind == "reversal" else "motion"):
        return None
    if kind == "scale":
        return (term.linear,) if term.ramp is not None else None
    if kind == "length":
        return (term.linear,) if term.length is not None else None
    return (term.linear, term.angular, term.error.repeats)


def _rests(case: Model) -> list[tuple[str, ...]]:
    groups = dict[bool, list[str]]()
    for term in case.machine.curves:
        if term.rest:
            groups.setdefault(term.linear, []).append(term.name)
    return [tuple(names) for names in groups.values()]
