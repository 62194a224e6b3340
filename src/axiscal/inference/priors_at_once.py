"""The prior covariances of all errors at scales that readings may teach: those of curves that are alike in one go."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.model import ErrorFunction, Term
from axiscal.error_model.prior import distances, matern, matern_by_length
from axiscal.inference.error_priors import Entry, by_length, prior_of
from axiscal.inference.scales import Kind, length_owners
from axiscal.machine.entry import ErrorEntry
from axiscal.numerics import Array

_OF_CURVES: tuple[Kind, Kind] = "std", "length"


class _CurvesAlike(NamedTuple):
    """Curves of one smoothness with as many knots.

    stds, lengths : (f,) as stated, m or rad; std_at, length_at : (f,) of the logarithms of their factors
    distances : (f, k, k) between their knots
    """

    names: tuple[str, ...]
    smoothness: float
    stds: Array
    std_at: NDArray[np.intp]
    lengths: Array
    length_at: NDArray[np.intp]
    distances: Array

    def at(self, factors: Array) -> tuple[Array, Array]:
        """Return s² and distances in correlation lengths, (f, 1, 1) and (f, k, k).  factors : (n + 1,), last 1"""
        stds = (self.stds * factors[self.std_at]).tolist()
        lengths = self.lengths * factors[self.length_at]
        return np.array([std**2 for std in stds])[:, None, None], self.distances / lengths[:, None, None]


def _by_length(function: ErrorFunction, entry: ErrorEntry) -> bool:
    """Return whether values of a curve go together by how far they are from each other."""
    return entry.length is not None and function.basis.size > 1 and not function.stated_shape


class PriorsAtOnce:
    """Priors by the name of an error.

    terms : the errors; entries : what is stated of them, by name; index : where the logarithm of a scale is
    """

    def __init__(
        self, terms: Sequence[Term], entries: Mapping[str, Entry], index: Mapping[tuple[Kind, str], int]
    ) -> None:
        self._entries, self._index = entries, index
        groups: dict[tuple[int, float], list[ErrorFunction]] = {}
        self._others = list[Term]()
        for term in terms:
            entry = entries[term.name]
            if isinstance(term, ErrorFunction) and isinstance(entry, ErrorEntry) and _by_length(term, entry):
                groups.setdefault((term.basis.size, entry.smoothness), []).append(term)
            else:
                self._others.append(term)
        self._alike = [self._of(smoothness, curves) for (_, smoothness), curves in groups.items()]

    def _of(self, smoothness: float, curves: Sequence[ErrorFunction]) -> _CurvesAlike:
        names = tuple(curve.name for curve in curves)
        entries = [self._entries[name] for name in names]
        stated = ([e.std for e in entries], [e.length for e in entries if isinstance(e, ErrorEntry)])
        stds, lengths = (np.array(each, dtype=float) for each in stated)
        std_at, length_at = (np.array([self._index.get((kind, name), -1) for name in names]) for kind in _OF_CURVES)
        return _CurvesAlike(
            names, smoothness, stds, std_at, lengths, length_at, np.array([distances(c.basis) for c in curves])
        )

    def at(self, logs: Array) -> dict[str, Array]:
        """Return s² R of each error, (k, k).  logs : (n,) of the factors"""
        factors, found = np.append(np.exp(logs), 1.0), dict[str, Array]()
        for alike in self._alike:
            squares, apart = alike.at(factors)
            found.update(zip(alike.names, squares * matern(apart, alike.smoothness), strict=True))
        found.update((term.name, self.of(term, logs)) for term in self._others)
        return found

    def by_length(self, logs: Array) -> dict[str, list[tuple[int, Array]]]:
        """Return ∂(s² R)/∂log θ (k, k) of each error by each of its lengths that varies, with the number of that."""
        factors, found = np.append(np.exp(logs), 1.0), dict[str, list[tuple[int, Array]]]()
        for alike in self._alike:
            squares, apart = alike.at(factors)
            each = squares * matern_by_length(apart, alike.smoothness) if np.any(alike.length_at >= 0) else squares
            of = zip(alike.names, alike.length_at.tolist(), each, strict=True)
            found.update((name, [(at, slope)] if at >= 0 else []) for name, at, slope in of)
        found.update((term.name, self.of_by_length(term, logs)) for term in self._others)
        return found

    def of(self, term: Term, logs: Array) -> Array:
        """Return s² R of one error alone."""
        return prior_of(term, *self._scales_of(term.name, logs))

    def of_by_length(self, term: Term, logs: Array) -> list[tuple[int, Array]]:
        """Return the derivatives of one error alone."""
        scales = self._scales_of(term.name, logs)
        owners = enumerate(dict.fromkeys(length_owners(scales[0])))
        known = ((number, self._index.get(("length", owner))) for number, owner in owners)
        return [(at, by_length(term, *scales, number)) for number, at in known if at is not None]

    def _scales_of(self, name: str, logs: Array) -> tuple[Entry, float, tuple[float, float]]:
        """Return an error's entry, its std, and the factors on its lengths."""
        entry = self._entries[name]
        first, second = (self._factor("length", owner, logs) for owner in length_owners(entry))
        return entry, entry.std * self._factor("std", name, logs), (first, second)

    def _factor(self, kind: Kind, owner: str, logs: Array) -> float:
        index = self._index.get((kind, owner))
        return 1.0 if index is None else float(np.exp(logs[index]))
