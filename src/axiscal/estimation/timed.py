"""First stage: when each reading was taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

from axiscal.estimation.case import Case
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading


@dataclass(frozen=True, slots=True)
class Timed:
    """Readings with their times.

    given : as they were recorded; readings : the same, with the time of the plan where no clock was read
    ends : (m,) seconds of machine time after each: mounting, travel, settling, reading
    """

    given: tuple[Reading, ...] = ()
    readings: tuple[Reading, ...] = ()
    ends: tuple[float, ...] = ()

    @property
    def seconds(self) -> float:
        """The seconds of machine time that all of them take."""
        return self.ends[-1] if self.ends else 0.0

    def begins(self, readings: Sequence[Reading]) -> bool:
        """Whether readings are these, and perhaps others after them."""
        return self.given == tuple(readings[: len(self.given)])


def timed(case: Case, readings: Sequence[Reading], before: Timed) -> Timed:
    """Return readings with their times.  before : of the first of them, or of others, which is then not used"""
    first = before if before.begins(readings) else Timed()
    if len(first.given) == len(readings):
        return first
    new = readings[len(first.given) :]
    each = case.seconds_along(first.readings[-1] if first.readings else None, new)
    ends = tuple(accumulate(each.tolist(), initial=first.seconds))[1:]
    found = (r if r.time is not None else replace(r, time=now) for r, now in zip(new, ends, strict=True))
    return Timed(tuple(readings), (*first.readings, *found), (*first.ends, *ends))


def elapsed(case: Case, before: Timed, places: Sequence[Place]) -> float:
    """Return the seconds that have gone when places are read after readings, in this order."""
    now, here = before.seconds, before.readings[-1].place if before.readings else None
    for place in places:
        now += case.seconds_of(here, place)
        here = place
    return now
