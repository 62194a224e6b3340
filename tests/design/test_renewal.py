"""The rest of a plan while measuring: it stands, or it is renewed and no worse, in limits, and on a short way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.design.gains.covariance import Point
from axiscal.design.plan.order import seconds_of
from axiscal.design.plan.plan import make_plan
from axiscal.design.plan.renewal import renewed
from axiscal.design.plan.task import Limits, Task, way_seconds
from axiscal.measurement.place import Places
from tests.generators.designs import levered


def taken(asked: Task, points: list[Point], believed: bool = True) -> Task:
    """Return the problem after readings; where nobody believes them only the way to them is left."""
    observation, belief = asked.observation, asked.belief
    for point in points:
        wider = observation.visited(point.pose, point.setup)
        belief, observation = belief.extended(observation.rest_variances(wider)), wider
        seen = observation.rows(point.setup, point.pose[None], point.approach[None])
        belief = belief.update(seen.rows, 0.0, seen.variances) if believed else belief
    here = replace(asked, observation=observation, belief=belief)
    return replace(here, here=Point(points[-1].setup, points[-1].pose, np.zeros(3)))


def same(points: list[Point], others: list[Point]) -> bool:
    """Whether two plans take the same readings, in whatever order."""
    keys = [sorted((p.setup, *p.pose.tolist()) for p in some) for some in (points, others)]
    return keys[0] == keys[1]


def worth(asked: Task, points: list[Point]) -> float:
    """Return J after readings."""
    return asked.state.with_points(points).value


def way(asked: Task, points: list[Point]) -> float:
    """Return the seconds of readings in this order."""
    return sum(way_seconds(asked, b, p) for b, p in zip([asked.here, *points[:-1]], points, strict=True))


ASKED = levered(300)
PLAN = make_plan(ASKED, Limits(readings=14), patience=0.0, bounded=False).points


@pytest.mark.parametrize("done", [1, 4, 9])
def test_readings_taken_as_planned_leave_the_plan_as_it_is(done: int) -> None:
    after = taken(ASKED, PLAN[:done])
    rest = renewed(after, Limits(readings=14 - done), PLAN[done:])
    assert worth(after, rest) == pytest.approx(worth(ASKED, PLAN), rel=0.01)
    assert worth(after, rest) <= worth(after, PLAN[done:]) * (1 + 1e-9)
    assert way(after, rest) <= way(after, PLAN[done:]) * 1.05


def test_a_plan_that_no_exchange_improves_stays_in_its_order() -> None:
    settled = PLAN[2:]
    after = taken(ASKED, PLAN[:2])
    for _ in range(5):
        settled = renewed(after, Limits(readings=12), settled)
    again = renewed(after, Limits(readings=12), settled)
    assert same(again, settled)
    assert way(after, again) <= way(after, settled)


@pytest.mark.parametrize("seed", range(4))
def test_after_a_reading_elsewhere_no_worse_than_what_was_left_and_about_as_good_as_a_new_plan(seed: int) -> None:
    pose = np.random.default_rng(seed).uniform([-1.0, 0.0, 0.0], [2.0, 0.6, 0.4])
    after = taken(ASKED, [*PLAN[:3], Point(PLAN[3].setup, pose, PLAN[3].approach)])
    rest = renewed(after, Limits(readings=10), PLAN[4:])
    fresh = make_plan(after, Limits(readings=10), patience=0.0, bounded=False)
    assert len(rest) == 10
    assert worth(after, rest) <= worth(after, PLAN[4:]) * (1 + 1e-9)
    assert worth(after, rest) <= 1.1 * fresh.value


def test_a_rejected_reading_is_made_up_for_where_an_accuracy_is_asked_for() -> None:
    target = 0.55 * ASKED.yardstick.measure(ASKED.belief).seen
    limits = Limits(readings=60, rms=target)
    plan = make_plan(ASKED, limits, patience=0.0, bounded=False)
    assert plan.met
    half = len(plan.points) // 2
    before, bad = taken(ASKED, plan.points[:half]), plan.points[half]
    without = taken(before, [bad], believed=False)
    rest = renewed(without, limits, plan.points[half + 1 :])
    assert limits.met(ASKED.yardstick.measure(taken(without, rest).belief))
    assert len(rest) >= len(plan.points[half + 1 :])


def test_what_came_to_be_too_much_is_left_out() -> None:
    after = taken(ASKED, PLAN[:4])
    assert len(renewed(after, Limits(readings=6), PLAN[4:])) == 6
    assert len(renewed(after, Limits(readings=12), PLAN[4:])) == 12
    known = after.yardstick.measure(taken(after, PLAN[4:]).belief).seen
    enough = renewed(after, Limits(readings=10, rms=1.2 * known), PLAN[4:])
    assert len(enough) < 10


@pytest.mark.parametrize("share", [0.6, 0.95, 1.3])
def test_a_budget_is_kept(share: float) -> None:
    after = taken(ASKED, PLAN[:4])
    whole = seconds_of(after, PLAN[4:])
    rest = renewed(after, Limits(budget=share * whole), PLAN[4:])
    assert 0.5 * share * whole < way(after, rest) <= share * whole
    assert share < 1 or len(rest) > len(PLAN[4:])


def test_what_there_is_no_time_to_mount_is_given_up() -> None:
    here = replace(ASKED, here=Point(1, np.array([0.5, 0.3, 0.2]), np.zeros(3)))
    elsewhere = [point for point in PLAN if point.setup == 0]
    rest = renewed(here, Limits(budget=300.0), elsewhere)
    assert {point.setup for point in rest} == {1}
    assert way(here, rest) <= 300.0
    assert renewed(ASKED, Limits(budget=300.0), elsewhere) == []


def test_nothing_but_what_is_left_may_be_allowed() -> None:
    after = taken(ASKED, PLAN[:4])
    nothing = Places(np.zeros(0, dtype=np.intp), np.zeros((0, 3)), np.zeros((0, 3)))
    assert same(renewed(replace(after, lattice=nothing), Limits(readings=10), PLAN[4:]), PLAN[4:])
