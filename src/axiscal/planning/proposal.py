"""A whole plan.

Before the first reading it is tested whether the set-ups can reach the target at all.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np

from axiscal.description.target import Target
from axiscal.estimation.accuracy.expanded import asked, expanded, known_to
from axiscal.estimation.case import Case
from axiscal.estimation.known_rows import refuse_unmade
from axiscal.exceptions import PlanError, TargetError
from axiscal.language.spoken import listed, put, said
from axiscal.measurement.reading import Places
from axiscal.measurement.reading_rows import places_of
from axiscal.measurement.travel import reading_seconds
from axiscal.planning.enough import enough, reached
from axiscal.planning.helping import helping_setups, helping_words
from axiscal.planning.next_readings import CANDIDATES, posed, reaching
from axiscal.planning.other_readings import with_rooms
from axiscal.planning.plan.minutes import stretched
from axiscal.planning.plan.plan import MANY, Plan, judged
from axiscal.planning.plan.run import first_seconds
from axiscal.planning.plan.task import Limits
from axiscal.planning.promise import foreseen
from axiscal.planning.unseen import hidden_of
from axiscal.units import format_quantity, said_quantity, to_unit
from axiscal_core.threads import one_thread

_NAMED = 3
"""Sentences that are read; the others would repeat them."""
_CANDIDATES = 1000
"""Enough to say that a target needs too many readings, which a plan then says better."""
MOST = 1000
"""Readings beyond which no plan is made."""
MOST_CANDIDATES = 500_000
_ABSURD = 100
"""So many times more time than a plan can fill is a slip; any factor between that of a long day and a year would do."""
Mark = Literal["half", "asked", "double"]
_SHARES: dict[float, Mark | None] = {0.25: None, 0.5: "half", 0.75: None, 1.0: "asked", 1.5: None, 2.0: "double"}
"""Of the time of a plan, for which it is said what they buy, with those that are marked."""
_INSTANT = 1e-3
"""Seconds of a reading that is said to take no time."""


@one_thread()
def refuse_out_of_reach(case: Case, limits: Limits) -> None:
    """Raise TargetError for an RMS that these set-ups cannot bring, however often read, and say why."""
    if limits.rms is None:
        return
    floor = case.yardstick.rms_floor
    if floor > limits.rms:
        target = replace(case.description.target, rms=limits.rms, worst=None, expanded=None)
        what = "an RMS of {rms:.3g} um cannot be reached: {leaves}"
        leaves = _leaves(limits.rms, floor)
        raise TargetError(what, _what_helps(case, target), rms=to_unit(limits.rms, "um"), leaves=leaves)


def _leaves(limit: float, floor: float) -> str:
    """Say what endless readings would leave, with as many digits as tell it from the limit."""
    digits = next((n for n in (3, 4, 5) if f"{floor:.{n}g}" != f"{limit:.{n}g}"), 6)
    left, asked = (said_quantity(each, "um", digits) for each in (floor, limit))
    return said("endless readings would leave {left} of the {asked} asked for", left=left, asked=asked)


def refuse_endless(case: Case, limits: Limits, candidates: int) -> None:
    """Raise PlanError for a plan of so many readings, or chosen from so many places, that nobody would see its end."""
    if candidates > MOST_CANDIDATES:
        what = "a choice among {count:,} places is not made: at most {most:,} are compared"
        remedy = "Compare fewer: readings are brought to the best places between them anyway"
        raise PlanError(what, remedy, count=candidates, most=MOST_CANDIDATES)
    if (limits.readings or 0) > MOST:
        what = "a plan of {count:,} readings is not made: at most {most:,} are chosen together"
        remedy = "Ask for fewer, or for an accuracy; a campaign goes on after its plan"
        raise PlanError(what, remedy, count=limits.readings, most=MOST)
    if limits.readings is None and limits.budget is not None and not limits.accurate:
        shortest = min(reading_seconds(setup) for setup in case.description.setups)
        if limits.budget > _ABSURD * MOST * max(shortest, _INSTANT):
            hours = format_quantity(limits.budget, "h", 3)
            what = "{hours} are time for {times} times the {most:,} readings that are chosen together at most"
            remedy = "Say how many readings as well, or give an accuracy"
            raise PlanError(what, remedy, hours=hours, times=_ABSURD, most=MOST)


def reached_unread(case: Case, limits: Limits) -> str | None:
    """Say that errors of the usual sizes are within what a few readings can be held to; None where they are not."""
    if limits.rows or not (limits.accurate and len(case.sizes) and reached(case, limits, case.knowledge)):
        return None
    wanted = asked(limits, case.yardstick)
    met = any(known_to(each.name, case.yardstick, case.prior) <= each.limit for each in wanted)
    unread = "errors of the sizes that are stated or usual meet the target unread: a few readings check their sizes"
    hardly = "readings can take hardly anything away from errors of the stated or usual sizes: a few check these sizes"
    return said(unread) if met else said(hardly)


def beyond_budget(case: Case, limits: Limits) -> str | None:
    """Name the set-ups whose first reading takes longer than a budget; None where there are none."""
    if limits.budget is None:
        return None
    first, setups = first_seconds(posed(case, case.knowledge, candidates=_CANDIDATES)), case.description.setups
    late = [(setups[index].name, seconds) for index, seconds in first.items() if seconds > limits.budget]
    named = [put('"{setup}" ({time:.3g} min)', setup=name, time=seconds / 60) for name, seconds in late]
    what = "Mounting and one reading take longer than the {given:.3g} min there are: {setups}"
    return said(what, given=limits.budget / 60, setups=listed(", ", named)) if late else None


def _what_helps(case: Case, target: Target) -> str:
    """Say which set-ups would help and how long they take, or what cannot be seen, or what the rests leave."""
    rest = math.sqrt(case.yardstick.rest)
    if all(rest > each.limit for each in asked(target, case.yardstick)):
        finer = "The rests of the errors alone make {rms:.3g} um: with finer knots they could be smaller"
        surer = "The rests of the errors alone make {rms:.3g} um: with a smaller std they could be smaller"
        return said(surer if case.description.usual else finer, rms=to_unit(rest, "um"))
    hidden = listed(" ", [part.text for part in hidden_of(case)[:_NAMED]])
    found = helping_setups(case, target)
    helps = said("Another set-up would help.") if found is None else helping_words(found)
    return said("{helps} What cannot be seen: {hidden}", helps=helps, hidden=hidden)


@one_thread()
def proposed(case: Case, limits: Limits, candidates: int = CANDIDATES) -> Plan:
    """Return a plan of the readings to come, from the beginning.  Raises PlanError, DescriptionError.

    Places and order are those that a campaign asks for that goes on with these limits.
    candidates : how many places to choose from
    """
    refuse_unmade(case)
    task = posed(case, case.knowledge, candidates=candidates)
    places = reaching(case, task, limits, enough(case, limits))
    checks = frozenset(i for i, place in enumerate(places) if place.check)
    return replace(judged(task, places_of(case.description.setups, places)), checks=checks)


class Bought(NamedTuple):
    """What some time buys: s, and U of the volume after it, m.  mark : which share of the plan's time it is"""

    seconds: float
    expanded: float
    mark: Mark | None


@one_thread()
def bought(case: Case, places: Places, seconds: float, candidates: int = CANDIDATES) -> tuple[Bought, ...]:
    """Return roughly what a quarter of the time of a plan up to twice as much buys; none where it has no readings.

    places, seconds : of the plan; candidates : places that it was chosen from
    """
    if not len(places):
        return ()
    task = posed(case, case.knowledge, candidates=candidates).coarse
    setups = tuple(np.unique(places.setups).tolist())
    found, left, asked = list[Bought](), np.inf, _space(case, places)
    others = stretched(task, setups, places, max(MANY, len(places)), [share * seconds for share in _SHARES])
    for (share, mark), each in zip(_SHARES.items(), others, strict=True):
        left = min(left, _space(case, each))  # what less time buys, more does
        within = asked if share <= 1.0 else 0.0, asked if share >= 1.0 else np.inf
        found.append(Bought(share * seconds, float(np.clip(left, *within)), mark))
    return tuple(found)


def _space(case: Case, places: Places) -> float:
    """Return U of the volume after some places, m."""
    return expanded(case.yardstick, foreseen(case, (), with_rooms(case, places)).belief).space
