"""How far from linear readings are: draws of our own, and estimates made twice."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation, Linearity, linearity
from axiscal.estimation.learnt import without_bad
from axiscal.estimation.located import SETTLED, Absorbed, absorbed, located, moved_by
from axiscal.estimation.stations import indices
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen, shown_values
from benchmarks.nonlinear.stations import read, tracers
from tests.generators import laser_axis


def _located(case: Case, readings: list[Reading]) -> Absorbed:
    kept = without_bad(case, readings, {})
    return located(case.rescaled(kept.sizes), readings, [*kept.bad])


def _few(case: Case) -> tuple[Absorbed, list[Reading]]:
    """Return what eight readings of each tracer make known, and these; the first one stands off."""
    rng, places = np.random.default_rng(2), np.random.default_rng(1).uniform(0.0, 0.35, (8, 3))
    bare = [
        Reading(setup.name, (x, y, z), (1, 1, 1), 0.0, time=0.0)
        for setup in case.description.setups
        for x, y, z in places.tolist()
    ]
    truth = np.zeros(case.observation.size)
    truth[case.observation.unknowns_of(0)] = 0.7 * np.array([u.std for u in case.description.setups[0].unknowns])
    shown = shown_values(case.observation, bare, truth[: case.errors.size + len(case.observation.unknowns)])
    readings = [
        replace(each, value=float(value) + 1e-6 * rng.standard_normal())
        for each, value in zip(bare, shown, strict=True)
    ]
    return absorbed(case, readings, {}), readings


def test_the_index_of_few_readings_is_what_draws_of_the_belief_say() -> None:
    """The second order of a distance, over the noise: 120 draws beside the 64 of the module."""
    case = tracers("2 mm", "1 mm")
    known = absorbed(case, (), {})
    readings = [Reading("tracer 1", (0.1 * k, 0.2, 0.1), (1, 1, 1), 0.0, time=0.0) for k in range(3)]
    observation, belief = known.knowledge.observation, known.knowledge.belief
    numbers, rng = seen(observation, readings), np.random.default_rng(9)
    size = observation.errors.size + len(observation.unknowns)
    steps = (belief.factor @ rng.standard_normal((belief.size, 120)))[:size].T
    nominal = shown_values(observation, readings, belief.mean[:size])
    beyond = [shown_values(observation, readings, belief.mean[:size] + each) - nominal - numbers.rows[:, :size] @ each
              for each in steps]  # fmt: skip
    expected = np.sqrt(np.mean(np.square(beyond), axis=0) / numbers.variances)
    assert expected.min() > 0.3
    assert indices(known.knowledge, readings) == pytest.approx(expected, rel=0.4)
    assert indices(known.knowledge, []).shape == (0,)


def test_what_is_asked_of_another_round_is_the_step_of_the_mean_in_standard_deviations() -> None:
    """Readings linearised elsewhere and taken anew; less than a thousandth is nothing."""
    known, readings = _few(tracers("5 mm", "1 mm"))
    belief = known.knowledge.belief
    better = known.case.linear_about(belief.mean)
    after = absorbed(better, readings, {}).knowledge.belief
    step = np.linalg.lstsq(belief.factor, after.mean - belief.mean, rcond=None)[0]
    expected = float(np.sqrt(np.mean(step**2)))
    assert expected > 0.05
    assert moved_by(known, readings, better) == pytest.approx(expected, rel=0.1)
    assert moved_by(known, readings, known.case) == 0.0
    assert moved_by(known, [], better) == 0.0


def test_the_least_linear_reading_is_named_and_what_is_rounding_is_nothing() -> None:
    known, readings = _few(tracers("5 mm", "1 mm"))
    readings = readings[::-1]
    each = indices(known.knowledge, readings)
    worst = int(np.argmax(each))
    assert worst > 0
    found = linearity(cast("Estimation", SimpleNamespace(readings=tuple(readings), absorbed=known)))
    assert found.largest == pytest.approx(float(each.max()))
    assert found.reading == worst + 1
    assert [Linearity(largest, 1).gaussian for largest in (0.3, 0.31)] == [True, False]
    laser = concluded(laser_axis.CASE, laser_axis.read(laser_axis.machine(1), 6))
    assert linearity(laser).largest == 0.0
    assert linearity(concluded(laser_axis.CASE, [])) == (0.0, None)


@pytest.mark.long
def test_the_index_is_the_second_order_over_the_noise_of_machines_drawn_from_the_belief() -> None:
    case = tracers("20 mm", "5 mm")
    _, readings = read(case, 1)
    found = _located(case, readings[::6])
    some = readings[::18]
    observation, belief = found.knowledge.observation, found.knowledge.belief
    errors = observation.errors.size + len(observation.unknowns)
    numbers, rng, count = seen(observation, some), np.random.default_rng(9), 400
    mean, total = belief.mean[:errors], np.zeros(len(numbers.values))
    nominal = shown_values(observation, some, mean)
    for _ in range(count):
        step = (belief.factor @ rng.standard_normal(belief.size))[:errors]
        total += (shown_values(observation, some, mean + step) - nominal - numbers.rows[:, :errors] @ step) ** 2
    each = np.sqrt(total / count / numbers.variances)
    expected = np.array([each[numbers.reading == index].max() for index in range(len(some))])
    assert indices(found.knowledge, some) == pytest.approx(expected, rel=0.5)
    assert float(np.mean(indices(found.knowledge, some) / expected)) == pytest.approx(1.0, abs=0.12)
    assert indices(found.knowledge, []).shape == (0,)


@pytest.mark.long
def test_what_a_better_place_moves_is_what_an_estimate_made_there_says() -> None:
    """In standard deviations, RMS over all directions; a reading that counts for nothing moves nothing."""
    case = tracers("3 mm", "1 mm")
    _, readings = read(case, 4)
    some = readings[::3]
    before = absorbed(case, some, {})
    better = case.linear_about(before.knowledge.belief.mean)
    after = absorbed(better, some, {})
    belief = before.knowledge.belief
    step = np.linalg.lstsq(belief.factor, after.knowledge.belief.mean - belief.mean, rcond=None)[0]
    moved = moved_by(before, some, better)
    assert moved > 1.0
    assert moved == pytest.approx(float(np.sqrt(np.mean(step**2))), rel=0.05)
    assert moved_by(replace(before, left_out=frozenset(range(len(some)))), some, better) == 0.0
    settled = _located(case, some)
    again = settled.case.linear_about(settled.knowledge.belief.mean)
    assert moved_by(settled, some, again) < SETTLED
