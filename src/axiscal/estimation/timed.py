"""First stage: when each reading was taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

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
    found, ends = list(first.readings), list(first.ends)
    for reading in readings[len(found) :]:
        now = (ends[-1] if ends else 0.0) + case.seconds_of(found[-1] if found else None, reading)
        ends.append(now)
        found.append(reading if reading.time is not None else replace(reading, time=now))
    return Timed(tuple(readings), tuple(found), tuple(ends))


def elapsed(case: Case, before: Timed, places: Sequence[Place]) -> float:
    """Return the seconds that have gone when places are read after readings, in this order."""
    now, here = before.seconds, before.readings[-1].place if before.readings else None
    for place in places:
        now += case.seconds_of(here, place)
        here = place
    return now
