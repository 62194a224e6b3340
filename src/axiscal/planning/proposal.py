"""A whole plan from the beginning, and the proof of how good any other could be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.design.bound.prove import prove, refuse_setup
from axiscal.design.gains.candidate_rows import MEMORY
from axiscal.design.plan.plan import Plan, make_plan
from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.numerics.threads import one_thread
from axiscal.planning.next_readings import posed

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Thoroughness:
    """candidates : places to choose from; memory : bytes that their rows may take"""

    candidates: int = 4000
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
    progress: Progress = lambda _: None,
    only: Sequence[int] | None = None,
    bounded: bool = True,
) -> Proposal:
    """Return a plan from the beginning, with its bound; of some set-ups, if `only` names them.  Raises PlanError.

    bounded : whether the bound is wanted
    """
    task = posed(case, case.knowledge, candidates=how.candidates)
    task = replace(task, memory=how.memory)
    if only is not None:
        task = replace(task, lattice=task.lattice.within(np.isin(task.lattice.setups, only)))
    return Proposal(make_plan(task, limits, bounded=bounded, shake=case.description.usual, progress=progress))


def refuse_unless_provable(case: Case) -> None:
    """Raise PlanError where no proof for readings anywhere can be had, before any time is spent on a plan."""
    for index in range(len(case.description.setups)):
        refuse_setup(case.observation, index)


@one_thread()
def proven(case: Case, proposal: Proposal, how: Thoroughness, gap: float, progress: Progress) -> Proposal:
    """Return a plan with a bound for as many readings of any of the set-ups, wherever they are taken.

    gap : share of J at which to stop.  Raises PlanError.
    """
    task = posed(case, case.knowledge, candidates=how.candidates)
    proof = prove(task.state, task.lattice, proposal.plan.places, gap, progress)
    return Proposal(replace(proposal.plan, bound=proof.bound), proof.gap)
