"""What the readings of a campaign make known, found from the record alone, once for the same readings.

knowing = Knowing(description)
known = knowing.known(readings)
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import cached_property
from typing import TypeVar, cast

from axiscal.campaign.ending import standing
from axiscal.campaign.milestones import Milestone
from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded, estimated
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.history import path
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.timed import Timed, timed
from axiscal.exceptions import AmbiguityError
from axiscal.measurement.reading import Reading
from axiscal.planning.plan_basis import plan_basis

Readings = tuple[Reading, ...]
Found = TypeVar("Found")


class Knowing:
    """What readings make known of the machine that a campaign describes."""

    def __init__(self, description: CampaignDescription) -> None:
        self._description = description
        self._readings: Readings = ()
        self._found: dict[Hashable, object] = {}

    @cached_property
    def case(self) -> Case:
        """What the description makes of the mathematics."""
        return case_of(self._description)

    def known(self, readings: Readings) -> Estimation:
        """Return what the readings make known while others are to follow."""
        return self._once("known", readings, lambda: estimated(self.case, readings))

    def concluded(self, readings: Readings) -> Estimation:
        """Return what the readings make known if they are all."""
        return self._once("concluded", readings, lambda: concluded(self.case, readings, self.known(readings)))

    def plan_basis(self, readings: Readings) -> str:
        """Return what a plan made now rests on, in words."""
        known = self.known(readings)
        return plan_basis(known.case, known.readings, known.outliers)

    def standing(self, readings: Readings, ended: bool = False) -> str | None:
        """Return why an accuracy asks for no more readings.  ended : no others are to follow"""
        target = self._description.target
        return self._once(("standing", ended), readings, lambda: standing(target, self.so_far(readings, ended)))

    def so_far(self, readings: Readings, ended: bool) -> Estimation:
        """Return what the readings make known.  ended : no others are to follow, and it is what a report says

        Where a station may as well stand elsewhere, a report says nothing, and what stood before the end is returned.
        """
        if not ended:
            return self.known(readings)
        try:
            return self.concluded(readings)
        except AmbiguityError:
            return self.known(readings)

    def _once(self, what: Hashable, readings: Readings, find: Callable[[], Found]) -> Found:
        """Return what follows from exactly these readings, found when it is first asked for."""
        if self._readings != readings:
            self._readings, self._found = readings, {}
        if what not in self._found:
            self._found[what] = find()
        return cast(Found, self._found[what])

    def timed(self, readings: Readings) -> Timed:
        """Return the readings with their times."""
        return self._once("timed", readings, lambda: timed(self.case, readings, Timed()))

    def milestone(self, readings: Readings) -> Milestone:
        """Return where a campaign stands after its last reading."""
        last = readings[-1] if readings else None
        return Milestone(len(readings), last, self.known(readings).accuracy, self.timed(readings).seconds)

    def history(self, readings: Readings) -> tuple[Milestone, ...]:
        """Return how well the machine was known after each reading, with the sizes known now."""
        moments = path(self.known(readings))
        pairs = enumerate(zip(moments, (None, *readings), strict=True))
        return tuple(Milestone(taken, reading, at.accuracy, at.seconds) for taken, (at, reading) in pairs)
