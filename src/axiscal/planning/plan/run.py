"""The readings of one set-up in their order, and what any candidate between them would take more."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.measurement.travel import reading_seconds, way_seconds
from axiscal.numerics import Array
from axiscal.numerics.short_way import shortened
from axiscal.planning.plan.order import counting, out_and_back, returns
from axiscal.planning.plan.task import Task


class Ways:
    """Seconds between the nodes of a set-up, each found once: its m candidates, then places that a plan begins with.

    mounting, reading : s; places : of the nodes; begin : (nodes,) from where the machine stands
    """

    def __init__(self, task: Task, setup: int, candidates: Places, begun: Places) -> None:
        described, here = task.observation.setups[setup], task.here
        self.task, self.setup, self.candidates = task, setup, len(candidates)
        self.places = Places.joined([candidates, begun])
        stands = here if here is not None and int(here.setups[0]) == setup else candidates.within(slice(0, 0))
        self.mounting, self.reading = 0.0 if len(stands) else described.setup_time, reading_seconds(described)
        self.returns, self.begin = returns(described), self._seconds(stands, self.places).sum(axis=0)
        self._known = dict[int, tuple[Array, Array]]()

    def around(self, node: int) -> tuple[Array, Array]:
        """Return the seconds from a node to each, and from each to it, (nodes,)."""
        if node not in self._known:
            place = self.places.single(node)
            self._known[node] = self._seconds(place, self.places)[0], self._seconds(self.places, place)[:, 0]
        return self._known[node]

    def _seconds(self, start: Places, stop: Places) -> Array:
        if not len(start) or not len(stop):
            return np.zeros((len(start), len(stop)))
        machine, setup = self.task.observation.machine, self.task.observation.setups[self.setup]
        return way_seconds(machine, setup, start.poses[:, None], stop.poses[None], counting(self.task, stop)[None])


@dataclass(frozen=True, eq=False)
class Run:
    """The readings of one set-up in their order.

    slots : (k,) which readings of a plan; nodes : (k,) where
    A run out and back along one axis counts as a round: so what lies beyond its ends costs both ways.
    """

    ways: Ways
    slots: NDArray[np.intp]
    nodes: NDArray[np.intp]

    @classmethod
    def of(cls, task: Task, setup: int, candidates: Places, slots: NDArray[np.intp], places: Places) -> Run:
        """Return the run of readings of a plan in this order.  candidates : of the set-up"""
        return cls(Ways(task, setup, candidates, places), slots, len(candidates) + np.arange(len(slots)))

    @cached_property
    def _around(self) -> tuple[Array, Array]:
        """Seconds from each reading to each node, and from each node to it, (k, nodes)."""
        both = [self.ways.around(node) for node in self.nodes.tolist()]
        away, back = (np.array([each[i] for each in both]).reshape(-1, len(self.ways.begin)) for i in (0, 1))
        return away, back

    @cached_property
    def _legs(self) -> Array:
        """Seconds to each reading, and 0 behind the last, (k + 1,)."""
        away, nodes = self._around[0], self.nodes
        return np.concatenate([self.ways.begin[nodes[:1]], away[np.arange(len(nodes) - 1), nodes[1:]], [0.0]])

    @cached_property
    def seconds(self) -> float:
        """Seconds of mounting, ways and readings."""
        ways = self.ways
        return ways.mounting + float(self._legs.sum()) + ways.reading * len(self.slots) if len(self.slots) else 0.0

    def saved(self) -> Array:
        """Return the seconds less without each reading, (k,)."""
        if len(self.slots) == 1:
            return np.array([self.seconds])
        away, nodes = self._around[0], self.nodes
        over = [self.ways.begin[nodes[1:2]], away[np.arange(len(nodes) - 2), nodes[2:]], [0.0]]
        return np.asarray(self.ways.reading + self._legs[:-1] + self._legs[1:] - np.concatenate(over))

    @cached_property
    def gaps(self) -> Array:
        """The seconds more of ways to each candidate before each reading and after the last, (k + 1, m).

        The first reading of a set-up bears its mounting.
        """
        ways, (away, back) = self.ways, (each[:, : self.ways.candidates] for each in self._around)
        gaps: Array = np.vstack([ways.begin[: ways.candidates], away])
        if not len(self.slots):
            return gaps + ways.mounting
        gaps[:-1] += back - self._legs[:-1, None]
        if ways.returns:
            gaps[0] = gaps[-1] = gaps[-1] + back[0] - self._around[0][-1, self.nodes[0]]
        return gaps

    def without(self, at: int) -> Run:
        """Return the run were a reading not there."""
        return self._kept(np.delete(np.arange(len(self.slots)), at))

    def inserted(self, at: int, slot: int, candidate: int) -> Run:
        """Return the run with a candidate of the set-up before a reading."""
        return replace(self, slots=np.insert(self.slots, at, slot), nodes=np.insert(self.nodes, at, candidate))

    def shortened(self) -> Run:
        """Return the run in a shorter order: out and back where it is read so."""
        if len(self.slots) < 2:
            return self
        if self.ways.returns:
            return self._kept(out_and_back(self.ways.task, self.ways.places.within(self.nodes)))
        return self._kept(shortened(self._around[0][:, self.nodes], self.ways.begin[self.nodes]))

    def _kept(self, kept: NDArray[np.intp]) -> Run:
        return replace(self, slots=self.slots[kept], nodes=self.nodes[kept])


def first_seconds(task: Task) -> dict[int, float]:
    """Return what the first reading of each set-up takes, mounting included, s."""
    none, found = task.lattice.within(slice(0, 0)), dict[int, float]()
    for setup, mine in task.lattice.by_setup():
        ways = Ways(task, setup, task.lattice.within(mine), none)
        found[setup] = ways.reading + ways.mounting + float(ways.begin.min())
    return found
