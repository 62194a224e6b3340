"""The rest of a plan while measuring: it stands, or is renewed from what is known, in limits, on a short way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.machine.motion import approach_seconds
from axiscal.measurement.reading import Places
from axiscal.planning.next_readings import next_places
from axiscal.planning.plan.order import in_order, seconds_along
from axiscal.planning.plan.plan import make_plan, renewed
from axiscal.planning.plan.task import Limits, Task
from axiscal.record.events import Asked, Gap
from tests.generators.campaigns import built_in
from tests.generators.designs import levered, read_at, rms_of
from tests.generators.texts import campaign_text, setup_text


def taken(asked: Task, places: Places, believed: bool = True) -> Task:
    """Return the problem after readings; where nobody believes them only the way to them is left."""
    known, last = read_at(asked, places) if believed else asked, places.single(len(places) - 1)
    return replace(known, here=replace(last, approaches=np.zeros((1, 3))))


def part(places: Places, start: int, stop: int | None = None) -> Places:
    """Return places from one to another."""
    return places.within(slice(start, stop))


def same(places: Places, others: Places) -> bool:
    """Whether two plans take the same readings, in whatever order."""
    keys = [sorted((s, *p) for s, p in zip(some.setups, some.poses.tolist(), strict=True)) for some in (places, others)]
    return keys[0] == keys[1]


def worth(asked: Task, places: Places) -> float:
    """Return J after readings."""
    return asked.after(places).value


def way(asked: Task, places: Places) -> float:
    """Return the seconds of readings in this order, one after the other."""
    machine, before, seconds = asked.observation.machine, asked.here, 0.0
    for place in map(places.single, range(len(places))):
        setup = asked.observation.setups[place.setups[0]]
        if before is None or before.setups[0] != place.setups[0]:
            seconds += setup.setup_time
        else:
            sides = place.approaches[0] * [axis == 1 for axis in range(3)]  # only X has a reversal
            seconds += float(approach_seconds(machine, before.poses[0], place.poses[0], sides))
        seconds, before = seconds + setup.settle + setup.reading_time, place
    return seconds


ASKED = levered(150)
PLAN = make_plan(ASKED, Limits(readings=14), patience=0.0).places


@pytest.mark.parametrize("done", [1, 9])
def test_readings_taken_as_planned_leave_the_plan_as_it_is(done: int) -> None:
    after = taken(ASKED, part(PLAN, 0, done))
    rest = renewed(after, Limits(readings=14 - done), part(PLAN, done))
    assert worth(after, rest) == pytest.approx(worth(ASKED, PLAN), rel=0.01)
    assert worth(after, rest) <= worth(after, part(PLAN, done)) * (1 + 1e-9)
    assert way(after, rest) <= way(after, part(PLAN, done)) * 1.05


@pytest.mark.parametrize("seed", range(2))
def test_after_a_reading_elsewhere_no_worse_than_what_was_left_and_about_as_good_as_a_new_plan(seed: int) -> None:
    pose = np.random.default_rng(seed).uniform([-1.0, 0.0, 0.0], [2.0, 0.6, 0.4])
    after = taken(ASKED, replace(part(PLAN, 0, 4), poses=np.vstack([PLAN.poses[:3], pose])))
    rest = renewed(after, Limits(readings=10), part(PLAN, 4))
    fresh = make_plan(after, Limits(readings=10), patience=0.0)
    assert len(rest) == 10
    assert worth(after, rest) <= worth(after, part(PLAN, 4)) * (1 + 1e-9)
    assert worth(after, rest) <= 1.1 * fresh.value


def test_a_rejected_reading_is_made_up_for_where_an_accuracy_is_asked_for() -> None:
    before, floor = ASKED.yardstick.measure(ASKED.belief), ASKED.yardstick.rms_floor
    target = floor + 0.55 * (before.rms - floor)
    limits = Limits(readings=60, rms=target)
    plan = make_plan(ASKED, limits, goal=rms_of(ASKED, target), patience=0.0)
    assert plan.accuracy.rms <= target
    half = len(plan.places) // 2
    first, bad = taken(ASKED, part(plan.places, 0, half)), plan.places.single(half)
    without = taken(first, bad, believed=False)
    rest = renewed(without, limits, part(plan.places, half + 1), goal=rms_of(without, target))
    assert rms_of(without, target).reached(rest)
    assert len(rest) >= len(part(plan.places, half + 1))


def test_a_target_beyond_many_readings_more_is_left_to_other_set_ups() -> None:
    two = replace(ASKED, here=Places.one(0, np.array([0.5, 0.3, 0.2]), np.zeros(3)))
    left = ASKED.lattice.within(ASKED.lattice.setups == 0).within(slice(0, 8))
    alone, both = ASKED.lattice.within(ASKED.lattice.setups == 0), ASKED.lattice
    of_one, of_all, known = (two.yardstick.measure(taken(two, each).belief) for each in (alone, both, left))
    floor = two.yardstick.rms_floor
    assert of_all.rms < 0.8 * of_one.rms

    def rest(rms: float, readings: int | None = None) -> Places:
        return renewed(two, Limits(readings, rms=rms), left, goal=rms_of(two, rms))

    assert len(rest(0.9 * of_one.rms)) == 0
    assert len(rest(floor, 9)) > 0  # which these do not bring within nine
    assert len(rest(known.rms, 9)) > 0
    assert len(rest(floor, 3)) == 3  # no more than there may be, though eight are left
    short = renewed(two, Limits(2, rms=floor), left.within(slice(0, 2)), goal=rms_of(two, floor))
    assert len(short) == 2


def test_a_set_up_that_has_come_to_be_needless_is_not_mounted() -> None:
    here = replace(ASKED, here=Places.one(0, np.array([0.5, 0.3, 0.2]), np.zeros(3)))
    mine = ASKED.lattice.within(ASKED.lattice.setups == 0)
    left = Places.joined([mine.within(slice(0, 4)), PLAN.within(PLAN.setups != 0)])
    begun, alone = (here.yardstick.measure(taken(here, each).belief).rms for each in (left.within(slice(0, 4)), mine))
    target = 0.5 * (begun + alone)
    rest = renewed(here, Limits(rms=target), left, goal=rms_of(here, target))
    assert set(rest.setups) == {0}
    assert way(here, rest) < way(here, left)
    assert rms_of(here, target).reached(rest)
    harder = 0.95 * alone
    assert set(renewed(here, Limits(rms=harder), left, goal=rms_of(here, harder)).setups) != {0}


@pytest.mark.parametrize("share", [0.6, 1.3])
def test_a_budget_is_kept(share: float) -> None:
    after = taken(ASKED, part(PLAN, 0, 4))
    whole = seconds_along(after, in_order(after, part(PLAN, 4)))
    rest = renewed(after, Limits(budget=share * whole), part(PLAN, 4))
    assert 0.5 * share * whole < way(after, rest) <= share * whole
    assert share < 1 or len(rest) > len(part(PLAN, 4))


TEXT = campaign_text(
    "one-axis", setup_text("laser", "interferometer", direction="x", unknowns={}, approach="+"), target={"readings": 8}
)


@pytest.fixture(scope="module")
def case() -> Case:
    """Return one axis of a metre with a laser that needs no zero."""
    return Case(built_in(TEXT))


def test_nothing_is_planned_in_a_gap(case: Case) -> None:
    (first, *_) = next_places(case, case.knowledge, ())
    places = next_places(case, case.knowledge, (), gaps=[Gap(Asked(1, first), "blocked")])
    assert len(places) >= 7
    assert all(abs(place.pose[0] - first.pose[0]) >= 0.01 for place in places)
