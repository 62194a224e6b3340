"""Both forms of the gain along lines, from the products of a line's few fixed vectors with each other.

What a number sees at a position is pᵀV with the fixed vectors V (l, r + w) of its line, so gᵀCg = pᵀ(V Vᵀ)p over the
first r of their entries and gᵀCWCg the same over the others: two matrices (l, l) in place of l vectors. Visited cells
add E to the vectors of the levers λ, which are the first of p, and pᵀ(V + E)(V + E)ᵀp = pᵀV Vᵀp + λᵀ(2 E Vᵀp + E Eᵀλ).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.design.step.cell_rests import Rests
from axiscal.numerics import Array


class _InCells(NamedTuple):
    """Positions in visited cells.

    mine : (h,) which of all; group : (h,) index of what they see there
    above, below : by group, (g, levers of all numbers, vectors of all) what is added to half of each form
    """

    mine: NDArray[np.intp]
    group: NDArray[np.intp]
    above: Array
    below: Array


class LineForms:
    """N and M of readings along several lines.

    vectors : by number, (lines, l, r + w), those of its levers first, so many as `levers`; rank : r
    """

    def __init__(self, vectors: list[Array], levers: int, rests: Rests, rank: int) -> None:
        ends = np.cumsum([each.shape[1] for each in vectors]).tolist()
        self._numbers = [slice(*each) for each in zip([0, *ends[:-1]], ends, strict=True)]
        self._vectors = vectors[0] if len(vectors) == 1 else np.concatenate(vectors, axis=1)
        self._levers = np.concatenate([np.arange(own.start, own.start + levers) for own in self._numbers])
        self._count, self._rests, self._rank = levers, rests, rank
        self._above, self._below = (part @ part.swapaxes(1, 2) for part in (self._far, self._near))
        self._below[:, self._levers[:, None], self._levers] += rests.fresh

    @property
    def lines(self) -> int:
        """How many lines there are."""
        return len(self._above)

    @property
    def _near(self) -> Array:
        return self._vectors[..., : self._rank]

    @property
    def _far(self) -> Array:
        return self._vectors[..., self._rank :]

    def at(self, along: list[Array], positions: Array, line: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return N and M without the noise of each number's own, each (b, k, numbers, numbers).

        along : by number, (b, k, l) how much of each vector is seen; positions : (b, k); line : (b,)
        """
        above, below = np.empty((2, *positions.shape, len(along), len(along)))
        visits = self._visits(positions, line) if self._rests.shown else None
        for form, products in ((above, self._above), (below, self._below)):
            mine = products[line]
            for i, own in enumerate(self._numbers):
                for j, other in enumerate(self._numbers[: i + 1]):
                    seen = np.einsum("bkl,bkl->bk", along[i] @ mine[:, own, other], along[j])
                    form[..., i, j] = form[..., j, i] = seen
        if visits is not None:
            self._add(along, visits, above, below)
        return above, below

    def _add(self, along: list[Array], visits: _InCells, above: Array, below: Array) -> None:
        """Add what visited cells do to both forms, in place."""
        seen = [each.reshape(-1, each.shape[-1])[visits.mine] for each in along]
        where, count = np.divmod(visits.mine, above.shape[1]), len(along)
        for form, added in ((above, visits.above), (below, visits.below)):
            for i in range(count):
                own = slice(i * self._count, (i + 1) * self._count)
                for j, other in enumerate(self._numbers):
                    half = added[visits.group, own, other] @ seen[j][:, :, None]
                    half = np.einsum("hl,hl->h", half[..., 0], seen[i][:, : self._count])
                    form[(*where, i, j)] += half
                    form[(*where, j, i)] += half

    def _visits(self, positions: Array, line: NDArray[np.intp]) -> _InCells | None:
        """Return the positions in visited cells and what these add there; None where there are none."""
        owner = np.repeat(line, positions.shape[1])
        columns = self._rests.visited(positions.ravel(), owner)
        mine = np.flatnonzero(np.any(columns >= 0, axis=1))
        if not len(mine):
            return None
        keys, group = np.unique(np.column_stack([owner, columns])[mine], axis=0, return_inverse=True)
        lines, added = keys[:, 0], self._rests.seen(keys[:, 0], keys[:, 1:])
        near, far = added[..., : self._rank], added[..., self._rank :]
        products = np.empty((2, *added.shape[:2], self._vectors.shape[1]))
        for one in np.unique(lines):
            here = lines == one
            products[0, here] = far[here] @ self._far[one].T
            products[1, here] = near[here] @ self._near[one].T
        products[0][..., self._levers] += far @ far.swapaxes(1, 2) / 2
        products[1][..., self._levers] += near @ near.swapaxes(1, 2) / 2
        products[1][..., self._levers] -= self._rests.closed(lines, keys[:, 1:]) / 2
        return _InCells(mine, group.ravel(), *products)
