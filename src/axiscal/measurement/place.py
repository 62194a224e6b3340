"""Where readings are taken: one place, and many of them as columns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

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
    def one(cls, setup: int, pose: Array, approach: Array) -> Places:
        """Return a single place.  pose, approach : (q,)"""
        return cls(np.array([setup], dtype=np.intp), pose[None], approach[None])

    @classmethod
    def of_setup(cls, setup: int, poses: Array, approaches: Array) -> Places:
        """Return places of one set-up.  poses, approaches : (m, q)"""
        return cls(np.full(len(poses), setup, dtype=np.intp), poses, approaches)

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

    def by_setup(self) -> Iterator[tuple[int, NDArray[np.intp]]]:
        """Yield each set-up with the indices of its places."""
        for setup in sorted(set(self.setups.tolist())):  # np.unique would load numpy.ma, a tenth of a second
            yield setup, np.flatnonzero(self.setups == setup)

    def within(self, kept: NDArray[np.bool_] | NDArray[np.intp] | slice) -> Places:
        """Return some of them: those that are kept, or those at indices, in their order."""
        return Places(self.setups[kept], self.poses[kept], self.approaches[kept])

    def at(self, index: int) -> Places:
        """Return one of them."""
        return self.within(np.array([index], dtype=np.intp))

    def without(self, index: int) -> Places:
        """Return all but one of them."""
        return self.within(np.arange(len(self)) != index)

    def exchanged(self, index: int, place: Places) -> Places:
        """Return them with another single place for one of them."""
        result = Places(self.setups.copy(), self.poses.copy(), self.approaches.copy())
        result.setups[index], result.poses[index], result.approaches[index] = (
            place.setups[0],
            place.poses[0],
            place.approaches[0],
        )
        return result

    def moved(self, poses: Array) -> Places:
        """Return the same set-ups and sides at other poses, (m, q)."""
        return replace(self, poses=poses)

    def same_as(self, others: Places) -> bool:
        """Return whether they are the same places in any order."""
        mine, theirs = (np.column_stack([each.setups, each.poses, each.approaches]) for each in (self, others))
        return mine.shape == theirs.shape and bool(np.all(mine[np.lexsort(mine.T)] == theirs[np.lexsort(theirs.T)]))

    def __len__(self) -> int:
        return len(self.setups)
