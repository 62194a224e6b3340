"""A zero, or the growth of an axis, that comes and goes while a set-up is read: what shows it, and what hides it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from axiscal.estimation.deciding import _decided
from axiscal.estimation.defence import Departed
from axiscal.estimation.effect_map import EffectMap
from axiscal.inference.contradiction import SIZES, Comparison, Explanation, compared, watched
from axiscal.measurement.departures import IN_PLANS, Departure, departures
from numpy.typing import NDArray

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.inference.weighted_fit import Fitted
from axiscal.measurement.reading import Reading
from axiscal.simulation import Simulator
from benchmarks.trust.benches import case_of
from tests.estimation.test_defence import CAMPAIGN, axis, of
from tests.generators.laser_axis import MACHINE
from tests.measurement.test_together import BOTH, GRID, PLATE, described

TURN, HALF_WAY = 11, 5
TWO = CAMPAIGN + CAMPAIGN[CAMPAIGN.index("[[setups]]") :].replace('"laser"', '"again"')


def out_and_back(again: tuple[int, ...] = ()) -> list[Reading]:
    """Return readings at twelve even places, out and back, a minute apart, and then some of them once more."""
    out = [((float(x),), (1,)) for x in np.linspace(0.01, 0.99, 12)]
    back = [((float(x),), (-1,)) for x in np.linspace(0.01, 0.99, 12)[::-1]]
    places = [*out, *back, *([*out, *back][index] for index in again)]
    return [Reading("laser", *place, 0.0, time=60.0 * index) for index, place in enumerate(places)]


def passing(taken: list[Reading]) -> list[Departure]:
    """Return what comes and goes of a zero, and of an axis held at one end, in the middle and at the other."""
    every = departures(axis().observation, taken, IN_PLANS)
    return [each for each in every if each.family in ("excursion", "growth")]


def worst(case: Case, taken: list[Reading]) -> dict[str, Departed]:
    return {each.family: each for each in of(case, taken, 0.6e-6).departures}


def test_a_zero_that_comes_and_goes_is_a_wave_over_the_time_of_the_set_up() -> None:
    taken = out_and_back()
    zero, *growths = passing(taken)
    times, at = np.array([(r.time, r.pose[0]) for r in taken]).T
    wave = np.sin(np.pi * times / times.max()) ** 2
    assert zero.columns[:, 0] == pytest.approx(wave, abs=1e-12)
    assert [(each.owner, each.place) for each in growths] == [("EXX", 0.0), ("EXX", 0.5), ("EXX", 1.0)]
    for each in growths:
        assert each.columns[:, 0] == pytest.approx(wave * (at - each.place), abs=1e-12)
        assert each.function is None  # the machine is as it was once the last reading is taken


def test_a_probe_that_no_axis_carries_along_its_own_direction_sees_no_growth() -> None:
    observation = described(PLATE, BOTH)
    readings = [Reading("dial", (float(y), float(x)), (1, 1), 0.0, time=float(n)) for n, (y, x) in enumerate(GRID)]
    families = [each.family for each in departures(observation, readings)]
    assert families.count("excursion") == 1
    assert "growth" not in families


def test_readings_whose_time_stands_still_show_nothing_of_it() -> None:
    taken = [replace(each, time=5.0) for each in out_and_back()]
    assert passing(taken) == []


def coarse(taken: list[Reading]) -> list[Reading]:
    """Return readings as a clock stamps them that knows of two times alone."""
    return [replace(each, time=0.0 if index < TURN else 3600.0) for index, each in enumerate(taken)]


def test_what_a_clock_of_two_times_cannot_show_is_not_vouched_for() -> None:
    """What comes and goes between two times is 0 at both, and the readings may have been anywhere in between."""
    case, taken = axis(), coarse(out_and_back((HALF_WAY, TURN)))
    families, share = worst(case, taken), (np.arange(100_000) + 0.5) / 100_000
    for family, moved in {"excursion": np.sin(np.pi * share) ** 2, "growth": share}.items():
        assert families[family].damage == pytest.approx(20e-6 * np.std(moved), rel=1e-6)
        assert families[family].seen_from == np.inf
        assert families[family].power == 0.0
        assert families[family].exceeds(2e-6)
    assert np.isfinite([each.damage for each in families.values()]).all()
    found = of(case, taken, 2e-6)
    assert found.unchecked
    assert found.u_def > 7e-6
    resolved = worst(case, out_and_back((HALF_WAY, TURN)))
    assert not any(resolved[family].exceeds(2e-6) for family in ("excursion", "growth"))
    every = passing(taken)
    assert [each.wrong for each in EffectMap.of(case, taken).each(every)] == [0.0] * len(every)


def twice() -> tuple[Case, list[Reading]]:
    """Return an axis that two lasers read one after the other, and that grew in the course of the second alone."""
    taken = out_and_back((HALF_WAY, TURN))
    grown = next(each for each in passing(taken) if each.family == "growth" and each.place == 0.0).columns[:, 0]
    second = [
        replace(each, setup="again", value=20e-6 * float(by), time=7200.0 + (each.time or 0.0))
        for each, by in zip(taken, grown, strict=True)
    ]
    return Case(campaign_from_texts(TWO, "c.toml", MACHINE, "m")), [*taken, *second]


@pytest.mark.parametrize("setup", [0, 1])
def test_what_decides_is_found_for_the_set_up_in_which_an_axis_grew(setup: int) -> None:
    """Against the two normals written out: what a growth in each of the set-ups lets the next reading show."""
    case, readings = twice()
    readings = readings[:-8]  # on its way back
    grown = Explanation("growth", "EXX", 0.0, 1.0, 0.0, 0.0, setup)
    step = next(each for each in watched(case.observation, readings).explanations if each.family == "step")
    found = _decided(case, readings, (grown, step), ())
    assert found is not None
    last = readings[-1]
    time = (last.time or 0.0) + case.seconds_of(last, found.place)
    together = [*readings, Reading("again", found.place.pose, found.place.approach, 0.0, time=time)]
    plain = Fitted.of(case.observation, together)
    unit = float(np.sqrt(np.median(Fitted.of(case.observation, readings).noise)))
    (part,) = [
        each.columns
        for each in departures(case.observation, together, taken=len(readings))
        if (each.family, each.place, each.setup) == ("growth", 0.0, setup)
    ]
    whole = plain.covariance() + (unit * SIZES[-1]) ** 2 * part @ part.T
    expected = np.linalg.solve(whole[:-1, :-1], whole[:-1, -1]) @ [each.value for each in readings]
    assert found.expected[0] == pytest.approx(expected, rel=1e-4, abs=1e-9)


def test_an_axis_that_grew_is_told_set_up_by_set_up() -> None:
    case, readings = twice()
    told = {each.family: each for each in watched(case.observation, readings).explanations}
    assert told["growth"].setup == 1
    assert all(each.setup is None for name, each in told.items() if name != "growth")
    damages = [each for each in of(case, readings, 0.6e-6).departures if each.family == "growth"]
    assert len(damages) == 2


def test_once_out_and_back_it_hides_and_two_places_once_more_show_it() -> None:
    case = axis()
    hidden, seen = worst(case, out_and_back()), worst(case, out_and_back((HALF_WAY, TURN)))
    for family in ("excursion", "growth"):
        assert hidden[family].damage > 2e-6
        assert seen[family].damage < 0.8e-6
        assert hidden[family].power < 0.2
    assert of(case, out_and_back(), 0.6e-6).unchecked


def put_in(values: NDArray[np.floating[Any]], again: tuple[int, ...], seed: int) -> Comparison:
    """Return what the readings of a machine say to which something was added, um."""
    case, taken = case_of("axis", "stated"), out_and_back(again)
    machine = Simulator(case.description.machine, case.description.setups).drawn(seed)
    rng, setup = np.random.default_rng(seed), case.description.setups[0]
    shown = [
        replace(each, setup="it", value=machine.read(setup, each.pose, each.approach, rng) + 1e-6 * float(value))
        for each, value in zip(taken, values, strict=True)
    ]
    return compared(case.observation, shown)


def test_a_zero_that_came_and_went_is_told_from_a_drift_and_from_one_that_was_set_anew() -> None:
    again = (HALF_WAY, TURN)
    share = np.arange(26) / 25
    wave, drift, jump = 10 * np.sin(np.pi * share) ** 2, 10 * share, 10.0 * (share > 0.3)
    right = [{"excursion"}, {"drift", "levelling"}, {"jump"}]
    for values, names in zip((wave, drift, jump), right, strict=True):
        found = [put_in(values, again, seed) for seed in range(6)]
        assert all(each.contradicted for each in found)
        assert sum(each.explanations[0].family in names for each in found) >= 5


def test_growth_that_came_and_went_in_a_straight_line_is_found_too() -> None:
    """As a triangle over the time, which the wave is not, and held at the start."""
    share = np.arange(26) / 25
    at = np.array([each.pose[0] for each in out_and_back((HALF_WAY, TURN))])
    found = [put_in(10 * at * (1 - np.abs(2 * share - 1)), (HALF_WAY, TURN), seed) for seed in range(6)]
    assert all(each.contradicted for each in found)
    assert sum(each.explanations[0].family in ("growth", "excursion") for each in found) >= 5


def test_a_right_machine_is_not_said_to_come_and_go() -> None:
    found = [put_in(np.zeros(26), (HALF_WAY, TURN), seed) for seed in range(6)]
    assert sum(each.contradicted for each in found) <= 1
