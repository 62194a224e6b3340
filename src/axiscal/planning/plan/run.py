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
    among : (M,) which they are of all candidates; None for all
    """

    def __init__(self, task: Task, lattice: Places, among: NDArray[np.bool_] | None = None) -> None:
        self.task, self.lattice, self.of = task, lattice, dict(lattice.by_setup())
        self._among = np.ones(len(lattice), dtype=bool) if among is None else among
        self._known = dict[tuple[int, int], tuple[Array, Array]]()

    def drawn(self, rng: np.random.Generator) -> Array:
        """Return a normal number for each candidate, (m,). Candidates that are not looked at have one, too."""
        return rng.standard_normal(len(self._among))[self._among]

    def seconds(self, start: Places, stop: Places) -> Array:
        """Return the seconds from each place to each of others in the same set-up, (m, k)."""
        if not len(start) or not len(stop):
            return np.zeros((len(start), len(stop)))
        machine, setup = self.task.observation.machine, self.task.observation.setups[int(stop.setups[0])]
        sides = counting(self.task, stop)[None]
        return way_seconds(machine, setup, start.poses[:, None], stop.poses[None], sides)

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
    Ways are known to nodes: the m candidates of the set-up, then the places that it began with.
    """

    def __init__(self, ways: Ways, setup: int) -> None:
        self._ways, self.setup, self._mine = ways, setup, ways.lattice.within(ways.of[setup])
        described, here = ways.task.observation.setups[setup], ways.task.here
        self._here = here if here is not None and int(here.setups[0]) == setup else self._mine.within(slice(0, 0))
        self.mounting = 0.0 if len(self._here) else described.setup_time
        self.reading, self._round = reading_seconds(described), returns(described)
        self._begin = ways.seconds(self._here, self._mine).sum(axis=0)
        self.slots, self.places = np.zeros(0, dtype=np.intp), self._mine.within(slice(0, 0))
        self._nodes, self._to_begun = np.zeros(0, dtype=np.intp), np.zeros((len(self._mine), 0))
        self._away, self._back = list[Array](), list[Array]()  # to every node; from every candidate
        self._first, self._legs = np.zeros(0), np.zeros(0)
        self._gaps = self.mounting + self._begin[None]

    @property
    def seconds(self) -> float:
        """Seconds of mounting, ways and readings."""
        if not len(self.slots):
            return 0.0
        return self.mounting + float(self._first[0] + self._legs.sum()) + self.reading * len(self.slots)

    def saved(self) -> Array:
        """Return the seconds less without each reading, (k,)."""
        if len(self.slots) == 1:
            return np.array([self.seconds])
        before, after = np.concatenate([self._first[:1], self._legs]), np.append(self._legs, 0.0)
        saved: Array = self.reading + before + after - np.concatenate([self._first[1:2], self._apart(2), [0.0]])
        return saved

    def _apart(self, steps: int) -> Array:
        """Return the seconds from each reading to the one so many later, (k - steps,)."""
        return np.array([away[node] for away, node in zip(self._away, self._nodes[steps:].tolist(), strict=False)])

    def gaps(self) -> Array:
        """Return the seconds more of ways to each candidate before each reading and after the last, (k + 1, m).

        The first reading of a set-up bears its mounting.
        """
        gaps: Array = self._gaps
        if not self._round or not len(self.slots):
            return gaps
        gaps = gaps.copy()
        gaps[0] = gaps[-1] = gaps[-1] + self._back[0] - self._away[-1][self._nodes[0]]
        return gaps

    def _gap(self, at: int) -> Array:
        """Return the seconds more of ways to each candidate before a reading, or after the last, (m,)."""
        count = len(self._mine)
        gap: Array = self._away[at - 1][:count] if at else self._begin
        if not len(self.slots):
            return gap + self.mounting
        if at < len(self.slots):
            gap = gap + self._back[at] - (self._legs[at - 1] if at else self._first[0])
        return gap

    def without(self, at: int) -> Self:
        """Return the run were a reading not there."""
        other = copy.copy(self)
        kept = np.delete(np.arange(len(self.slots)), at)
        other._keep(kept)
        over = [self._away[at - 1][node] for node in self._nodes[at + 1 : at + 2].tolist()] if at else []
        other._legs = np.concatenate([self._legs[: max(at - 1, 0)], over, self._legs[at + 1 :]])
        other._gaps = np.concatenate([self._gaps[:at], other._gap(at)[None], self._gaps[at + 2 :]])
        return other

    def through(self, slots: NDArray[np.intp], places: Places) -> Self:
        """Return the run with readings of a plan in this order."""
        other, ways = copy.copy(self), self._ways
        other.slots, other.places, other._to_begun = slots, places, ways.seconds(self._mine, places)
        other._nodes = len(self._mine) + np.arange(len(slots))
        other._away = list(ways.seconds(places, Places.joined([self._mine, places])))
        other._back = list(other._to_begun.T)
        other._first = ways.seconds(self._here, places).sum(axis=0)
        other._renew()
        return other

    def insert(self, at: int, slot: int, candidate: int) -> None:
        """Put a candidate of the set-up before a reading."""
        away, back = self._ways.around(self.setup, candidate)
        before = [each[candidate] for each in self._away[:at][-1:]]
        after = [each[candidate] for each in self._back[at : at + 1]]
        self._legs = np.concatenate([self._legs[: max(at - 1, 0)], before, after, self._legs[at:]])
        self._first = np.insert(self._first, at, self._begin[candidate])
        away = np.concatenate([away, self._to_begun[candidate]])
        self._away = [*self._away[:at], away, *self._away[at:]]
        self._back = [*self._back[:at], back, *self._back[at:]]
        self.slots, self._nodes = np.insert(self.slots, at, slot), np.insert(self._nodes, at, candidate)
        place = self._mine.single(candidate)
        self.places = Places.joined([self.places.within(slice(at)), place, self.places.within(slice(at, None))])
        around = np.stack([self._gap(at), self._gap(at + 1)])
        self._gaps = np.concatenate([self._gaps[:at], around, self._gaps[at + 1 :]])

    def shorten(self) -> None:
        """Bring the readings into a shorter order: out and back where they are read so."""
        if len(self.slots) < 2:
            return
        if self._round:
            order = out_and_back(self._ways.task, self.places)
        else:
            order = shortened(np.stack(self._away)[:, self._nodes], self._first)
        if not np.array_equal(order, np.arange(len(order))):
            self._keep(order)
            self._renew()

    def _keep(self, kept: NDArray[np.intp]) -> None:
        """Keep some readings, in this order."""
        self.slots, self.places, self._first = self.slots[kept], self.places.within(kept), self._first[kept]
        self._nodes = self._nodes[kept]
        self._away, self._back = ([each[k] for k in kept.tolist()] for each in (self._away, self._back))

    def _renew(self) -> None:
        """Find legs and gaps of the readings in their order."""
        self._legs = self._apart(1)
        self._gaps = np.stack([self._gap(at) for at in range(len(self.slots) + 1)])


def first_seconds(task: Task) -> dict[int, float]:
    """Return what the first reading of each set-up takes, mounting included, s."""
    ways = Ways(task, task.lattice)
    runs = {setup: Run(ways, setup) for setup in ways.of}
    return {setup: run.reading + float(run.gaps().min()) for setup, run in runs.items()}
