"""What is asked for where a noise that was only stated might be the machine: places that were read, once more."""

from __future__ import annotations

import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.timed import Timed, timed
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.planning.next_readings import planned_places
from axiscal.record.events import Asked, Gap
from tests.estimation.test_scatter import MACHINE, TEXT, read


def asked(rms: str, taken: list[Reading], gaps: tuple[Gap, ...] = (), limit: str = "") -> tuple[Place, ...]:
    """Return what is asked for after some readings where so much is asked for.  limit : a line of the target"""
    text = TEXT.format(scales="stated", noise="3 um").replace("readings = 40", f'rms = "{rms}"\n{limit}')
    case = Case(campaign_from_texts(text, "c.toml", MACHINE.format(rest='"estimate"'), "m"))
    return planned_places(case, case.knowledge.read(taken), taken, gaps)


@pytest.mark.parametrize("again", [0, 2])
def test_a_promise_beside_a_large_noise_asks_for_what_was_read(again: int) -> None:
    first = read()
    taken = read(*[reading.pose[0] for reading in first[:again]])
    places = asked("2.5 um", taken)
    assert len(places) == 3 - again
    assert {place.pose for place in places} <= {reading.pose for reading in first}
    assert len({place.pose for place in places}) == len(places)
    assert places[0].pose == taken[-1].pose


@pytest.mark.long
def test_where_enough_was_read_twice_or_nothing_is_promised_other_places_are() -> None:
    first = read()
    seen = {reading.pose for reading in first}
    repeated = read(*[reading.pose[0] for reading in first[:3]])
    assert not {place.pose for place in asked("2.5 um", repeated)} <= seen
    assert not {place.pose for place in asked("0.2 um", first)} <= seen


def test_a_place_that_could_not_be_read_is_not_asked_for_again() -> None:
    taken = read()
    last = taken[-1].place
    places = asked("2.5 um", taken, (Gap(Asked(1, last), "a clamp", whole=False),))
    assert len(places) == 2
    assert last.pose not in {place.pose for place in places}


def test_no_more_is_asked_for_than_there_are_readings_or_minutes_left() -> None:
    taken = read()
    every = asked("2.5 um", taken)
    assert asked("2.5 um", taken, limit=f"readings = {len(taken) + 2}") == every[:2]
    case = Case(
        campaign_from_texts(
            TEXT.format(scales="stated", noise="3 um"), "c.toml", MACHINE.format(rest='"estimate"'), "m"
        )
    )
    gone = timed(case, taken, Timed()).seconds
    first, second, _ = case.seconds_along(taken[-1], every).tolist()
    for left, count in ((first + 0.5 * second, 1), (first + 1.01 * second, 2)):
        assert asked("2.5 um", taken, limit=f'budget = "{gone + left} s"') == every[:count]
