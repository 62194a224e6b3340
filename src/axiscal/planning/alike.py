"""What places cannot tell apart: a zero that comes and goes while they are read, and the curve that is looked for.

Half a sine b over the time of a set-up moves the estimate by G b. Where the readings then fit b, it was taken for the
curve. That follows from places and times alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.promise.posterior import gain
from axiscal.measurement.place import Place
from axiscal.measurement.reading_rows import places_of, rows_at, times_of
from axiscal.numerics import Array
from axiscal.planning.promise import blank_problem
from axiscal.units import to_unit

_TAKEN = 0.5
"""Share of what comes and goes that is taken for the curve, from which on it is said."""
_AGAIN, _FEWEST = 4, 6
"""Places that are read once more (with all of them a twentieth stays), of a set-up with so many readings."""


@dataclass(frozen=True, slots=True)
class Alike:
    """A set-up whose zero may come and go unseen, places to read once more at its end, and their minutes."""

    setup: str
    readings: int
    minutes: float


def alike(case: Case, places: Sequence[Place]) -> Alike | None:
    """Return the set-up in which a zero that comes and goes looks most like the curve; None where none does.

    Where backlashes alone are wanted, no curve is.
    """
    if {want.row.kind for want in case.description.target.wants} == {"backlash"}:
        return None
    shares = dict(_shares(case, places))
    name = max(shares, key=lambda each: shares[each], default="")
    if shares.get(name, 0.0) <= _TAKEN:
        return None
    own = [place for place in places if place.setup == name]
    out = [own[index] for index in np.linspace(0, len(own) // 2, _AGAIN).astype(int).tolist()]
    return Alike(name, _AGAIN, to_unit(float(case.seconds_along(own[-1], out).sum()), "min"))


def _shares(case: Case, places: Sequence[Place]) -> Iterator[tuple[str, float]]:
    """Yield how much of what comes and goes is taken for the curve, by the name of each set-up with a zero."""
    readings, posed, found = blank_problem(case, places)
    rows = rows_at(case.observation, places_of(case.observation.setups, readings)).rows[:, : case.errors.size]
    times = times_of(readings)[posed.reading]
    for index in np.unique(posed.setup).tolist():
        setup, mine = case.description.setups[index], posed.setup == index
        if len(np.unique(posed.reading[mine])) < _FEWEST or not any(
            unknown.name.startswith("zero") for unknown in setup.unknowns
        ):
            continue
        comes = np.where(mine, np.sin(np.pi * (times - times[mine].min()) / np.ptp(times[mine])), 0.0)
        moved = gain(posed, found, (comes / posed.noise)[:, None])[: case.errors.size, 0]
        yield setup.name, _fit(rows[mine] @ moved, comes[mine])


def _fit(shown: Array, wanted: Array) -> float:
    """Return the share of wanted that is shown, (m,) each, means taken off."""
    apart = wanted - wanted.mean()
    return float(shown @ apart / (apart @ apart))
