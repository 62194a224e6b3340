"""Two places at least are read from both sides where a backlash is wanted: the mean reversal of one is that of one.

A model whose reversal is the same everywhere would read one place again and again.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from axiscal.estimation.case import Case
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.planning.overrun import with_room

_PLACES = 2
"""Two show whether the reversal is the same along the travel, and cost one reading more than one."""
_INWARD = 0.1
"""Share of the span from an end, where there is room to come from either side."""
_SIDES = (1, -1)
"""From + and from −."""
_SAME = 1e-6
"""m or rad: two readings at one place."""


def with_both_sides(case: Case, readings: Sequence[Reading], places: Sequence[Place]) -> tuple[Place, ...]:
    """Return a plan with two places read from both sides in each set-up that a wanted backlash is read in.

    readings : so far.  Readings that repeat others move there, else single ones; a plan keeps its number.
    """
    found = tuple(places)
    for setup, axis in _wanted(case):
        taken = [reading.place for reading in readings if reading.setup == setup.name]
        found = _paired(case, setup, axis, taken, found)
    return found


def _wanted(case: Case) -> Iterator[tuple[Setup, int]]:
    """Yield the set-ups that read a wanted backlash and may come from both sides, with its axis."""
    if all(want.row.kind != "backlash" for want in case.description.target.wants):
        return
    for asked in asked_rows(case.description, (), whole=True):
        if asked.want.row.kind == "backlash" and (name := asked.lines[0].setup):
            setup = case.description.setup(name)
            if setup.approach == "both":
                yield setup, asked.lines[0].axis


def _paired(case: Case, setup: Setup, axis: int, taken: list[Place], places: tuple[Place, ...]) -> tuple[Place, ...]:
    for _ in range(_PLACES):
        own = [place for place in places if place.setup == setup.name]
        both = _from_both([*taken, *own], axis)
        leaving = _spare(places, setup)[: len(_SIDES)]
        if not own or len(both) >= _PLACES or len(leaving) < len(_SIDES):
            break
        at = max(_ends(case, setup, axis), key=lambda end: min((abs(end - other) for other in both), default=0.0))
        kept = list(places)
        for place in leaving:
            kept.remove(place)
        mine = [number for number, place in enumerate(kept) if place.setup == setup.name]
        where = min(mine, key=lambda n: abs(kept[n].pose[axis] - at), default=places.index(own[0]))
        places = (*kept[:where], *(_there(case, setup, axis, own[0], at, side) for side in _SIDES), *kept[where:])
    return places


def _from_both(places: Sequence[Place], axis: int) -> list[float]:
    """Return the positions that are read from both sides."""
    plus, minus = ([place.pose[axis] for place in places if place.approach[axis] == side] for side in _SIDES)
    return sorted({here for here in plus if any(abs(here - other) < _SAME for other in minus)})


def _spare(places: Sequence[Place], setup: Setup) -> list[Place]:
    """Return readings that may go, those of the set-up first: repeats of an earlier one, then those without a twin."""
    poses = {(place.setup, place.pose, place.approach) for place in places}
    twins = [sum((name, pose) == (place.setup, place.pose) for name, pose, _ in poses) > 1 for place in places]
    repeated = [place for number, place in enumerate(places) if place in places[:number]]
    single = [place for place, twin in zip(places, twins, strict=True) if not twin and place not in repeated]
    return sorted([*repeated, *single], key=lambda place: place.setup != setup.name)


def _ends(case: Case, setup: Setup, axis: int) -> tuple[float, float]:
    """Return two positions near the ends of where a set-up reads, on its raster."""
    low, high = setup.span(case.description.machine.axes[axis], axis)
    step, first, last = setup.raster[axis], low + _INWARD * (high - low), high - _INWARD * (high - low)
    return (first, last) if step <= 0 else (step * math.ceil(first / step), step * math.floor(last / step))


def _there(case: Case, setup: Setup, axis: int, like: Place, at: float, side: int) -> Place:
    """Return the place of a set-up at a position, come to from a side."""
    pose = tuple(at if k == axis else value for k, value in enumerate(like.pose))
    approach = tuple(side if k == axis else value for k, value in enumerate(like.approach))
    return Place(setup.name, *with_room(case.errors, setup, pose, approach))
