"""Readings in the order in which they are taken, while a search takes them in and puts them elsewhere."""

from __future__ import annotations

import copy
from typing import Self

import numpy as np

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.plan.greedy import Setups
from axiscal.planning.plan.run import Run, Ways
from axiscal.planning.plan.scores import Scores
from axiscal.planning.plan.task import Limits
from axiscal_core.ties import ALIKE, first_best, ranked

_SHORT = 40
"""Readings of a set-up up to which each insertion is followed by 2-opt: of speed; it follows in the end anyway."""
_MOST = 1000
"""Readings of a plan at most."""
_CALLS, _EACH = 2e6, 20.0
"""Operations that the calls into numpy for one reading are worth, and those for a candidate beside a reading."""
_ROUNDING = 1e-9
"""Share of a budget: sums of seconds that differ by less are the same."""
_INSTANT = 1e-3
"""Seconds: what takes no time is not worth endlessly much, and of ways that differ by less the first is taken."""


class Tour:
    """Readings within a time in the order in which they are taken.

    scores : gains of the candidates; runs : readings of each set-up; work : operations done so far
    """

    def __init__(self, ways: Ways, scores: Scores, setups: Setups, limits: Limits) -> None:
        self.scores, self.ways, self.work = scores, ways, 0.0
        self.budget = np.inf if limits.budget is None else limits.budget * (1 + _ROUNDING)
        self.most = min(limits.readings or _MOST, _MOST)
        self.runs = {setup: Run(ways, setup) for setup in setups}

    @classmethod
    def through(cls, ways: Ways, scores: Scores, setups: Setups, limits: Limits, places: Places) -> Self:
        """Return the tour of places in their order.  scores : before the first, taken over"""
        tour = cls(ways, scores, setups, limits)
        tour.scores.put_all(places)
        for setup, mine in places.by_setup():
            tour.runs[setup] = tour.runs[setup].through(mine, places.within(mine))
        return tour

    @property
    def left(self) -> float:
        """Seconds that are left; below zero where it takes too long."""
        return self.budget - self.seconds

    @property
    def seconds(self) -> float:
        """Seconds of all readings and ways."""
        return sum(run.seconds for run in self.runs.values())

    @property
    def places(self) -> Places:
        """The readings, run by run, in their order."""
        return self.scores.places.within(np.concatenate([run.slots for run in self.runs.values()]).astype(np.intp))

    def within(self, budget: float) -> Self:
        """Return a copy without the readings for which there is no time."""
        other = copy.copy(self)
        other.scores, other.runs, other.budget = (
            self.scores.fork(),
            {s: copy.copy(r) for s, r in self.runs.items()},
            budget,
        )
        other.cut()
        return other

    def enter(self, index: int) -> None:
        """Take in a candidate where it costs least."""
        self.scores.put(index)
        self._put(index, len(self.scores.places) - 1)

    def shorten(self) -> None:
        """Bring each run into a shorter order."""
        for run in self.runs.values():
            run.shorten()

    def fill(self, rng: np.random.Generator, power: float, shaken: float) -> None:
        """Take in what gains most per second^power until no second is left.  shaken : of the gains' logarithms"""
        tidy = False
        while len(self.scores.places) < self.most:
            extra = self._extra(self.runs)
            fits = extra <= self.left
            if not fits.any() and tidy:
                return
            if not fits.any():
                self.shorten()
                tidy = True
                continue
            gains = self.scores.gains * np.exp(shaken * self.ways.drawn(rng))
            self.enter(first_best(np.where(fits, gains / np.maximum(extra, _INSTANT) ** power, -np.inf), ALIKE))
            tidy = False

    def swap(self, better: float, most: float) -> None:
        """Put for each reading what gains most within the minutes.

        better : share by which it must gain more; most : of the work
        """
        for slot in ranked(-self.scores.losses(), ALIKE).tolist():
            if self.scores.held_alone(slot):
                continue
            if self.work > most:
                return
            self.work += _CALLS + _EACH * self.scores.count * self.scores.slots
            gains, own = self.scores.without(slot)
            run, others = self._leaving(slot)
            runs = {**self.runs, run.setup: others}
            fits = self._extra(runs) <= self.left + run.seconds - others.seconds
            best = first_best(np.where(fits, gains, -np.inf), ALIKE)
            if fits[best] and gains[best] > own * (1 + better):
                self.scores.put(best, slot)
                self.runs = runs
                self._put(best, slot)

    def cut(self) -> None:
        """Take readings out until the others fit into the time."""
        while len(self.scores.places) and (self.left < 0 or len(self.scores.places) > self.most):
            self.drop()

    def drop(self) -> None:
        """Take out the reading that is worth least per second."""
        seconds = np.zeros(len(self.scores.places))
        for run in self.runs.values():
            seconds[run.slots] = run.saved()
        slot = first_best(-self.scores.losses() / np.maximum(seconds, _INSTANT), ALIKE)
        run, others = self._leaving(slot)
        self.scores.leave(slot)
        self.runs = {**self.runs, run.setup: others}
        for each in self.runs.values():
            each.slots = each.slots - (each.slots > slot)

    def _leaving(self, slot: int) -> tuple[Run, Run]:
        """Return the run of a reading, and the same without it."""
        run = self.runs[int(self.scores.places.setups[slot])]
        return run, run.without(int(np.flatnonzero(run.slots == slot)[0]))

    def _put(self, index: int, slot: int) -> None:
        run = self.runs[int(self.scores.lattice.setups[index])]
        candidate = index - int(self.ways.of[run.setup][0])
        longer = run.gaps()[:, candidate]
        at = int((longer <= longer.min() + _INSTANT).argmax())
        run.insert(at, slot, candidate)
        if len(run.slots) <= _SHORT:
            run.shorten()
        scores = self.scores
        self.work += 2 * _CALLS + scores.count * (_EACH * scores.slots + 2.0 * scores.task.belief.size)

    def _extra(self, runs: dict[int, Run]) -> Array:
        """Return the seconds more of each candidate, infinite in other set-ups, (M,)."""
        extra = np.full(self.scores.count, np.inf)
        for setup, run in runs.items():
            extra[self.ways.of[setup]] = run.gaps().min(axis=0) + run.reading
        return extra
