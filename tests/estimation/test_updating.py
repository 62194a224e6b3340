"""Many readings absorbed at once are the same as one after the other: belief, innovations, and the history of both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.estimation.belief import Belief, Innovations
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import path
from axiscal.estimation.knowledge import Block, Knowledge, taken
from axiscal.estimation.located import Absorbed, absorbed
from axiscal.exceptions import ShapeError
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen
from benchmarks.nonlinear.stations import read, tracers
from tests.generators.campaigns import drawn, mixed


def _turning(problem: Case, count: int) -> list[Reading]:
    """Readings that begin to come from sides that nobody told only after a third of them."""
    readings = drawn(problem, count)
    return [replace(r, approach=(1, 1, -1)) if i < count // 3 else r for i, r in enumerate(readings)]


def _one_by_one(case: Case, readings: Sequence[Reading], left_out: Sequence[int]) -> tuple[Absorbed, list[Accuracy]]:
    each = [absorbed(case, [])]
    for index, reading in enumerate(readings):
        each.append(_after_one(each[-1], reading, index not in left_out))
    yardstick = each[-1].case.yardstick  # with what any of them shows of the sides
    return each[-1], [yardstick.measure(known.knowledge.belief) for known in each[1:]]


def _after_one(before: Absorbed, reading: Reading, counts: bool) -> Absorbed:
    """What is known after one reading more, by one plain update."""
    opened = before.knowledge.opened([reading])
    numbers = seen(opened.observation, [reading])
    expected = opened.belief.predict(numbers.rows)
    surprise = Innovations(numbers.values - expected.mean, np.hypot(expected.std, np.sqrt(numbers.variances)))
    belief = opened.belief.update(numbers.rows, numbers.values, numbers.variances) if counts else opened.belief
    case = before.case
    if reading.setup not in case.both and not case.came_as_allowed(reading):
        case = replace(case, both=case.both | {reading.setup})
    errors = slice(opened.observation.errors.size)
    mine = Block((surprise,), opened.belief.factor[errors], np.zeros((len(numbers.values), errors.stop)))
    return Absorbed(case, before.left_out, Knowledge(opened.observation, belief), (*before.blocks, mine))


@pytest.mark.parametrize(("together", "count"), [(7, 30), pytest.param(400, 60, marks=pytest.mark.long)])
def test_many_readings_at_once_are_one_after_the_other(
    together: int, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("axiscal.estimation.knowledge.AT_ONCE", together)
    problem = mixed()
    readings = _turning(problem, count)
    readings[21] = replace(readings[21], value=3.0, others=(-2.0, 1.0))
    left_out = (0, 11, 21)
    twin, seen_by_twin = _one_by_one(problem, readings, left_out)
    known, surprises = list[Accuracy](), list[Innovations]()
    case = absorbed(problem, readings, left_out).case
    parts, after = taken(problem.knowledge, readings, left_out)
    for part in parts:
        known += part.accuracies(case.yardstick)
        surprises += part.innovations
    assert after.observation.cells == twin.knowledge.observation.cells
    spread = np.sqrt(np.diag(twin.knowledge.belief.covariance))
    np.testing.assert_array_less(np.abs(after.belief.mean - twin.knowledge.belief.mean), 1e-8 * spread)
    apart = (after.belief.covariance - twin.knowledge.belief.covariance) / np.outer(spread, spread)
    assert np.max(np.abs(apart)) < 1e-9
    for mine, theirs in zip(surprises, twin.innovations, strict=True):
        np.testing.assert_allclose(mine.std, theirs.std, rtol=1e-9)
        np.testing.assert_array_less(np.abs(mine.value - theirs.value), 1e-7 * theirs.std + 1e-9 * abs(theirs.value))
    assert case.both == twin.case.both == {"probe", "nest"}
    np.testing.assert_allclose(known, seen_by_twin, rtol=1e-9)


@pytest.mark.long
def test_the_history_is_what_was_known_after_each_reading() -> None:
    """Which readings are bad, and the sizes, are known from the first one on; the last figures are the posterior's."""
    case = mixed()
    readings = _turning(case, 24)
    readings[15] = replace(readings[15], value=2.0)
    known = concluded(case, readings)
    moments, final, implausible = path(known), known.absorbed, known.implausible
    twin = absorbed(known.absorbed.case, [])
    assert 15 in implausible
    assert len(moments) == 25
    assert moments[0] == (known.stated.yardstick.measure(known.stated.prior), None, 0.0)
    for count, moment in enumerate(moments[1:], start=1):
        twin = _after_one(twin, readings[count - 1], count - 1 not in final.left_out)
        assert moment.seconds == known.timed.ends[count - 1]
        if count < 24:
            expected = twin.case.yardstick.measure(twin.knowledge.belief)
            np.testing.assert_allclose(moment.accuracy, expected, rtol=1e-8)
        assert moment.innovations is not None
        np.testing.assert_allclose(moment.innovations.std, twin.innovations[-1].std, rtol=1e-8)
        sizes = moment.innovations.value - twin.innovations[-1].value
        assert np.all(np.abs(sizes) < 1e-6 * moment.innovations.std + 1e-8 * np.abs(moment.innovations.value))
    assert moments[24].accuracy == known.accuracy
    assert moments[24].seconds == known.timed.seconds


