"""The scales of a model: size and smoothness of each error, what its spline leaves, the scatter of an instrument.

Each is a positive factor on what was stated; the logarithms of all of them are what is estimated. Their own weak priors
share a common part, so that a prior that is wrong everywhere by the same factor is learnt from few readings.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from axiscal.machine.description import Machine
from axiscal.machine.entry import GUESSED_REST, ErrorEntry
from axiscal.machine.plane_entry import PlaneEntry
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

Kind = Literal["std", "length", "rest", "noise"]


class Spread(NamedTuple):
    """Standard deviations of a logarithm: the part that all scales of a kind share, and each one's own."""

    common: float
    own: float


SPREADS: dict[Kind, Spread] = {
    "std": Spread(np.log(4.0), np.log(1.5)),
    "length": Spread(np.log(2.0), np.log(1.5)),
    "rest": Spread(np.log(5.0), np.log(2.0)),
    "noise": Spread(np.log(1.5), np.log(1.2)),
}
"""Weak: two of the common std cover a factor of 16 either way on the size of errors, 4 on their smoothness."""


class Scale(NamedTuple):
    """One scale: its kind, and the error or the set-up that it belongs to; `stated` in m, rad or the axis' unit."""

    kind: Kind
    owner: str
    stated: float


@dataclass(frozen=True, slots=True)
class Scales:
    """The most probable scales: their factors on what was stated, in the order of `of`.

    smoothness : the most probable one of errors whose smoothness is averaged over; None where there are none
    """

    of: tuple[Scale, ...]
    factors: tuple[float, ...]
    smoothness: float | None = None

    def value(self, kind: Kind, owner: str) -> float | None:
        """Return the most probable scale, m, rad or the axis' unit; None where it was not estimated."""
        for scale, factor in zip(self.of, self.factors, strict=True):
            if scale.kind == kind and scale.owner == owner:
                return scale.stated * factor
        return None

    def machine(self, machine: Machine) -> Machine:
        """Return the machine with the priors that these scales make of its own."""
        errors = tuple(self._entry(entry, machine) for entry in machine.errors)
        return replace(machine, errors=errors, planes=tuple(self._plane(entry) for entry in machine.planes))

    def setups(self, setups: Iterable[Setup]) -> tuple[Setup, ...]:
        """Return the set-ups with the noise that these scales make of theirs."""
        return tuple(replace(s, noise=self.value("noise", s.name) or s.noise) for s in setups)

    def _plane(self, entry: PlaneEntry) -> PlaneEntry:
        first, second = (
            self.value("length", owner) or own for owner, own in zip(length_owners(entry), entry.stretch, strict=True)
        )
        return replace(
            entry,
            std=self.value("std", entry.name) or entry.std,
            stretch=(first, second),
            rest=self.value("rest", entry.name) or entry.rest,
        )

    def _entry(self, entry: ErrorEntry, machine: Machine) -> ErrorEntry:
        # The knots stay where they were: a spline does not move because its prior was learnt.
        knots = None if entry.constant else entry.knot_count(machine.axis(entry.axis))
        return replace(
            entry,
            std=self.value("std", entry.name) or entry.std,
            length=self.value("length", entry.name) or entry.length,
            rest=self.value("rest", entry.name) or entry.rest,
            knots=knots,
            spacing=None,
            smoothness=(self.smoothness or entry.smoothness) if entry.smoothness_averaged else entry.smoothness,
        )


def length_owners(entry: ErrorEntry | PlaneEntry) -> tuple[str, str]:
    """Return whose its correlation lengths are: of a plane one along each axis, of a curve its own, named twice."""
    return (entry.along(0), entry.along(1)) if isinstance(entry, PlaneEntry) else (entry.name, entry.name)


def all_scales(machine: Machine, setups: Iterable[Setup]) -> tuple[Scale, ...]:
    """Return every scale that readings could tell something about."""
    noises = (Scale("noise", setup.name, setup.noise) for setup in setups)
    planes = (scale for entry in machine.planes for scale in _of_plane(entry))
    return (*(scale for entry in machine.errors for scale in _scales(entry)), *planes, *noises)


def wanted(machine: Machine) -> tuple[Scale, ...]:
    """Return what the description asks to be learnt: rests, and of curves of each smoothness size and length."""
    curves = [e for e in machine.errors if not e.constant]
    kinds = (Scale("std", e.name, e.std) for e in curves if e.smoothness_averaged)
    lengths = (Scale("length", e.name, e.length) for e in curves if e.smoothness_averaged and e.length is not None)
    rests = (Scale("rest", e.name, e.first_rest) for e in curves if e.rest_estimated)
    return (
        *kinds,
        *lengths,
        *rests,
        *(Scale("rest", e.name, e.first_rest) for e in machine.planes if e.rest_estimated),
    )


def _of_plane(entry: PlaneEntry) -> Iterator[Scale]:
    """Yield the scales of two axes' error: its size, and a factor for the length along each axis."""
    if entry.std:
        yield Scale("std", entry.name, entry.std)
        for owner, side, stretch in zip(length_owners(entry), entry.sides, entry.stretch, strict=True):
            if side.length is not None:
                yield Scale("length", owner, stretch)
    yield Scale("rest", entry.name, entry.rest or GUESSED_REST * entry.std)


def _scales(entry: ErrorEntry) -> Iterator[Scale]:
    yield Scale("std", entry.name, entry.std)
    if not entry.constant:
        if entry.length is not None:
            yield Scale("length", entry.name, entry.length)
        yield Scale("rest", entry.name, entry.rest or GUESSED_REST * entry.std)


def log_prior_precision(scales: tuple[Scale, ...]) -> Array:
    """Return the precision of the logarithms of the factors, whose prior mean is zero, (n, n)."""
    covariance = np.zeros((len(scales), len(scales)))
    for i, first in enumerate(scales):
        for j, second in enumerate(scales):
            if first.kind == second.kind:
                spread = SPREADS[first.kind]
                covariance[i, j] = spread.common**2 + (spread.own**2 if i == j else 0.0)
    precision: Array = np.asarray(np.linalg.inv(covariance), dtype=float)
    return precision
