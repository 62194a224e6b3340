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
        self._known = dict[tuple[int, int], tuple[Array, Array]]()

    def seconds(self, start: Places, stop: Places) -> Array:
        """Return the seconds from each place to each of others in the same set-up, (m, k)."""
        if not len(start) or not len(stop):
            return np.zeros((len(start), len(stop)))
        machine, setup = self.task.observation.machine, self.task.observation.setups[int(stop.setups[0])]
        sides = counting(self.task, stop)[None]
        return way_seconds(machine, setup, start.poses[:, None], stop.poses[None], sides, straight=True)

    def around(self, setup: int, candidate: int) -> tuple[Array, Array]:
        """Return the seconds from a candidate of a set-up to each of its candidates, and from each to it, (m,)."""
        if (setup, candidate) not in self._known:
            mine = self.lattice.within(self.of[setup])
            place = mine.single(candidate)
            self._known[setup, candidate] = self.seconds(place, mine)[0], self.seconds(mine, place)[:, 0]
        return self._known[setup, candidate]


class Run:
    """The readings of one set-up in their order.

    slots : (k,) which readings of a plan; mounting, reading : s; places : the readings
    A run out and back along one axis counts as a round: so what lies beyond its ends costs both ways.
    """

    def __init__(self, ways: Ways, setup: int) -> None:
        self._ways, self.setup, self._mine = ways, setup, ways.lattice.within(ways.of[setup])
        described, here = ways.task.observation.setups[setup], ways.task.here
        self._here = here if here is not None and int(here.setups[0]) == setup else self._mine.within(slice(0, 0))
        self.mounting = 0.0 if len(self._here) else described.setup_time
        self.reading, self._round = reading_seconds(described), returns(described)
        self._begin = ways.seconds(self._here, self._mine).sum(axis=0)
        self.slots, self.places = np.zeros(0, dtype=np.intp), self._mine.within(slice(0, 0))
        self._away = self._back = np.zeros((0, len(self._mine)))
        self._legs, self._first = np.zeros((0, 0)), np.zeros(0)
        self._gaps: Array | None = None

    @property
    def seconds(self) -> float:
        """Seconds of mounting, ways and readings."""
        if not len(self.slots):
            return 0.0
        return self.mounting + float(self._first[0] + np.diagonal(self._legs, 1).sum()) + self.reading * len(self.slots)

    def saved(self) -> Array:
        """Return the seconds less without each reading, (k,)."""
        if len(self.slots) == 1:
            return np.array([self.seconds])
        legs, far = np.diagonal(self._legs, 1), np.diagonal(self._legs, 2)
        before, after = np.concatenate([self._first[:1], legs]), np.append(legs, 0.0)
        saved: Array = self.reading + before + after - np.concatenate([self._first[1:2], far, [0.0]])
        return saved

    def gaps(self) -> Array:
        """Return the seconds more of ways to each candidate before each reading and after the last, (k + 1, m).

        The first reading of a set-up bears its mounting.
        """
        if self._gaps is None:
            self._gaps = self._found_gaps()
        return self._gaps

    def _found_gaps(self) -> Array:
        if not len(self.slots):
            mounted: Array = self.mounting + self._begin[None]
            return mounted
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

    def through(self, slots: NDArray[np.intp], places: Places) -> Self:
        """Return the run with readings of a plan in this order."""
        other = copy.copy(self)
        other.slots, other.places, other._gaps = slots, places, None
        other._away, other._back = self._ways.seconds(places, self._mine), self._ways.seconds(self._mine, places).T
        other._legs, other._first = (
            self._ways.seconds(places, places),
            self._ways.seconds(self._here, places).sum(axis=0),
        )
        return other

    def insert(self, at: int, slot: int, candidate: int) -> None:
        """Put a candidate of the set-up before a reading."""
        away, back = self._ways.around(self.setup, candidate)
        to, here = self._away[:, candidate], self._back[:, candidate]
        self._legs = np.insert(np.insert(self._legs, at, here, axis=0), at, np.insert(to, at, 0.0), axis=1)
        self._first = np.insert(self._first, at, self._begin[candidate])
        self._away, self._back = np.insert(self._away, at, away, axis=0), np.insert(self._back, at, back, axis=0)
        self.slots, self._gaps, place = np.insert(self.slots, at, slot), None, self._mine.single(candidate)
        self.places = Places.joined([self.places.within(slice(at)), place, self.places.within(slice(at, None))])

    def shorten(self) -> None:
        """Bring the readings into a shorter order: out and back where they are read so."""
        if len(self.slots) > 1:
            task = self._ways.task
            self._take(out_and_back(task, self.places) if self._round else shortened(self._legs, self._first))

    def _take(self, kept: NDArray[np.intp]) -> None:
        self._legs, self._first, self.slots = self._legs[np.ix_(kept, kept)], self._first[kept], self.slots[kept]
        self._away, self._back, self.places = self._away[kept], self._back[kept], self.places.within(kept)
        self._gaps = None


def first_seconds(task: Task) -> dict[int, float]:
    """Return what the first reading of each set-up takes, mounting included, s."""
    ways = Ways(task, task.lattice)
    runs = {setup: Run(ways, setup) for setup in ways.of}
    return {setup: run.reading + float(run.gaps().min()) for setup, run in runs.items()}
