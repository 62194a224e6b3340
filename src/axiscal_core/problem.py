"""All readings as one linear problem over their noise: y = Z z + v, z ~ N(0, D R(l) D), v ~ N(0, σ²).

D are the sizes and R the correlations of the unknowns; both depend on θ. What does not is applied to Z once. The
columns in order: effects on readings only (drift, cycle, growth), rests of visited cells, what adds to curves,
errors, unknowns of set-ups. The last two are the answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from axiscal_core.columns import Bent, Scale
from axiscal_core.refusals import Array
from axiscal_core.theta import Kind, Sizes

MOST_NUMBERS = 300
"""Numbers of readings up to which their covariance is smaller than that of the unknowns."""


@dataclass(frozen=True, eq=False)
class Problem:
    """rows : (m, p) over the noise, priors without a length applied; values : (m,) over the noise, prior mean taken off

    noise : (m,) base standard deviation of each number, m or rad; reading : (m,) which reading it belongs to
    setup : (m,) index of its set-up; groups : (m,) number of the θ of its noise, −1 where that is exact
    size_at : (p,) number of the θ of each column, −1 for none; curves : the columns whose prior has a length
    roots : of blocks of answered columns whose prior has none: where it begins, and F (q, q)
    scales : of the columns before the answered ones: of axes, and parts of reversals
    answered : number of the columns that are answered, the last ones; mean : (answered,) before any reading
    unknowns : number of those of set-ups, the last of these
    cells : (term, cell) of the columns of rests, from column `first_cell` on
    passing : kinds of the first columns, of what only readings suffer
    type_b : (m, c) over the noise, what one standard deviation of each cause of type B does; causes : these, as who
        made the problem has them; judging : (c,) which of them judge readings: those that do not follow from these
    """

    rows: Array
    values: Array
    noise: Array
    reading: NDArray[np.intp]
    setup: NDArray[np.intp]
    groups: NDArray[np.intp]
    sizes: Sizes
    size_at: NDArray[np.intp]
    curves: tuple[Bent, ...]
    roots: tuple[tuple[int, Array], ...]
    scales: tuple[Scale, ...]
    answered: int
    unknowns: int
    mean: Array
    cells: tuple[tuple[int, int], ...]
    first_cell: int
    cell_roots: tuple[Array, ...]
    passing: tuple[Kind, ...]
    type_b: Array
    causes: tuple[Any, ...]
    judging: NDArray[np.bool_]

    @property
    def first(self) -> int:
        """The first column of which answered unknowns are made."""
        return int(self.rows.shape[1]) - self.answered - len(self.scales)

    def only(self, kept: NDArray[np.bool_]) -> Problem:
        """Return the problem with some of its numbers.  kept : (m,)"""
        names = ("rows", "values", "noise", "reading", "setup", "groups", "type_b")
        return replace(self, **{name: getattr(self, name)[kept] for name in names})

    @property
    def own(self) -> int:
        """The first column that is answered; what adds to curves stands before it."""
        return self.first + len(self.scales)

    def wider(self, columns: Array, kind: Kind = "drift") -> Problem:
        """Return the problem with more columns of standard deviation one, before all others: of zeros, or a kind.

        columns : (k, m) over the noise
        """
        more = len(columns)
        return replace(
            self,
            rows=np.vstack([columns, self.rows.T]).T,
            size_at=np.concatenate([np.full(more, -1), self.size_at]).astype(np.intp),
            curves=tuple(replace(each, columns=each.columns + more) for each in self.curves),
            roots=tuple((start + more, root) for start, root in self.roots),
            first_cell=self.first_cell + more,
            passing=(kind,) * more + self.passing,
        )

    def raw(self, whitened: Array, theta: Array, roots: Sequence[Array]) -> Array:
        """Return answered unknowns in m and rad from whitened ones, (answered, ...): L D u.

        whitened : (scales + answered, ...); roots : of the curves at θ
        """
        sized = self._sized(whitened, theta)
        result = self._rooted(sized[len(self.scales) :], roots)
        for scale, each in zip(self.scales, sized[: len(self.scales)], strict=True):
            result[scale.part] += scale.ramp.reshape(-1, *[1] * (result.ndim - 1)) * each
        return result

    def whitened(self, figures: Array, theta: Array, roots: Sequence[Array]) -> Array:
        """Return what figures of answered unknowns are of whitened ones: D Lᵀ f, (scales + answered, ...).

        figures : (answered, ...), m and rad
        """
        back = self._rooted(figures, [lower.transpose(0, 2, 1) for lower in roots], turned=True)
        scales = [(scale.ramp @ figures[scale.part])[None] for scale in self.scales]
        return self._sized(np.concatenate([*scales, back]), theta)

    def _sized(self, whitened: Array, theta: Array) -> Array:
        """Return D u, with the size of each column.  whitened : (scales + answered, ...)"""
        factors = np.exp(np.append(theta, 0.0)[self.size_at[self.first :]])
        return np.asarray(factors.reshape(-1, *[1] * (whitened.ndim - 1)) * whitened)

    def _rooted(self, own: Array, roots: Sequence[Array], *, turned: bool = False) -> Array:
        """Return L u of answered columns.  own : (answered, ...); turned : roots that do not vary count as Lᵀ"""
        result = own.copy()
        for start, root in self.roots:
            part = slice(start - self.own, start - self.own + len(root))
            result[part] = (root.T if turned else root) @ own[part]
        for curves, lower in zip(self.curves, roots, strict=True):
            flat = own[curves.columns - self.own]
            shape = (*flat.shape[:2], -1)
            result[curves.columns - self.own] = (lower @ flat.reshape(shape)).reshape(flat.shape)
        return result


def by_blocks(rows: Array, roots: Sequence[Array]) -> Array:
    """Return rows times a block-diagonal matrix, (m, n)."""
    result, start = np.empty_like(rows), 0
    for root in roots:
        part = slice(start, start + len(root))
        result[:, part] = rows[:, part] @ root
        start += len(root)
    return result
