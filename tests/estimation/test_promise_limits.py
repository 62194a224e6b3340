"""From which size on a departure, a statement or a noise leaves a promise open, and what is said of it then."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from axiscal.accuracy.damage import KAPPA
from axiscal.estimation.defence import Defence, Departed, defence, vouched
from axiscal.estimation.effect_map import EffectMap
from axiscal.estimation.scatter import Scatter
from axiscal.estimation.statements import Resting
from axiscal.measurement.departures import IN_PLANS, Departure, Family, departures

from axiscal.measurement.reading import Reading
from tests.estimation.test_defence import axis, readings

UM = 1e-6
CASE = axis()


def departed(damage: float = 0.0, bearable: float = 0.0, family: Family = "step", counted: bool = True) -> Departed:
    """Return a departure.  damage, bearable : um"""
    return Departed(family, "EXX", 0.5, 1e-6, damage * UM, 0.0, counted, 0.1, bearable * UM)


def promised(promise: float, *departures_: Departed, stated: float = 0.0, noise: float = 0.0) -> Defence:
    """Return what readings vouch for beside a promise, um.

    stated, noise : the least promise, um, that bears what is stated, and a noise that may be the machine's
    """
    rests_on = Resting((), 0.5, 1e-6, 0.1, stated * UM) if stated else None
    scatter = Scatter(0, 1e-6, 3, noise * UM * math.sqrt(KAPPA**2 - 1)) if noise else None
    found = Defence(promise * UM, promise * UM, 20, departures_, rests_on, scatter)
    return found.promising(promise * UM)


@pytest.mark.parametrize(
    ("each", "exceeds"),
    [
        (departed(damage=1.25), False),
        (departed(damage=1.26), True),
        (departed(bearable=1.0), False),
        (departed(bearable=1.01), True),
        (departed(9.0, 9.0, "scale", counted=False), False),
    ],
)
def test_a_departure_leaves_a_promise_open_a_quarter_above_it_or_where_it_is_not_borne(
    each: Departed, exceeds: bool
) -> None:
    assert each.exceeds(1.0 * UM) == exceeds
    assert promised(1.0, each).leaves == exceeds
    assert promised(1.0, each).unchecked == exceeds
    assert promised(1.0, each).hides == (exceeds and each.bearable > 0)


def test_no_less_than_the_largest_of_all_is_vouched_for() -> None:
    many = departed(damage=2.0), departed(bearable=3.0, damage=1.0), departed(9.0, 9.0, counted=False)
    assert many[1].least == 3.0 * UM
    assert many[2].least == 0.0
    assert promised(1.0, *many).u_def == 3.0 * UM
    assert promised(4.0, *many).u_def == 4.0 * UM
    assert promised(1.0, *many, stated=3.5).u_def == 3.5 * UM
    assert promised(1.0, *many, stated=3.5, noise=5.0).u_def == pytest.approx(5.0 * UM)
    assert promised(1.0).u_def == 1.0 * UM
    assert promised(1.0, *many).promising(4.0 * UM) == promised(4.0, *many)


def test_a_promise_is_held_from_where_nothing_leaves_it_open_any_more() -> None:
    many = departed(damage=2.0), departed(bearable=1.5, damage=1.0), departed(9.0, 9.0, counted=False)
    assert promised(1.0, *many).held_from == pytest.approx(1.6 * UM)
    assert promised(1.0, *many[1:]).held_from == 1.5 * UM
    assert promised(1.0, *many, stated=3.5).held_from == 3.5 * UM
    assert promised(1.0, *many, stated=1.1, noise=5.0).held_from == pytest.approx(5.0 * UM)
    assert promised(4.0, *many).held_from == 4.0 * UM
    for found in (promised(1.0, *many), promised(1.0, *many, stated=3.5), promised(1.0, *many, noise=5.0)):
        assert found.unchecked
        assert found.promising(0.999 * found.held_from).unchecked
        assert not found.promising(1.001 * found.held_from).unchecked


def test_the_weakest_is_the_first_that_is_worse_than_the_promise() -> None:
    beside, first, second = departed(9.0, counted=False), departed(2.0, family="drift"), departed(1.5)
    assert promised(1.0, beside, first, second).weakest == first
    assert promised(1.7, beside, second).weakest is None
    assert promised(1.5, second).weakest is None
    assert promised(1.0).weakest is None


def test_a_headline_that_is_wider_is_vouched_for_and_what_is_open_stays_open() -> None:
    found = promised(1.0, departed(bearable=2.0)).at_least(3.0 * UM)
    assert (found.u_def, found.promise, found.unchecked) == (3.0 * UM, 1.0 * UM, True)
    assert promised(1.0, departed(bearable=2.0)).at_least(1.5 * UM).u_def == 2.0 * UM


@pytest.mark.parametrize(
    ("found", "rests"),
    [
        (promised(1.0, stated=1.0), False),
        (promised(1.0, stated=1.1), True),
        (promised(1.0, noise=1.1), True),
        (promised(1.0, stated=1.1, noise=1.1), True),
        (promised(1.0, departed(2.0), stated=1.1), True),
        (promised(1.0, departed(1.2), stated=1.1), True),
        (promised(1.0), False),
    ],
    ids=["borne", "stated", "a noise", "both", "and a departure", "and one that is defended", "nothing"],
)
def test_what_is_stated_or_noise_makes_a_promise_rest_on_it(found: Defence, rests: bool) -> None:
    assert found.rests == rests
    assert found.unchecked == (rests or found.leaves)


def test_a_family_is_the_mean_over_its_places_and_named_by_the_worst() -> None:
    case, taken, promise = CASE, readings(), 0.8e-6
    effects = EffectMap.of(case, taken)
    found = {(each.family, each.owner): each for each in vouched(case.observation, taken, effects, promise).departures}
    every = [each for each in departures(case.observation, taken, IN_PLANS) if each.family not in ("bad", "scale")]
    assert {(each.family, each.owner) for each in every} == set(found)
    counted = {"drift", "levelling", "excursion", "growth", "step", "pitch", "bump", "detail", "together"}
    for key, told in found.items():
        group = [each for each in every if (each.family, each.owner) == key]
        harms = effects.each(group)
        damages = [each.damage for each in harms]
        assert told.damage == pytest.approx(math.sqrt(sum(d**2 for d in damages) / len(damages)))
        assert told.power == pytest.approx(sum(each.power(promise) for each in harms) / len(harms))
        assert told.seen_from == max(each.seen_from for each in harms)
        assert damages[[each.place for each in group].index(told.worst)] == max(damages)
        assert told.counted == (told.family in counted)
        assert (told.hidden, told.bearable) == (0.0, 0.0)


def test_with_less_than_three_readings_a_drift_of_twenty_micrometres_is_open() -> None:
    """Its share of a set-up's time is spread evenly: 20 um/√12, and nothing is learnt of what else may be."""
    case = CASE
    for count in (0, 1, 2):
        found = defence(case, readings()[:count], 0.5e-6, case.description.machine)
        (drift,) = found.departures
        assert (drift.family, drift.owner, drift.power, drift.counted) == ("drift", "laser", 0.0, True)
        assert drift.seen_from == math.inf
        assert found.u_def == pytest.approx(20e-6 / math.sqrt(12))
        assert found.readings == count
    assert len(defence(case, readings()[:3], 0.5e-6, case.description.machine).departures) > 1


