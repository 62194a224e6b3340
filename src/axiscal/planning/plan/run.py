"""The readings of one set-up in their order, and what any candidate between them would take more."""

from __future__ import annotations

import copy
from typing import Self

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.measurement.travel import reading_seconds, way_seconds
from axiscal.numerics import Array
from axiscal.numerics.short_way import shortened
from axiscal.planning.plan.order import counting, out_and_back, returns
from axiscal.planning.plan.task import Task


class Ways:
    """Seconds between places and candidates, each found once.

    lattice : candidates sorted by set-up; of : the indices of those of each set-up
    """

    def __init__(self, task: Task, lattice: Places) -> None:
        self.task, self.lattice, self.of = task, lattice, dict(lattice.by_setup())
        self._known = dict[bytes, tuple[Array, Array]]()

    def seconds(self, start: Places, stop: Places) -> Array:
        """Return the seconds from each place to each of others in the same set-up, (m, k)."""
        if not len(start) or not len(stop):
            return np.zeros((len(start), len(stop)))
        machine, setup = self.task.observation.machine, self.task.observation.setups[int(stop.setups[0])]
        sides = counting(self.task, stop)[None]
        return way_seconds(machine, setup, start.poses[:, None], stop.poses[None], sides, straight=True)

    def around(self, place: Places) -> tuple[Array, Array]:
        """Return the seconds from a place to each candidate of its set-up, and from each to it, (m,)."""
        key = place.setups.tobytes() + place.poses.tobytes() + place.approaches.tobytes()
        if key not in self._known:
            mine = self.lattice.within(self.of[int(place.setups[0])])
            self._known[key] = self.seconds(place, mine)[0], self.seconds(mine, place)[:, 0]
        return self._known[key]


class Run:
    """The readings of one set-up in their order.

    slots : (k,) which readings of a plan; mounting, reading : s; places : the readings
    A run out and back along one axis counts as a round: so what lies beyond its ends costs both ways.
    """

    def __init__(self, ways: Ways, setup: int) -> None:
        self._ways, self.setup, mine = ways, setup, ways.lattice.within(ways.of[setup])
        described, here = ways.task.observation.setups[setup], ways.task.here
        self._here = here if here is not None and int(here.setups[0]) == setup else mine.within(slice(0, 0))
        self.mounting = 0.0 if len(self._here) else described.setup_time
        self.reading, self._round = reading_seconds(described), returns(described)
        self._begin = ways.seconds(self._here, mine).sum(axis=0)
        self.slots, self.places = np.zeros(0, dtype=np.intp), mine.within(slice(0, 0))
        self._away = self._back = np.zeros((0, len(mine)))
        self._legs, self._first = np.zeros((0, 0)), np.zeros(0)

    @property
    def seconds(self) -> float:
        """Seconds of mounting, ways and readings."""
        if not len(self.slots):
            return 0.0
        return self.mounting + float(self._first[0] + np.diagonal(self._legs, 1).sum()) + self.reading * len(self.slots)

    def gaps(self) -> Array:
        """Return the seconds more of ways to each candidate before each reading and after the last, (k + 1, m).

        The first reading of a set-up bears its mounting.
        """
        if not len(self.slots):
            return self.mounting + self._begin[None]
        there, legs = np.vstack([self._begin, self._away]), np.diagonal(self._legs, 1)[:, None]
        there[0] -= self._first[0]
        there[:-1] += self._back
        there[1:-1] -= legs
        if self._round:
            there[0] = there[-1] = self._away[-1] + self._back[0] - self._legs[-1, 0]
        return there

    def without(self, at: int) -> Self:
        """Return the run were a reading not there."""
        other = copy.copy(self)
        other._take(np.delete(np.arange(len(self.slots)), at))
        return other

    def insert(self, at: int, slot: int, place: Places, candidate: int | None = None) -> None:
        """Put a reading before another.  candidate : which of its set-up it is, if any"""
        away, back = self._ways.around(place)
        if candidate is None:
            to, here = self._ways.seconds(self.places, place)[:, 0], self._ways.seconds(place, self.places)[0]
        else:
            to, here = self._away[:, candidate], self._back[:, candidate]
        self._legs = np.insert(np.insert(self._legs, at, here, axis=0), at, np.insert(to, at, 0.0), axis=1)
        self._first = np.insert(self._first, at, self._ways.seconds(self._here, place).sum())
        self._away, self._back = np.insert(self._away, at, away, axis=0), np.insert(self._back, at, back, axis=0)
        self.slots = np.insert(self.slots, at, slot)
        self.places = Places.joined([self.places.within(slice(at)), place, self.places.within(slice(at, None))])

    def shorten(self) -> None:
        """Bring the readings into a shorter order: out and back where they are read so."""
        if self._round:
            self._take(out_and_back(self._ways.task, self.places))
        elif len(self.slots) > 2:
            self._take(shortened(self._legs, self._first))

    def _take(self, kept: NDArray[np.intp]) -> None:
        self._legs, self._first, self.slots = self._legs[np.ix_(kept, kept)], self._first[kept], self.slots[kept]
        self._away, self._back, self.places = self._away[kept], self._back[kept], self.places.within(kept)


def first_seconds(task: Task) -> dict[int, float]:
    """Return what the first reading of each set-up takes, mounting included, s."""
    ways = Ways(task, task.lattice)
    runs = {setup: Run(ways, setup) for setup in ways.of}
    return {setup: run.reading + float(run.gaps().min()) for setup, run in runs.items()}
