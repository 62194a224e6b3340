"""Checks are a fifth of a plan, drawn and put where they cost least; small plans and exact ones have none."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.exceptions import PlanError
from axiscal.measurement.reading import Place
from axiscal.measurement.reading_rows import blank_readings, places_of
from axiscal.planning.enough import reached_by
from axiscal.planning.next_readings import next_places, placed, posed
from axiscal.planning.other_readings import Within, checks_among, with_checks, with_rooms
from axiscal.planning.plan.order import seconds_along
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from tests.generators.texts import machine_text, setup_text

MACHINE = machine_text("w-b-X-t", {"X": (0, 1000)}, {"EXX": 'std = "10 um", length = "200 mm"', "EXX_reversal": "3 um"})
LASER = setup_text(
    "laser",
    "interferometer",
    direction="x",
    noise="0.5 um",
    approach="both",
    reading_time="10 s",
    setup_time="10 min",
)
CAMPAIGN = f'machine = "m"\n[target]\nTARGET\n{LASER}'


def case_of(target: str, above: str = "") -> Case:
    return Case(campaign_from_texts(above + CAMPAIGN.replace("TARGET", target), "c.toml", MACHINE, "m"))


@cache
def plan_of(target: str) -> tuple[Place, ...]:
    case = case_of(target)
    return placed(case, proposed(case, Limits.of(case.description.target), 200))


def checked(case: Case, limits: Limits, plan: Within) -> tuple[Place, ...]:
    """Return a plan with its checks, before any reading."""
    return with_checks(case, posed(case, case.knowledge), limits, (), (), plan)


def checks(places: tuple[Place, ...]) -> list[Place]:
    return [place for place in places if place.check]


@pytest.mark.parametrize(
    ("readings", "count"), [(1, 0), (11, 0), (12, 3), (17, 3), (18, 4), (24, 5), (60, 12), (500, 12)]
)
def test_a_fifth_are_checks(readings: int, count: int) -> None:
    described = case_of("readings = 24").description
    assert checks_among(described, readings) == count
    assert checks_among(case_of("readings = 24", 'usual = "off"\n').description, readings) == 0
    assert checks_among(case_of("readings = 24\nchecks = 2").description, readings) == 2


def test_a_plan_has_its_readings_and_a_fifth_of_them_are_drawn() -> None:
    places = plan_of("readings = 15")
    assert (len(places), len(checks(places))) == (15, 3)
    assert len({place.pose for place in places}) == 15
    assert all(0 <= place.pose[0] <= 1 for place in places)


def test_an_accuracy_needs_fewer_readings_beside_checks() -> None:
    target = 'rms = "1.2 um"\nrefers_to = "as read"'
    alone, both = plan_of(f"{target}\nchecks = 0"), plan_of(target)
    assert len(alone) >= 12
    assert len(checks(both)) == max(3, round(len(alone) / 4))
    assert len(both) - len(checks(both)) < len(alone)
    case = case_of(target)
    assert reached_by(case, Limits.of(case.description.target), both)
    assert not reached_by(case, Limits.of(case.description.target), [each for each in both if not each.check])


@pytest.mark.parametrize("slack", [30.0, 45.0, 60.0])
def test_where_time_is_short_each_set_up_keeps_checks(slack: float) -> None:
    text = CAMPAIGN.replace("TARGET", 'budget = "9 h"')
    beside = text.partition("[[setups]]")[2].replace('"laser"', '"another"')
    case = Case(campaign_from_texts(f"{text}[[setups]]{beside}", "c.toml", MACHINE, "m"))
    task = posed(case, case.knowledge)
    chosen = [np.flatnonzero(task.lattice.setups == setup)[:12] for setup in (0, 1)]
    own = with_rooms(case, task.lattice.within(np.concatenate(chosen)))
    alone = seconds_along(task, places_of(case.description.setups, own))
    found = checked(case, Limits(budget=alone + slack), lambda *_: own)
    drawn = [place.setup for place in checks(found)]
    assert len(drawn) < checks_among(case.description, len(own) + 6)
    assert len(drawn) < 2 or {*drawn} == {"laser", "another"}
    assert seconds_along(task, places_of(case.description.setups, found)) <= alone + slack


def test_while_measuring_checks_that_are_open_stay_and_none_is_added() -> None:
    case = case_of("readings = 15")
    left = next_places(case, case.knowledge, ())
    for taken in (3, 9):
        readings = [
            replace(each, time=60.0 * n) for n, each in enumerate(blank_readings(case.description.setups, left))
        ]
        so_far, rest = readings[:taken], left[taken:]
        coming = next_places(case, case.knowledge.read(so_far), so_far, left=rest)
        assert {place.pose for place in checks(coming)} == {place.pose for place in checks(rest)}
        assert len(coming) == 15 - taken


def test_a_check_is_put_where_it_costs_least() -> None:
    """Every other turn in the same set-up takes as long or longer."""
    case = case_of("readings = 13\nchecks = 1")
    task, own = posed(case, case.knowledge), plan_of("readings = 12\nchecks = 0")
    found = checked(case, Limits(13), lambda *_: own)
    (at,) = [index for index, place in enumerate(found) if place.check]
    without = [*found[:at], *found[at + 1 :]]
    every = [(*without[:n], found[at], *without[n:]) for n in range(1, len(found))]
    least = min(seconds_along(task, places_of(case.description.setups, each)) for each in every)
    assert seconds_along(task, places_of(case.description.setups, found)) == pytest.approx(least, abs=0.5)


def test_fewer_readings_than_checks_are_refused_on_the_way() -> None:
    case = case_of("readings = 30\nchecks = 12")
    with pytest.raises(PlanError, match="12 checks leave none of 8 readings"):
        proposed(case, Limits(8))