def test_more_than_four_hundred_readings_are_looked_at_in_part_and_counted_whole() -> None:
    case = CASE
    many = defence(case, readings(420, 6.0), 1e-6, case.description.machine)
    some = defence(case, readings(400, 6.0), 1e-6, case.description.machine)
    assert (many.readings, some.readings) == (420, 400)
    damage = [{(e.family, e.owner): e.damage for e in found.departures} for found in (many, some)]
    for key, size in damage[0].items():
        assert size == pytest.approx(damage[1][key], rel=0.2), key


@pytest.mark.parametrize(
    ("family", "place"), [("step", 4), ("bump", 10), ("detail", 11), ("pitch", 0), ("pitch", 1), ("reversal", 2)]
)
def test_what_is_left_over_the_volume_is_the_departure_less_what_the_estimate_makes_of_it(
    family: str, place: int
) -> None:
    """From both sides at 2,000 places of the axis, as a laser without a zero would read them."""
    case, taken = CASE, readings()
    (effect,) = EffectMap.of(case, taken).each([_of(family, taken, place)])
    at = (np.arange(2000) + 0.5) / 2000
    both = [replace(taken[0], pose=(float(x),), approach=(side,)) for side in (1, -1) for x in at]
    shown = _of(family, both, place).columns
    rows = np.array(case.observation.errors.rows(np.tile(at, 2)[:, None], np.repeat([1.0, -1.0], 2000)[:, None]))[:, 0]
    wrong = []
    for number, column in enumerate(_of(family, taken, place).columns.T):
        told = [replace(each, value=float(value)) for each, value in zip(taken, column, strict=True)]
        mean = case.knowledge.read(told).belief.mean[: case.errors.size]
        wrong.append(shown[:, number] - rows @ mean)
    left = np.array(wrong)
    left -= left.mean(axis=1, keepdims=True) if case.yardstick.zeroed[0] else 0.0
    assert effect.wrong == pytest.approx(float(np.mean(left**2)), rel=0.02)


def _of(family: str, taken: list[Reading], place: int) -> Departure:
    """Return one departure of a family, the one at this place in its list."""
    found = (each for each in departures(CASE.observation, taken, IN_PLANS) if each.family == family)
    return next(islice(found, place, None))
