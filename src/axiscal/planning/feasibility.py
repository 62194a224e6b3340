"""Whether the target can be reached with the set-ups at all, said before the first reading."""

from __future__ import annotations

import math

import numpy as np

from axiscal.accuracy.yardstick import Yardstick
from axiscal.design.bound.relaxation import Relaxation
from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.covariance import Covariance
from axiscal.design.plan.plan import Plan
from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.exceptions import PlanError, TargetError
from axiscal.measurement.place_texts import reading_unit
from axiscal.measurement.time_taken import reading_seconds
from axiscal.numerics.threads import one_thread
from axiscal.planning.next_readings import posed
from axiscal.planning.promise import reachable_rms
from axiscal.units import format_quantity, to_unit

_NAMED = 3
"""Sentences that are read; the others would repeat them."""
_CANDIDATES = 1000
"""Enough to say that a target needs too many readings, which a plan then says better."""
_ROUNDS = 12
"""Doublings of the readings, to the most that a plan has."""
MOST = 1000
"""Readings beyond which no plan is made."""
MOST_CANDIDATES = 500_000
_ABSURD = 100
"""So many times more time than a plan can fill is a slip; any factor between that of a long day and a year would do."""
_INSTANT = 1e-3
"""Seconds of a reading that is said to take no time."""


@one_thread()
def out_of_reach(case: Case) -> str | None:
    """Return why the RMS target cannot be reached with these set-ups and what would help; None if it can."""
    target = case.description.target.rms
    floor = reachable_rms(case)
    if target is None or floor <= target:
        return None
    said = f"With these set-ups the RMS cannot fall below {to_unit(floor, 'um'):.3g} um, whatever is read"
    wanted = f"the target is {to_unit(target, 'um'):.3g} um"
    rest = math.sqrt(case.yardstick.moments.rest)
    if rest > target:
        help_text = (
            f"the rests of the errors alone make {to_unit(rest, 'um'):.3g} um: finer knots would let them shrink"
        )
    else:
        hidden = " ".join(part.text for part in case.hidden[:_NAMED])
        help_text = f"another set-up would help. What cannot be seen: {hidden}"
    return f"{said}; {wanted}. The campaign stops at the target for what can be seen; {help_text}"


@one_thread()
def refuse_out_of_reach(case: Case, limits: Limits) -> None:
    """Raise TargetError for an RMS that these set-ups cannot bring, however often or MOST times read, and say why."""
    if limits.rms is None:
        return
    target, floor = to_unit(limits.rms, "um"), reachable_rms(case)
    if floor > limits.rms:
        what = f"an RMS of {target:.3g} um is out of reach: endless readings would leave {to_unit(floor, 'um'):.3g} um"
        raise TargetError(what, _what_hides(case, limits.rms))
    if limits.readings is None and limits.budget is None:
        _refuse_too_noisy(case, limits.rms)


def refuse_endless(case: Case, limits: Limits, candidates: int) -> None:
    """Raise PlanError for a plan of so many readings, or chosen from so many places, that nobody would see its end."""
    if candidates > MOST_CANDIDATES:
        what = f"a choice among {candidates:,} places is not made: at most {MOST_CANDIDATES:,} are compared"
        raise PlanError(what, "Leave --candidates out: readings are brought to the best places between them anyway")
    if (limits.readings or 0) > MOST:
        what = f"a plan of {limits.readings:,} readings is not made: at most {MOST:,} are chosen together"
        raise PlanError(what, "Ask for fewer, or for an accuracy with --target; a campaign goes on after its plan")
    if limits.readings is None and limits.budget is not None and not limits.accurate:
        shortest = min(reading_seconds(setup) for setup in case.description.setups)
        if limits.budget > _ABSURD * MOST * max(shortest, _INSTANT):
            hours = format_quantity(limits.budget, "h", 3)
            what = f"{hours} are time for {_ABSURD} times the {MOST:,} readings that are chosen together at most"
            raise PlanError(what, "Say how many readings as well, with --readings, or give an accuracy with --target")


def fewer_than_asked(limits: Limits, plan: Plan) -> str | None:
    """Say that a plan has fewer readings than were asked for, and why; None where it has not."""
    planned = len(plan.readings)
    if limits.readings is None or planned >= limits.readings:
        return None
    why = "they reach the accuracy that is asked for" if plan.met else "no other reading is worth its time"
    if limits.budget is not None and not plan.met:
        why = f"more do not fit into {format_quantity(limits.budget, 'min', 4)}"
    return f"{limits.readings:,} readings were asked for and {planned:,} are planned: {why}"


def _what_hides(case: Case, target: float) -> str:
    """Say what endless readings would leave, and what would help against it."""
    said, rest = [], math.sqrt(case.yardstick.moments.rest)
    if case.yardstick.unseen_rms > target or rest <= target:
        said.append("Another set-up would help. What cannot be seen:")
        said += [part.text for part in case.hidden[:_NAMED]]
    if rest > target:
        alone = f"The rests of the errors alone make {to_unit(rest, 'um'):.3g} um"
        said.append(f"{alone}: with finer knots they could be smaller")
    return " ".join(said)


def not_to_the_letter(case: Case, limits: Limits, plan: Plan) -> str | None:
    """Say that a plan leaves a larger RMS than was asked for, and why; None where it does not."""
    if limits.rms is None or plan.accuracy.rms <= limits.rms:
        return None
    target, left = to_unit(limits.rms, "um"), to_unit(reachable_rms(case), "um")
    helps = f" {_what_hides(case, limits.rms)}" if reachable_rms(case) > limits.rms else ""
    if plan.met:
        why = "so the target counts as reached for what readings can tell"
        return f"endless readings would leave {left:.3g} um of the {target:.3g} um asked for, {why}.{helps}"
    return f"the target of {target:.3g} um is not reached; endless readings would leave {left:.3g} um.{helps}"


def _refuse_too_noisy(case: Case, target: float) -> None:
    """Raise TargetError where not even the best weights of MOST readings, whatever is planned, bring the accuracy."""
    yardstick = case.yardstick
    asked = posed(case, case.knowledge, candidates=_CANDIDATES)
    pool = Pool(asked.observation, asked.lattice)
    state = Covariance.of(case.observation, case.prior, yardstick.root)
    relaxation = Relaxation(pool, state, pool.none, np.ones(len(pool)), float(MOST))
    for _ in range(_ROUNDS):
        dual = relaxation.solved()
        slopes = relaxation.slopes(dual)
        least = dual.whole - MOST * float(slopes.max())
        if not _met(yardstick, target, least):
            what = f"an RMS of {to_unit(target, 'um'):.3g} um is out of reach: {MOST:,} readings leave at least "
            what += f"{to_unit(yardstick.rms_of(least), 'um'):.3g} um"
            raise TargetError(what, _what_helps(case, relaxation))
        if _met(yardstick, target, dual.value) or not relaxation.grow(slopes):
            return


def _met(yardstick: Yardstick, target: float, value: float) -> bool:
    return Limits(rms=target).met(yardstick.figures(value, np.zeros(1)))


def _what_helps(case: Case, relaxation: Relaxation) -> str:
    """Say in which set-up half the noise would help most."""
    setups, of = case.description.setups, relaxation.setups
    left = [relaxation.value_if(np.where(of == index, 4.0, 1.0)) for index in range(len(setups))]
    best = int(np.argmin(left))
    noise = format_quantity(setups[best].noise / 2, reading_unit(setups[best]))
    reached = to_unit(case.yardstick.rms_of(left[best]), "um")
    return f'With half the noise in "{setups[best].name}" ({noise}) it would be {reached:.3g} um; or ask for less'
