"""How far from linear readings are: draws of our own, and estimates made twice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.estimation.absorbed import Absorbed, absorbed
from axiscal.estimation.case import Case
from axiscal.estimation.learnt import without_bad
from axiscal.estimation.located import SETTLED, located, moved_by
from axiscal.estimation.stations import indices
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen, shown_values
from benchmarks.nonlinear.stations import read, tracers


def _located(case: Case, readings: list[Reading]) -> Absorbed:
    kept = without_bad(case, readings, {})
    return located(case.rescaled(kept.sizes), readings, [*kept.bad])


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
