"""The columns of what is answered, errors and then unknowns of set-ups, with their priors; those that add to curves.

Of some the prior depends on a length that readings may teach.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal_core.eigen import unique_root
from axiscal_core.machine import Machine
from axiscal_core.refusals import Array
from axiscal_core.splines import distances, matern, matern_by_length
from axiscal_core.terms import Term, covariance
from axiscal_core.theta import Kind, Sizes

NUGGET = 1e-9
"""Added to correlations of one: long lengths make knots nearly equal, and Cholesky needs more than rounding."""


@dataclass(frozen=True, eq=False)
class Bent(ABC):
    """Columns whose prior depends on a length.  columns : (f, k); length_at : (f,) number of θ, −1 for none"""

    columns: NDArray[np.intp]
    length_at: NDArray[np.intp]

    @abstractmethod
    def roots(self, theta: Array) -> Array:
        """Return L with L Lᵀ the prior, (f, k, k)."""

    @abstractmethod
    def bends(self, theta: Array, roots: Array) -> Array:
        """Return M = L⁻¹ (∂ prior/∂log l) L⁻ᵀ, (f, k, k)."""


@dataclass(frozen=True, eq=False)
class Curves(Bent):
    """Curves with as many knots and one smoothness, whose control values go together by their distance.

    stds, lengths : (f,) as stated; apart : (f, k, k) between knots
    """

    smoothness: float
    stds: Array
    lengths: Array
    apart: Array

    def scaled(self, theta: Array) -> Array:
        """Return the distances in correlation lengths, (f, k, k)."""
        factors = np.exp(np.append(theta, 0.0)[self.length_at])
        return np.asarray(self.apart / (self.lengths * factors)[:, None, None])

    def roots(self, theta: Array) -> Array:
        """Return L with L Lᵀ = s² R(l), (f, k, k)."""
        correlation = matern(self.scaled(theta), self.smoothness)
        diagonal = np.arange(correlation.shape[1])
        correlation[:, diagonal, diagonal] += NUGGET
        return np.linalg.cholesky(correlation) * self.stds[:, None, None]

    def bends(self, theta: Array, roots: Array) -> Array:
        """Return M = L⁻¹ (∂ s² R/∂log l) L⁻ᵀ, (f, k, k)."""
        slope = matern_by_length(self.scaled(theta), self.smoothness) * self.stds[:, None, None] ** 2
        half = np.linalg.solve(roots, slope)
        return np.linalg.solve(roots, half.transpose(0, 2, 1))


@dataclass(frozen=True, eq=False)
class Scale:
    """What adds to a curve: the scale of a linear axis, or a part of a reversal that comes over a way.

    kind : of its size; part : of the answered unknowns; ramp : (n,) m, what one standard deviation adds
    """

    kind: Kind
    part: slice
    ramp: Array


@dataclass(frozen=True, eq=False)
class PlaneUnknowns(Bent):
    """The products of one error of two axes, whose lengths go by one factor, as one member."""

    plane: Term

    def roots(self, theta: Array) -> Array:
        """Return L with L Lᵀ the prior at the lengths, (1, c, c)."""
        spread = self.plane.prior(self.plane.std, self._stretch(theta))
        # a share of the stated variance: at many times the length the covariance itself is rounding
        spread[np.diag_indices_from(spread)] += NUGGET * self.plane.std**2
        return np.asarray(np.linalg.cholesky(spread))[None]

    def bends(self, theta: Array, roots: Array) -> Array:
        """Return M = L⁻¹ (∂ prior/∂log l) L⁻ᵀ, (1, c, c)."""
        first, second = (self.plane.prior(self.plane.std, self._stretch(theta), k) for k in (0, 1))
        half = np.linalg.solve(roots[0], first + second)
        return np.linalg.solve(roots[0], half.T)[None]

    def _stretch(self, theta: Array) -> tuple[float, ...]:
        factor = float(np.exp(np.append(theta, 0.0)[self.length_at[0]]))
        return tuple(each * factor for each in self.plane.error.stretch)


class Priors(NamedTuple):
    """Of answered columns, counted among all of a problem.

    size_at : (answered,) number of the θ of each; curves : whose prior has a length; roots : of the others, and where
    """

    size_at: NDArray[np.intp]
    curves: tuple[Bent, ...]
    roots: tuple[tuple[int, Array], ...]

    def apply(self, own: Array, start: int) -> None:
        """Multiply answered columns by the roots of their priors, in place.  own : (m, answered), `start` the first"""
        for at, root in self.roots:
            part = slice(at - start, at - start + len(root))
            own[:, part] = own[:, part] @ root


def priors_of(
    machine: Machine, sizes: Sizes, stds: Sequence[float], start: int, inherited: Array | None = None
) -> Priors:
    """Return the priors of a machine's errors, and of unknowns of set-ups.

    stds : of these; start : where they begin among all columns; inherited : covariance of the errors that is left
    """
    size_at, roots = np.full(machine.size + len(stds), -1, dtype=np.intp), list[tuple[int, Array]]()
    by_kind, curves = dict[tuple[int, float], list[Term]](), list[Bent]()
    if inherited is not None:
        roots.append((start, unique_root(inherited)))
    for term in machine.terms if inherited is None else ():
        plane = len(term.sides) > 1
        kind: Kind = "together" if plane else "reversal" if term.kind == "reversal" else "std"
        size_at[term.columns] = sizes.index(kind, term.name)
        if term.length is not None:
            by_kind.setdefault((term.spline.size, term.error.smoothness), []).append(term)
        elif plane and (length := sizes.index("length", term.name)) >= 0:
            columns = np.arange(term.columns.start, term.columns.stop)[None] + start
            curves.append(PlaneUnknowns(columns, np.array([length]), term))
        else:  # the scale of its axis has a column
            bare = covariance(replace(term.error, scale=None), term.spline) if term.error.scale else term.covariance
            roots.append((start + term.columns.start, unique_root(bare)))
    others = machine.parts[len(machine.terms) :] if inherited is None else ()
    roots += [(start + part.columns.start, unique_root(part.covariance)) for part in others]
    roots += [(start + machine.size + i, np.array([[std]])) for i, std in enumerate(stds)]
    for (_, smoothness), members in by_kind.items():
        curves.append(_curves(members, sizes, smoothness, start))
    return Priors(size_at, tuple(curves), tuple(roots))


def _curves(terms: Sequence[Term], sizes: Sizes, smoothness: float, start: int) -> Curves:
    return Curves(
        np.array([np.arange(term.columns.start, term.columns.stop) + start for term in terms]),
        sizes.indices("length", [term.name for term in terms]),
        smoothness,
        np.array([term.std for term in terms]),
        np.array([term.length for term in terms], dtype=float),
        np.array([distances(term.spline) for term in terms]),
    )
