"""First stage: when each reading was taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

from axiscal.estimation.case import Case
from axiscal.measurement.reading import Place, Reading


@dataclass(frozen=True, slots=True)
class Timed:
    """Readings with their times.

    readings : with the time of the plan where no clock was read
    ends : (m,) seconds of machine time after each: mounting, travel, settling, reading
    """

    readings: tuple[Reading, ...] = ()
    ends: tuple[float, ...] = ()

    @property
    def seconds(self) -> float:
        """The seconds of machine time that all of them take."""
        return self.ends[-1] if self.ends else 0.0


def timed(case: Case, readings: Sequence[Reading]) -> Timed:
    """Return readings with their times."""
    ends = ends_along(case, readings)
    pairs = zip(readings, ends, strict=True)
    return Timed(tuple(r if r.time is not None else replace(r, time=now) for r, now in pairs), ends)


def ends_along(case: Case, places: Sequence[Place | Reading]) -> tuple[float, ...]:
    """Return the seconds of machine time after each of them, from the beginning of a campaign."""
    return tuple(accumulate(case.seconds_along(None, places).tolist()))


def elapsed(case: Case, before: Timed, places: Sequence[Place]) -> float:
    """Return the seconds that have gone when places are read after readings, in this order."""
    here = before.readings[-1].place if before.readings else None
    return sum(case.seconds_along(here, places).tolist(), before.seconds)