@pytest.mark.long
def test_where_stations_stand_and_what_cannot_be_is_known_from_the_first_reading_of_a_history_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One pass through the readings is one after the other, about the machine that all of them show."""
    monkeypatch.setattr("axiscal.estimation.estimate.refuse_mirrors", lambda *_: None)  # a question of its own
    case = tracers("0.3 mm", "0.1 mm")
    readings = read(case, 5)[1][::9]
    readings[7] = replace(readings[7], value=readings[7].value + 0.1)
    known = concluded(case, readings)
    shown = known.absorbed
    assert shown.case.about is not None
    assert [each.found for each in shown.case.description.setups] != [each.found for each in case.description.setups]
    assert 7 in known.implausible
    moments = path(known)
    twin = absorbed(shown.case, [])
    for count, moment in enumerate(moments[1:-1], start=1):
        twin = _after_one(twin, readings[count - 1], count - 1 not in shown.left_out)
        np.testing.assert_allclose(moment.accuracy, twin.case.yardstick.measure(twin.knowledge.belief), rtol=1e-7)
        assert moment.innovations is not None
        np.testing.assert_allclose(moment.innovations.std, twin.innovations[-1].std, rtol=1e-7)
        apart = moment.innovations.value - twin.innovations[-1].value
        assert np.all(np.abs(apart) < 1e-5 * moment.innovations.std)
    np.testing.assert_allclose(moments[-1].accuracy, known.accuracy, rtol=1e-7)


@given(st.integers(0, 10_000), st.floats(-3.0, 8.0), st.integers(0, 3))
def test_a_belief_told_of_readings_is_one_updated_by_each(seed: int, decades: float, fixed: int) -> None:
    """With priors that are very wide, variables that are known exactly, and readings that do not count."""
    rng = np.random.default_rng(seed)
    size, count = 5, int(rng.integers(1, 12))
    root = rng.standard_normal((size, size)) * 10.0 ** (decades / 2 * rng.random(size))[:, None]
    root[:fixed] = 0.0
    belief, rows = Belief(rng.standard_normal(size), root @ root.T), rng.standard_normal((count, size))
    values, noise = rng.standard_normal(count), rng.uniform(0.5, 2.0, count)
    reading = np.sort(rng.integers(0, count, count))
    used = np.where(rng.random(count) < 0.3, np.inf, noise * rng.uniform(1.0, 5.0, count))
    told, surprises, losses = belief.update_many(rows, values, noise, used, reading)
    twin = belief
    for each in np.unique(reading):
        mine = reading == each
        expected = twin.predict(rows[mine])
        surprise = surprises.std[mine]
        np.testing.assert_allclose(surprise, np.sqrt(expected.std**2 + noise[mine]), rtol=1e-6)
        np.testing.assert_allclose(
            surprises.value[mine], values[mine] - expected.mean, rtol=1e-6, atol=1e-6 * float(surprise.max())
        )
        mine &= np.isfinite(used)
        twin = twin.update(rows[mine], values[mine], used[mine]) if mine.any() else twin
    spread = np.maximum(np.sqrt(np.diag(twin.covariance)), 1e-100)
    assert np.max(np.abs(told.covariance - twin.covariance) / np.outer(spread, spread)) < 1e-7
    assert np.max(np.abs(told.mean - twin.mean) / spread) < 1e-6
    np.testing.assert_allclose(
        belief.covariance - losses.T @ losses, twin.covariance, atol=1e-9 * float(np.max(belief.covariance) + 1.0)
    )


def test_readings_that_cannot_be_are_refused() -> None:
    belief = Belief([0.0], [[1.0]])
    with pytest.raises(ShapeError):
        belief.update_many(np.ones((2, 1)), np.zeros(2), np.array([1.0, np.nan]), np.ones(2), np.arange(2))
