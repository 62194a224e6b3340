"""Where readings are taken: one place, and many of them as columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array


@dataclass(frozen=True, slots=True)
class Place:
    """Where one reading is taken.

    setup : name; pose : (n_axes,) m or rad, in chain order
    approach : (n_axes,) from where each axis comes, +1, −1, 0 for any side; left out for any side of all
    """

    setup: str
    pose: tuple[float, ...]
    approach: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class Places:
    """Where many readings are taken.  setups : (m,) indices; poses : (m, q) m or rad; approaches : (m, q) +1, −1, 0."""

    setups: NDArray[np.intp]
    poses: Array
    approaches: Array

    @classmethod
    def none(cls, axes: int) -> Places:
        """Return no places, of a machine with so many axes."""
        return cls(np.zeros(0, dtype=np.intp), np.zeros((0, axes)), np.zeros((0, axes)))

    @classmethod
    def joined(cls, parts: Sequence[Places]) -> Places:
        """Return the places of all parts, one after another; at least one part."""
        columns = zip(*((part.setups, part.poses, part.approaches) for part in parts), strict=True)
        setups, poses, approaches = (np.concatenate(column) for column in columns)
        return cls(setups.astype(np.intp), poses, approaches)

    def of(self, setup: int) -> tuple[Array, Array]:
        """Return poses and approaches of one set-up."""
        mine = self.setups == setup
        return self.poses[mine], self.approaches[mine]

    def within(self, kept: NDArray[np.bool_] | NDArray[np.intp]) -> Places:
        """Return some of them: those that are kept, or those at indices."""
        return Places(self.setups[kept], self.poses[kept], self.approaches[kept])

    def __len__(self) -> int:
        return len(self.setups)
