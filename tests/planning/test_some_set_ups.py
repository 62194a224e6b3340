"""A plan of some set-ups has no unknowns of the others: what it knows is what is known among all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.setup import Unknown
from axiscal.planning.next_readings import posed
from axiscal.planning.plan.greedy import Setups, scores_among
from axiscal.planning.plan.minutes import quickest
from axiscal.planning.plan.scores import Scores
from axiscal.planning.plan.task import Goal, Limits, Task
from tests.generators.campaigns import on
from tests.generators.designs import levered, read
from tests.generators.texts import machine_text, setup_text

MACHINE = machine_text("w-b-X-t", {"X": (0, 1000)}, {"EXX": ("10 um", 9, 200), "EXX_reversal": "3 um"})


def lasers(count: int, **said: str) -> Case:
    """Return a campaign of one axis under so many lasers."""
    each = (setup_text(f"x{n}", "interferometer", direction="x", approach="both", **said) for n in range(count))
    return Case(on(MACHINE, *each, target={"readings": 4}, usual="off"))


def drifting() -> Task:
    """A task after readings of two set-ups whose zeros wander."""
    case = lasers(3, drift="1 um/min")
    taken = [Reading(f"x{n % 2}", (0.1 * n,), (1,), 0.0, time=600.0 * n) for n in range(1, 7)]
    return posed(case, case.knowledge.read(taken), readings=taken, candidates=90)


def sharing() -> Task:
    """A task of set-ups that share an unknown, with readings beside the plan."""
    asked = levered(90)
    tool = Unknown("tool_x", 1e-4, "tool")
    each = [(Unknown("zero", 1e-4), tool), (tool, Unknown("zero", 1e-3)), (Unknown("zero", 1e-3), tool)]
    mounted = [*asked.observation.setups, asked.observation.setups[0]]
    setups = tuple(replace(s, unknowns=own) for s, own in zip(mounted, each, strict=True))
    observation = Observation(asked.observation.errors, setups)
    belief = type(asked.belief)(np.zeros(observation.size), observation.prior_covariance())
    third = replace(asked.lattice, setups=np.where(asked.lattice.setups == 0, 2, 1))
    lattice = Places.joined([asked.lattice, third.within(third.setups == 2)])
    return replace(
        asked, observation=observation, belief=belief, lattice=lattice, beside=lattice.within(np.array([3, 80]))
    )


@pytest.mark.parametrize("asked", [read(levered(90), np.random.default_rng(0), 6), drifting(), sharing()])
@pytest.mark.parametrize("setups", [(1,), (0, 1)])
def test_gains_and_what_readings_leave_are_those_among_all(asked: Task, setups: Setups) -> None:
    every, some = Scores(asked), scores_among(asked, setups)
    mine = np.flatnonzero(np.isin(every.lattice.setups, setups))
    assert some.lattice.same_as(every.lattice.within(mine))
    for index in (2, 7, len(mine) - 1):
        np.testing.assert_allclose(some.gains, every.gains[mine], rtol=1e-6)
        some.put(index)
        every.put(int(mine[index]))
    assert some.value == pytest.approx(every.value, rel=1e-9, abs=0.0)


def test_where_another_set_up_hardly_helps_no_larger_sets_are_tried() -> None:
    case, tried = lasers(12), list[int]()
    task = posed(case, case.knowledge, candidates=60)
    never = Goal(lambda _: False, lambda _: False)

    def sets(size: int) -> Setups:
        tried.append(size)
        return tuple(range(size))

    assert quickest(task, Limits(rms=1e-9), map(sets, range(1, 13)), never, 0.0) is None
    assert len(tried) < 6
    tried.clear()
    assert quickest(task, Limits(rows=True), map(sets, range(1, 5)), never, 0.0) is None
    assert len(tried) == 4
