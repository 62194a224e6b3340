"""A whole plan from the beginning, and the proof of how good any other could be."""

from __future__ import annotations

from dataclasses import dataclass, replace

from axiscal.estimation.case import Case
from axiscal.estimation.timed import timed
from axiscal.exceptions import PlanError
from axiscal.measurement.place import Place
from axiscal.measurement.reading_rows import blank_readings
from axiscal.numerics.threads import one_thread
from axiscal.planning.bound.prove import prove
from axiscal.planning.enough import enough
from axiscal.planning.gains.candidate_rows import MEMORY
from axiscal.planning.next_readings import CANDIDATES, columns_of, first_places, planned_places, posed, until_reached
from axiscal.planning.plan.plan import Plan, judged
from axiscal.planning.plan.task import Limits, Task
from axiscal.planning.step.smooth import regions


@dataclass(frozen=True, slots=True)
class Thoroughness:
    """candidates : places to choose from; memory : bytes that their rows may take"""

    candidates: int = CANDIDATES
    memory: float = MEMORY


@dataclass(frozen=True, eq=False, slots=True)
class Proposal:
    """A plan with its bound.  gap : share of the bound on J at which its proof stopped; None if none was asked for."""

    plan: Plan
    gap: float | None = None


@one_thread()
def proposed(
    case: Case,
    limits: Limits,
    how: Thoroughness = Thoroughness(),
    bounded: bool = True,
) -> Proposal:
    """Return a plan from the beginning, with its bound.  Raises PlanError.

    Places and order are those that a campaign asks for that begins with these limits.
    bounded : whether the bound is wanted
    """
    task = replace(posed(case, case.knowledge, candidates=how.candidates), memory=how.memory)
    heeded = enough(case, task, limits)
    places = planned_places(case, task, heeded)
    if first_places(case, task, heeded):
        places += _after(case, task, heeded, places)
    else:
        places = until_reached(
            case, limits, heeded, places, lambda tighter, left: planned_places(case, task, tighter, left=left)
        )
    return Proposal(judged(task, heeded, columns_of(case, places), bounded))


def _after(case: Case, task: Task, limits: Limits, first: tuple[Place, ...]) -> tuple[Place, ...]:
    """Return the readings that follow on the first ones, whatever these show."""
    readings = blank_readings(case.description.setups, first)
    count = None if limits.readings is None else limits.readings - len(first)
    if count == 0:
        return ()
    spent = timed(case, readings).seconds
    left = replace(limits, readings=count, budget=None if limits.budget is None else max(limits.budget - spent, 0.0))
    then = posed(case, case.knowledge.read(readings), readings=readings, candidates=len(task.lattice))
    try:
        return planned_places(case, replace(then, memory=task.memory), left, readings)
    except PlanError:  # there is no time for another
        return ()


def refuse_unless_provable(case: Case) -> None:
    """Raise PlanError where no proof for readings anywhere can be had, before any time is spent on a plan."""
    for index in range(len(case.description.setups)):
        regions(case.observation, index)


@one_thread()
def proven(case: Case, proposal: Proposal, how: Thoroughness, gap: float) -> Proposal:
    """Return a plan with a bound for as many readings of any of the set-ups, wherever they are taken.

    gap : share of J at which to stop.  Raises PlanError.
    """
    task = posed(case, case.knowledge, candidates=how.candidates)
    proof = prove(task.state, task.lattice, proposal.plan.places, gap)
    return Proposal(replace(proposal.plan, bound=proof.bound), proof.gap)
