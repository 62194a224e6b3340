"""The columns G C Gᵀ and G C W C Gᵀ of a plan's readings; a search looks at one reading at a time.

A change of low rank is written down and taken off what is looked at; several are taken off the whole tables together.
"""

from __future__ import annotations

from typing import Self

import numpy as np

from axiscal.numerics import Array
from axiscal.numerics.low_rank import take_off

_WAITING = 48
"""Columns of changes that wait: of speed, not of the result."""


class ReadingColumns:
    """What the candidates see of each of the readings.  cross, reach : (N, w, w, M), reading by reading."""

    def __init__(self, cross: Array, reach: Array) -> None:
        readings, self._width, _, self._count = cross.shape
        self._tables = np.stack([cross, reach]).reshape(2, readings * self._width, -1)
        self._left, self._right, self._waiting = *self._empty(_WAITING), 0

    def copy(self) -> Self:
        """Return a copy that goes its own way."""
        self._settle()
        shape = (-1, self._width, self._width, self._count)
        return type(self)(*(table.reshape(shape) for table in self._tables))

    def of(self, slot: int) -> tuple[Array, Array]:
        """Return G C Gᵀ and G C W C Gᵀ of the candidates and a reading, each (w, w, M), its own numbers first."""
        own = slice(slot * self._width, (slot + 1) * self._width)
        found = self._tables[:, own] - self._left[:, own, : self._waiting] @ self._right[: self._waiting]
        cross, reach = found.reshape(2, self._width, self._width, self._count)
        return cross, reach

    def put(self, slot: int, cross: Array, reach: Array) -> None:
        """Put a reading in the place of another.  cross, reach : (w, w, M)"""
        own = slice(slot * self._width, (slot + 1) * self._width)
        self._left[:, own] = 0.0
        self._tables[:, own] = np.stack([cross, reach]).reshape(2, self._width, -1)

    def change(self, scaled: Array, half: Array, cross: Array) -> None:
        """Take a change off: crossᵀ scaled, and halfᵀ scaled + scaledᵀ half; each (k, w, M + N), as of `Scores`."""
        readings = [each[:, :, self._count :].transpose(2, 1, 0) for each in (scaled, half, cross)]
        mine, far, near = (each.reshape(-1, len(scaled)) for each in readings)
        right = np.concatenate([each[:, :, : self._count].reshape(len(each), -1) for each in (scaled, half)])
        if self._waiting + len(right) > _WAITING:
            self._settle()
            self._left, self._right = self._empty(max(_WAITING, len(right)))
        into = slice(self._waiting, self._waiting + len(right))
        self._left[0, :, into], self._left[1, :, into] = np.hstack([near, np.zeros_like(near)]), np.hstack([far, mine])
        self._right[into], self._waiting = right, into.stop

    def _empty(self, most: int) -> tuple[Array, Array]:
        """Return room for changes that wait."""
        _, rows, columns = self._tables.shape
        return np.zeros((2, rows, most)), np.empty((most, columns))

    def _settle(self) -> None:
        """Take everything off that waits."""
        for table, left in zip(self._tables, self._left, strict=True):
            take_off(table, left[:, : self._waiting], self._right[: self._waiting], table)
        self._waiting = 0
