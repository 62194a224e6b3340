"""The prior covariance of one error's unknowns at scales that readings may teach, and how it changes with length."""

from __future__ import annotations

import numpy as np

from axiscal.error_model.model import Term
from axiscal.error_model.plane import PlaneError
from axiscal.error_model.prior import distances, matern, matern_by_length
from axiscal.machine.entry import ErrorEntry
from axiscal.machine.plane_entry import PlaneEntry
from axiscal.numerics import Array

Entry = ErrorEntry | PlaneEntry


def prior_of(term: Term, entry: Entry, std: float, factors: tuple[float, float]) -> Array:
    """Return s² R of one error, (k, k).  factors : on its correlation lengths, a curve has the first"""
    if isinstance(term, PlaneError):
        return term.prior(std, _stretched(term, factors))
    if term.stated_shape:
        scaled: Array = term.covariance * (std / entry.std) ** 2
        return scaled
    length = _length(entry, factors[0])
    if length is None or term.basis.size == 1:
        return std**2 * np.eye(term.basis.size)
    return std**2 * matern(distances(term.basis) / length, _smoothness(entry))


def by_length(term: Term, entry: Entry, std: float, factors: tuple[float, float], index: int = 0) -> Array:
    """Return its derivative by the logarithm of a correlation length, (k, k).  index : of the axis of a plane"""
    if isinstance(term, PlaneError):
        return term.prior_by_length(std, _stretched(term, factors), index)
    length = _length(entry, factors[0])
    if length is None or term.basis.size == 1 or term.stated_shape:
        return np.zeros((term.basis.size, term.basis.size))
    return std**2 * matern_by_length(distances(term.basis) / length, _smoothness(entry))


def _stretched(plane: PlaneError, factors: tuple[float, float]) -> tuple[float, float]:
    first, second = plane.entry.stretch
    return first * factors[0], second * factors[1]


def _length(entry: Entry, factor: float) -> float | None:
    stated = entry.length if isinstance(entry, ErrorEntry) else None
    return None if stated is None else stated * factor


def _smoothness(entry: Entry) -> float:
    return entry.smoothness if isinstance(entry, ErrorEntry) else entry.sides[0].smoothness
