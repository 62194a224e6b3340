"""Where a case of a study reads: as a plan asks for, evenly along the axes, or anywhere; until it ends."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from axiscal.design.plan.order import arriving, in_order
from axiscal.design.plan.plain_designs import evenly_spaced
from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.estimation.timed import Timed, elapsed
from axiscal.estimation.uncertain import as_standard
from axiscal.exceptions import StudyError
from axiscal.measurement.candidates import spread
from axiscal.measurement.place import Place, Places
from axiscal.planning.next_readings import posed, with_rooms
from axiscal.planning.promise import promised
from axiscal.planning.proposal import proposed
from axiscal.study.study_case import Method, Stop

_ANYWHERE = 4000
"""Places among which those are drawn that are read anywhere: many more than are read."""
_MOST = 2000
"""Readings after which a design that needs no thought has not reached its target."""


def limits_of(case: Case, stop: Stop) -> Limits:
    """Return when a case ends: what the study says, else the target of the campaign."""
    if stop.readings is not None or stop.budget is not None:
        return Limits(stop.readings, budget=stop.budget)
    target = case.description.target
    rms = target.rms
    if target.expanded is not None:
        rms = max(rms or 0.0, as_standard(case, case.knowledge, target.expanded))
    return Limits(target.readings, rms, target.worst, target.budget)


def places_read(case: Case, method: Method, limits: Limits, rng: np.random.Generator) -> tuple[Place, ...]:
    """Return where is read, in order; raises PlanError, StudyError where a target is not reached.

    rng : of the case, for places anywhere
    """
    if method == "planned":
        return with_rooms(case, proposed(case, limits, bounded=False).plan.places)
    return _enough(case, _drawing(case, method, rng), limits)


def _drawing(case: Case, method: Method, rng: np.random.Generator) -> Callable[[int], Places]:
    """Return what gives so many places; those anywhere are the first ones of one row, whatever their number."""
    task, setups = posed(case, case.knowledge), case.description.setups
    if method == "even":
        return lambda count: evenly_spaced(task, _shared(count, len(setups)))
    anywhere = [
        Places.of_setup(index, part.poses, part.approaches).within(rng.permutation(len(part)))
        for index, part in enumerate(spread(case.description.machine, (setup,), _ANYWHERE) for setup in setups)
    ]

    def drawn(count: int) -> Places:
        return Places.joined(
            [
                anywhere[index].within(np.arange(min(of, len(anywhere[index]))))
                for index, of in _shared(count, len(setups))
            ]
        )

    return drawn


def _shared(count: int, setups: int) -> list[tuple[int, int]]:
    """Return how many of so many readings each set-up takes: as many as the others, the first ones one more."""
    shares = [(index, count // setups + (index < count % setups)) for index in range(setups)]
    return [(index, share) for index, share in shares if share]


def _enough(case: Case, drawing: Callable[[int], Places], limits: Limits) -> tuple[Place, ...]:
    """Return the fewest places at which the first limit is reached, by doubling and halving; within a budget."""
    task = posed(case, case.knowledge)

    def ordered(count: int) -> tuple[Place, ...]:
        order = in_order(task, drawing(count))
        return with_rooms(case, replace(order, approaches=arriving(task, order)))

    def ended(count: int) -> bool:
        places = ordered(count)
        if limits.budget is not None and elapsed(case, Timed(), places) > limits.budget:
            return True
        return limits.accurate and limits.met(promised(case, case.knowledge, places))

    most = _MOST if limits.readings is None else limits.readings
    if limits.budget is None and not limits.accurate:
        return ordered(most)
    short, enough = 0, 1
    while enough < most and not ended(enough):
        short, enough = enough, min(2 * enough, most)
    if not ended(enough):
        if limits.readings is None:
            raise StudyError(f"{_MOST} such readings do not reach the target", "Let a plan choose, or widen the target")
        return ordered(enough)
    while enough - short > 1:
        middle = (short + enough) // 2
        short, enough = (short, middle) if ended(middle) else (middle, enough)
    places = ordered(enough)
    over = limits.budget is not None and elapsed(case, Timed(), places) > limits.budget
    if over and short == 0:
        raise StudyError(f"{(limits.budget or math.nan) / 60:.3g} min is too short for one reading", "Allow more time")
    return ordered(short) if over else places
