"""Markers: where a zero may wander, its first place is read again every so often, so that the drift shows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from axiscal.estimation.case import Case
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.planning.plan.task import Limits
from axiscal.record.events import Gap

EVERY = 1200.0
"""Seconds of machine time between two readings of a marker: a third of the hour over which a drift keeps its rate."""


def planned_with_markers(
    case: Case,
    readings: Sequence[Reading],
    gaps: Sequence[Gap],
    limits: Limits,
    plan: Callable[[Limits], tuple[Place, ...]],
) -> tuple[Place, ...]:
    """Return the readings to come with the markers among them, within the limits.

    readings : so far; plan : the readings to come within limits, in their order
    """
    places = plan(limits)
    if all(setup.drift == 0 for setup in case.description.setups):
        return places
    marked = with_markers(case, readings, gaps, places)
    added = len(marked) - len(places)
    return with_markers(case, readings, gaps, plan(_smaller(case, limits, added))) if added else marked


def without_markers(case: Case, readings: Sequence[Reading], places: Sequence[Place]) -> tuple[Place, ...]:
    """Return the places of an earlier plan that were not put there to watch a drift."""
    markers = _markers(case, readings, ())
    return tuple(place for place in places if markers.get(place.setup) != place)


def with_markers(
    case: Case, readings: Sequence[Reading], gaps: Sequence[Gap], places: Sequence[Place]
) -> tuple[Place, ...]:
    """Return the places with markers before those that come more than `EVERY` after the last one."""
    markers = _markers(case, readings, places)
    last = {r.setup: r.time or 0.0 for r in readings if r.place == markers.get(r.setup)}
    now = (readings[-1].time or 0.0) if readings else 0.0
    here, found = (readings[-1].place if readings else None), list[Place]()
    for place in places:
        marker = markers.get(place.setup)
        due = marker is not None and now - last.get(place.setup, now) > EVERY
        if marker is not None and due and not any(gap.holds(marker) for gap in gaps):
            now, here = now + case.seconds_of(here, marker), marker
            last[place.setup] = now
            found.append(marker)
        now, here = now + case.seconds_of(here, place), place
        last.setdefault(place.setup, now)
        found.append(place)
    return tuple(found)


def _markers(case: Case, readings: Sequence[Reading], places: Sequence[Place]) -> Mapping[str, Place]:
    """Return the place of each set-up whose zero may wander that is read first."""
    wandering = {setup.name for setup in case.description.setups if setup.drift > 0}
    found: dict[str, Place] = {}
    for place in (*(reading.place for reading in readings), *places):
        if place.setup in wandering:
            found.setdefault(place.setup, place)
    return found


def _smaller(case: Case, limits: Limits, markers: int) -> Limits:
    """Return limits with room for so many markers in them."""
    readings = None if limits.readings is None else max(limits.readings - markers, 1)
    setups = [setup for setup in case.description.setups if setup.drift > 0]
    each = max(setup.settle + setup.reading_time for setup in setups)
    budget = None if limits.budget is None else max(limits.budget - markers * each, 0.0)
    return replace(limits, readings=readings, budget=budget)
