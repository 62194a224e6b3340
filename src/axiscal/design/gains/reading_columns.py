"""The columns G C Gᵀ and G C W C Gᵀ of the readings of a plan, of which a search looks at one reading at a time.

A change of low rank is written down and taken off what is looked at; several are taken off the whole tables together,
16 m k bytes for all of them in place of each.
"""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.numerics.low_rank import take_off

_WAITING = 48
"""Columns of changes that wait: of speed, not of the result."""
_EVERY = slice(None)


class ReadingColumns:
    """Each column lies in one piece, that a look reads no more than its own.

    cross, reach : (numbers, k) rows of all candidates and readings times those columns.
    count : how many of the numbers are of candidates; those of the readings follow, in the order of the columns
    """

    def __init__(self, cross: Array, reach: Array, count: int) -> None:
        self._columns, self._count, self._waiting = np.vstack([cross.T, reach.T]), count, 0
        self._left, self._right = np.zeros((0, 0)), np.zeros((0, 0))
        self._wait()

    @property
    def size(self) -> int:
        """How many columns each table has."""
        return len(self._columns) // 2

    def copy(self) -> Self:
        """Return a copy that goes its own way."""
        self._settle()
        return type(self)(self._columns[: self.size].T, self._columns[self.size :].T, self._count)

    def of(self, own: slice, numbers: slice = _EVERY) -> tuple[Array, Array]:
        """Return some columns of both tables for all numbers or for some, each (numbers, k)."""
        columns = self._both(own)
        found: Array = self._columns[columns, numbers]
        if self._waiting:
            found -= self._right[: self._waiting, columns].T @ self._left[numbers, : self._waiting].T
        cross, reach = np.split(found, 2)
        return cross.T.copy(), reach.T.copy()

    def put(self, own: slice, cross: Array, reach: Array) -> None:
        """Put the columns of some readings in, (numbers, k), and their rows with them."""
        here, columns, size = slice(self._count + own.start, self._count + own.stop), self._both(own), self.size
        self._left[here], self._right[:, columns] = 0.0, 0.0
        self._columns[columns] = np.vstack([cross.T, reach.T])
        self._columns[:size, here], self._columns[size:, here] = cross[self._count :], reach[self._count :]

    def change(self, scaled: Array, half: Array, cross: Array) -> None:
        """Take a change off: scaled times crossᵀ, and scaled times halfᵀ + half times scaledᵀ; each (numbers, k)."""
        mine = slice(self._count, None)
        left, nothing = np.hstack([scaled, half]), np.zeros_like(cross[mine].T)
        right = np.block([[cross[mine].T, half[mine].T], [nothing, scaled[mine].T]])
        if self._waiting + len(right) > _WAITING:
            self._settle()
        if len(right) > _WAITING:
            self._take_off(left, right)
            return
        into = slice(self._waiting, self._waiting + len(right))
        self._left[:, into], self._right[into], self._waiting = left, right, into.stop

    def room(self, start: int, count: int) -> None:
        """Make room for so many columns, and rows, at an index."""
        self._settle()
        at = np.full(count, start)
        longer = np.insert(self._columns, self._count + at, 0.0, axis=1)
        self._columns = np.ascontiguousarray(np.insert(longer, np.concatenate([at, self.size + at]), 0.0, axis=0))
        self._wait()

    def cut(self, own: slice) -> None:
        """Take out some columns, and rows."""
        self._settle()
        shorter = np.delete(self._columns, slice(self._count + own.start, self._count + own.stop), axis=1)
        self._columns = np.ascontiguousarray(np.delete(shorter, self._both(own), axis=0))
        self._wait()

    def _wait(self) -> None:
        """Make room for changes that wait."""
        columns, rows = self._columns.shape
        self._left, self._right = np.zeros((rows, _WAITING)), np.zeros((_WAITING, columns))

    def _both(self, own: slice) -> NDArray[np.intp]:
        at = np.arange(own.start, own.stop)
        return np.concatenate([at, self.size + at])

    def _settle(self) -> None:
        """Take everything off that waits."""
        if self._waiting:
            self._take_off(self._left[:, : self._waiting], self._right[: self._waiting])
            self._waiting = 0

    def _take_off(self, left: Array, right: Array) -> None:
        take_off(self._columns, np.ascontiguousarray(right.T), left.T, self._columns)
