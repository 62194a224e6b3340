"""How well a machine will be known after a plan and at best, what the plan cannot tell apart, and what it rests on."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.estimation.case import Case, Knowledge, timed
from axiscal.estimation.judged import Doubt
from axiscal.estimation.promise.causes import Contribution
from axiscal.estimation.promise.problem import problem
from axiscal.exceptions import PlanError
from axiscal.measurement.reading import Place, Reading
from axiscal.measurement.reading_rows import blank_readings, places_of, rows_at, times_of
from axiscal.numerics import Array
from axiscal.units import to_unit
from axiscal_core.normal import Normal
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given
from axiscal_core.unknowns import space_of

FEW = 6
"""Readings planned at once where likely sizes alone reach a target, or fall short of it: then it is looked at again."""
_TAKEN = 0.5
"""Share of what comes and goes that is taken for the curve, from which on it is said."""
_AGAIN, _FEWEST = 4, 6
"""Places that are read once more (with all of them a twentieth stays), of a set-up with so many readings."""


def foreseen(case: Case, readings: Sequence[Reading], places: Sequence[Place]) -> Knowledge:
    """Return what readings and those to come would make known, with all that a result counts, at the case's sizes.

    places : of the readings to come, whatever they will show
    It includes type B errors, such as that of a laser's wavelength, and what wanders with time; J leaves them out.
    """
    every = [*readings, *blank_readings(case.description.setups, places)]
    return blank_problem(case, every).knowledge if every else case.knowledge


class Blank(NamedTuple):
    """Readings with their times as a problem, and everything at the case's sizes, whatever those to come will show."""

    case: Case
    readings: tuple[Reading, ...]
    posed: Problem
    found: Given

    @property
    def knowledge(self) -> Knowledge:
        """What they make known."""
        answer = self.found.posterior()
        return Knowledge(self.case.observation, Normal(answer.mean, (answer.covariance + answer.covariance.T) / 2))


def blank_problem(case: Case, readings: Sequence[Reading]) -> Blank:
    """Return readings as a problem, at least one, those to come among them.  Raises PlanError."""
    together = timed(case, readings).readings
    posed = problem(case.observation, together, case.sizes, case.inherited, case.description.usual)
    found = space_of(posed).given(np.zeros(len(posed.sizes)))
    if found is None:
        raise PlanError("the stated sizes differ by more than 15 digits", "Look at the std of errors and unknowns")
    return Blank(case, together, posed, found)


def unseen_parts(blank: Blank) -> list[tuple[Contribution, Array]]:
    """Return type B causes, and by what one standard deviation moves what readings would say, (answered,) m and rad.

    Those causes are left out whose effect follows from the values that are read.
    """
    moved = blank.found.type_b.gains.T
    return [(each, by) for each, by in zip(blank.posed.causes, moved, strict=True) if not each.row.of_values]


@dataclass(frozen=True, slots=True)
class Alike:
    """A set-up whose zero may come and go unseen, places to read once more at its end, and their minutes."""

    setup: str
    readings: int
    minutes: float


def alike(blank: Blank) -> Alike | None:
    """Return the set-up in which a zero that comes and goes looks most like the curve; None where none does.

    Half a sine b over the time of a set-up moves the estimate by G b. Where the readings then fit b, it was taken for
    the curve. Where backlashes alone are wanted, no curve is.
    """
    case = blank.case
    if {want.row.kind for want in case.description.target.wants} == {"backlash"}:
        return None
    shares = dict(_shares(blank))
    name = max(shares, key=lambda each: shares[each], default="")
    if shares.get(name, 0.0) <= _TAKEN:
        return None
    own = [reading.place for reading in blank.readings if reading.setup == name]
    out = [own[index] for index in np.linspace(0, len(own) // 2, _AGAIN).astype(int).tolist()]
    return Alike(name, _AGAIN, to_unit(float(case.seconds_along(own[-1], out).sum()), "min"))


def _shares(blank: Blank) -> Iterator[tuple[str, float]]:
    """Yield how much of what comes and goes is taken for the curve, by the name of each set-up with a zero."""
    case, readings, posed, found = blank
    rows = rows_at(case.observation, places_of(case.observation.setups, readings)).rows[:, : case.errors.size]
    times = times_of(readings)[posed.reading]
    for index in np.unique(posed.setup).tolist():
        setup, mine = case.description.setups[index], posed.setup == index
        if len(np.unique(posed.reading[mine])) < _FEWEST or not any(
            unknown.name.startswith("zero") for unknown in setup.unknowns
        ):
            continue
        comes = np.where(mine, np.sin(np.pi * (times - times[mine].min()) / np.ptp(times[mine])), 0.0)
        moved = found.gain((comes / posed.noise)[:, None])[: case.errors.size, 0]
        yield setup.name, _fit(rows[mine] @ moved, comes[mine])


def _fit(shown: Array, wanted: Array) -> float:
    """Return the share of wanted that is shown, (m,) each, means taken off."""
    apart = wanted - wanted.mean()
    return float(shown @ apart / (apart @ apart))


EVERY = 1200.0
"""Seconds of machine time between two readings of a marker: a third of the hour over which a drift keeps its rate."""
_FIRST, _GROWTH = 5, 1.34
_AS_STATED = 1.2
"""By this factor a reading's own std may differ from its set-up's noise before it tells more or less than planned."""


def plan_basis(case: Case, readings: Sequence[Reading], doubts: Sequence[Doubt]) -> str:
    """Return what a plan made now rests on beside where readings were taken, in words; empty for nothing.

    Where a zero drifts it rests on the clock as well: markers are due by it.
    doubts : readings that are not believed
    """
    noise = {setup.name: setup.noise for setup in case.description.setups}
    said = [f"sizes of {count} readings"] if len(case.sizes) and (count := _learnt_from(len(readings))) else []
    said += [f"{doubt.reading + 1} rejected" for doubt in doubts]
    passed = int(max((reading.time or 0.0 for reading in readings), default=0.0) // EVERY)
    if passed and any(setup.drift > 0 for setup in case.description.setups):
        said.append(f"{passed} times {EVERY / 60:.0f} min")
    stds = ((n, r.std / noise[r.setup]) for n, r in enumerate(readings, 1) if r.std is not None)
    other = [n for n, times in stds if not 1 / _AS_STATED < times < _AS_STATED]
    return ", ".join([*said, *(f"noise of {number}" for number in other)])


def rejected(basis: str) -> frozenset[int]:
    """Return the indices of the readings that are not believed.  basis : of `plan_basis`"""
    return frozenset(int(number) - 1 for number in re.findall(r"(\d+) rejected", basis))


def _learnt_from(count: int) -> int:
    """Return the last number of readings, by a third more each time, after which sizes make a plan anew."""
    due, following = 0, _FIRST
    while following <= count:
        due, following = following, math.ceil(following * _GROWTH)
    return due
