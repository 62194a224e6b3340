"""The gains of the candidates of a task while a plan is made."""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.planning.plan.task import Task
from axiscal_core.criterion import Goal
from axiscal_core.gains import Gains, own_numbers


class Scores(Gains):
    """Gains with the places of a plan.

    lattice : the candidates, sorted by set-up; places : of the readings of the plan, slot by slot
    """

    def __init__(self, task: Task) -> None:
        self.task, self.lattice = task, task.lattice.within(np.argsort(task.lattice.setups, kind="stable"))
        self._n = task.numbers(self.lattice)
        self.places = Places.none(self.lattice.poses.shape[1])
        super().__init__(task.state, self._n, own_numbers(self._n.place, len(self.lattice)))

    def telling(self, columns: NDArray[np.intp]) -> Gains:
        """Return what takes variance of unknowns away, in shares of their first, as gains beside this plan."""
        first = np.sqrt(np.diagonal(self.task.observation.prior_covariance())[columns])
        root = np.zeros((len(columns), self.state.size))
        root[np.arange(len(columns)), columns] = 1 / np.where(first > 0, first, np.inf)
        found = Gains(self.task.begun(Goal(root)), self._n, own_numbers(self._n.place, self.count))
        found.enter_all(self.task.numbers(self.places))
        return found

    def put(self, what: int | Places, slot: int | None = None) -> None:
        """Take a candidate, or a reading at another single place, into the plan.  slot : of one that it replaces"""
        place = what if isinstance(what, Places) else self.lattice.single(what)
        entering = self.task.numbers(what) if isinstance(what, Places) else what
        if slot is None:
            self.enter(entering)
            self.places = Places.joined([self.places, place])
        else:
            self.exchange(slot, entering)
            self.places = self.places.exchanged(slot, place)

    def put_all(self, places: Places) -> Self:
        """Take readings into the plan, after those that it has; return this."""
        self.enter_all(self.task.numbers(places))
        self.places = Places.joined([self.places, places])
        return self

    def leave(self, slot: int) -> None:
        super().leave(slot)
        self.places = self.places.without(slot)
