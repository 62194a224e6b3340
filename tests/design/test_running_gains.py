"""Gains of a lattice kept up to date, against gains computed anew."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.covariance import Covariance
from axiscal.design.gains.running_gains import Scores
from axiscal.design.plan.task import Task
from axiscal.measurement.place import Places
from tests.design.test_three_values import mixed
from tests.generators.designs import levered, random_poses, read, splines


def _fresh(scores: Scores, start: Covariance) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    state = start.after_readings(scores.places)
    return scores.pool.gains(*scores.pool.forms(state.scorer()))


@pytest.mark.parametrize("memory", [1e9, 0.0])
def test_entering_leaving_and_exchanging_keep_every_gain(memory: float) -> None:
    asked = read(levered(400), np.random.default_rng(0), 4)
    start = asked.state
    scores = Scores(Pool(asked.observation, asked.lattice, memory), start)
    for index in (3, 300, 50, 51, 120):
        value, gain = scores.state.value, scores.enter(index)
        assert value - scores.state.value == pytest.approx(gain, rel=1e-9)
    scores.enter(Places.of_setup(0, *random_poses(asked, np.random.default_rng(1), 1)))
    np.testing.assert_allclose(scores.gains, _fresh(scores, start), rtol=1e-6)

    losses = scores.losses()
    gains, own = scores.without(2)
    assert own == pytest.approx(losses[2], rel=1e-9)
    assert scores.leave(2) == pytest.approx(own, rel=1e-9)
    np.testing.assert_allclose(scores.gains, gains, rtol=1e-9)
    scores.enter(200, 2)
    np.testing.assert_allclose(scores.gains, _fresh(scores, start), rtol=1e-5)
    scores.leave(0)
    scores.close(0)
    assert len(scores.places) == 5
    np.testing.assert_allclose(scores.gains, _fresh(scores, start), rtol=1e-5)


def test_repeating_in_one_cell_shares_its_rest() -> None:
    asked = levered(200)
    scores = Scores(Pool(asked.observation, asked.lattice), asked.state)
    scores.enter(5)
    again = float(scores.gains[5])
    independent = asked.state.after_readings(scores.pool.lattice.at(5))
    assert again == pytest.approx(float(_fresh(scores, asked.state)[5]), rel=1e-8)
    assert independent.value == pytest.approx(scores.state.value, rel=1e-10)


def test_a_fork_goes_its_own_way() -> None:
    asked = levered(100)
    scores = Scores(Pool(asked.observation, asked.lattice), asked.state)
    scores.enter(1)
    scores.follow()
    before = scores.gains.copy()
    scores.fork().enter(2)
    np.testing.assert_array_equal(scores.gains, before)
    assert len(scores.places) == 1


def test_a_factor_stays_narrow_however_often_readings_leave() -> None:
    asked = levered(100)
    state = asked.state.opened(asked.lattice.at(0))
    rows, variances, _ = state.rows(asked.lattice.at(0))
    row, variance = rows[0], float(variances[0])
    value = state.value
    for _ in range(80):
        state = state.changed(row[None], np.array([variance]))[0]
        state = state.changed(row[None], np.array([variance]), leaving=True)[0]
    assert state.factor.shape[1] <= state.factor.shape[0] + 48
    assert state.value == pytest.approx(value, rel=1e-8)


@pytest.mark.parametrize(
    "asked", [levered(150), mixed(150), splines(1, 4, 0.1, 60)], ids=["levers", "three values", "fewer unknowns"]
)
def test_readings_that_enter_together_are_those_that_enter_one_by_one(asked: Task) -> None:
    one, together = (Scores(Pool(asked.observation, asked.lattice), asked.state) for _ in range(2))
    together.follow()
    places = asked.lattice.within(np.arange(0, 50, 5))
    gains = sum(one.enter(places.at(index)) for index in range(len(places)))
    assert together.enter_all(places) == pytest.approx(gains, rel=1e-9)
    np.testing.assert_allclose(together.gains, one.gains, rtol=1e-7)
    np.testing.assert_allclose(together.losses(), one.losses(), rtol=1e-6)
    (expected, own), (found, same) = one.without(3), together.without(3)
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    assert same == pytest.approx(own, rel=1e-6)
    assert together.state.factor.shape == one.state.factor.shape
    assert together.enter_all(places.within(slice(0, 0))) == 0.0


def test_columns_made_anew_are_those_of_the_tables() -> None:
    asked = splines(1, 5, 0.1, 200)
    anew, kept = (Scores(Pool(asked.observation, asked.lattice), asked.state) for _ in range(2))
    kept.follow()
    for scores in (anew, kept):
        for index in range(0, 120, 11):
            scores.enter(index)
        scores.leave(3)
        scores.enter(55, 3)
        scores.leave(6)
        scores.close(6)
    assert len(anew.members) > asked.observation.size
    for slot in range(len(anew.members)):
        (gains, own), (expected, of_tables) = anew.without(slot), kept.without(slot)
        np.testing.assert_allclose(gains, expected, rtol=1e-8, atol=1e-12 * expected.max())
        assert own == pytest.approx(of_tables, rel=1e-8)
    assert anew._followed is None
    assert kept._followed is not None


@pytest.mark.parametrize("readings", [3, 40])
def test_slots_looked_at_together_are_looked_at_as_if_alone(readings: int) -> None:
    asked = splines(1, 7, 0.1, 500)
    rng = np.random.default_rng(readings)
    scores = Scores(Pool(asked.observation, asked.lattice), asked.state)
    scores.enter_all(asked.lattice.within(rng.integers(len(asked.lattice), size=readings)))
    masks = rng.random((readings, len(scores.pool))) < 0.7
    slots = rng.permutation(readings).tolist()
    together = list(scores.replacements(slots, lambda _, slot: masks[slot], 0.0))
    for slot, found in zip(slots, together, strict=True):
        alone = scores.replacement(slot, masks[slot])
        assert found.candidate == alone.candidate
        np.testing.assert_allclose(found[1:], alone[1:], rtol=1e-10)


@pytest.mark.parametrize("asked", [splines(2, 5, 0.1, 200), levered(200), mixed(200)], ids=["sums", "levers", "mixed"])
def test_gains_without_a_reading_are_those_of_what_is_known_without_it(asked: Task) -> None:
    scores = Scores(Pool(asked.observation, asked.lattice), asked.state)
    scores.enter_all(asked.lattice.within(slice(0, None, 11)))
    for slot in range(0, len(scores.members), 4):
        if scores.held_alone(slot):
            continue
        state, change = scores.known_without(slot)
        found, anew = scores.scorer_without(change).gains(asked.lattice), scores.pool.scorer(state).gains(asked.lattice)
        np.testing.assert_allclose(found, anew, rtol=1e-8)
        scores.leave(slot)
        scores.enter(slot, slot)  # another state: what was found once does not hold any more
