"""The plain formula of the gain, every fast way to it, and the columns of a plan, against plain tables."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.reading_rows import visited
from axiscal.measurement.setup import Unknown
from axiscal.numerics import Array
from axiscal.planning.gains import candidate_rows
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.running_gains import ReadingColumns, Scores
from axiscal.planning.plan.task import Task
from tests.generators import dense_gains as dense
from tests.generators.designs import levered, random_poses, read
from tests.generators.forms import gains_of
from tests.planning.test_three_values import mixed

ZEROS = tuple(Unknown(f"zero_{axis}", 1e-4) for axis in "xyz")


def _asked(seed: int, nest: bool) -> Task:
    """A machine after a few readings in random places; with an R-test, which reads three numbers, or without."""
    asked = levered(60)
    if nest:
        first, second = asked.observation.setups
        setups = (replace(first, instrument="rtest", unknowns=ZEROS), second)
        observation = Observation(asked.observation.errors, setups)
        belief = type(asked.belief)(np.zeros(observation.size), observation.prior_covariance())
        asked = replace(asked, observation=observation, belief=belief)
    return read(asked, np.random.default_rng(seed), seed)


def _known(asked: Task) -> dense.DenseState:
    return dense.DenseState(asked.observation, asked.belief.covariance)


def _gains(asked: Task, places: Places) -> Array:
    """The gain of each place alone, plainly."""
    return np.array([dense.gain(_known(asked), asked.root.weights, places.single(i)) for i in range(len(places))])


def test_the_gain_of_one_number_is_the_ratio_of_the_paper() -> None:
    """ΔJ = gᵀCWCg / (σ² + gᵀCg) (B&H eq. 27, 37), and J falls by it."""
    asked = levered(10)
    known, place = dense.opened(_known(asked), asked.lattice.single(3)), asked.lattice.single(3)
    row = known.observation.rows(int(place.setups[0]), place.poses, place.approaches).rows[0]
    noise, size = asked.observation.setups[place.setups[0]].noise, asked.root.unknowns
    h = known.covariance @ row
    expected = h[:size] @ asked.root.weights @ h[:size] / (noise**2 + row @ h)
    assert dense.gain(_known(asked), asked.root.weights, place) == pytest.approx(expected, rel=1e-12)
    after = dense.value(dense.after_readings(_known(asked), place), asked.root.weights)
    assert dense.value(_known(asked), asked.root.weights) - after == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("nest", [False, True])
def test_readings_together_bring_what_they_bring_one_after_another(nest: bool) -> None:
    asked = _asked(0, nest)
    places, known, total = asked.lattice.within(np.array([1, 1, 20, 41, 7])), _known(asked), 0.0
    for i in range(len(places)):
        total += dense.gain(known, asked.root.weights, places.single(i))
        known = dense.after_readings(known, places.single(i))
    assert dense.gain(_known(asked), asked.root.weights, places) == pytest.approx(total, rel=1e-6)
    np.testing.assert_allclose(
        known.covariance, dense.after_readings(_known(asked), places).covariance, atol=1e-9 * known.covariance.max()
    )


@pytest.mark.parametrize("nest", [False, True])
@pytest.mark.parametrize("seed", [0, 3])
def test_every_fast_way_brings_the_plain_gain(seed: int, nest: bool) -> None:
    """A scorer, the state by Potter and by Cholesky, gains that are kept up to date, and lines along an axis."""
    asked = _asked(seed, nest)
    places = asked.lattice.within(np.arange(0, 60, 7))
    expected = _gains(asked, places)
    np.testing.assert_allclose(gains_of(asked.state.scorer(), places), expected, rtol=1e-6)
    for i in range(len(places)):
        entered, change = asked.state.entered(places.single(i))
        assert change.gain == pytest.approx(expected[i], rel=1e-6)
        assert asked.state.value - entered.value == pytest.approx(expected[i], rel=1e-5)
        fall = asked.state.value - asked.state.after_readings(places.single(i)).value
        assert fall == pytest.approx(expected[i], rel=1e-5)
    pool = Pool(asked.observation, asked.lattice)
    np.testing.assert_allclose(Scores(pool, asked.state).gains, _gains(asked, pool.lattice), rtol=1e-6)


@pytest.mark.parametrize("nest", [False, True])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_forms_bring_the_plain_gain(axis: int, nest: bool) -> None:
    asked = _asked(2, nest)
    poses, approaches = random_poses(asked, np.random.default_rng(axis), 1)
    positions = np.linspace(*asked.observation.machine.axes[axis].travel, 9)
    for setup in (0, 1):
        line = Places.of_setup(setup, np.tile(poses, (9, 1)), np.tile(approaches, (9, 1)))
        line.poses[:, axis] = positions
        gains = asked.state.scorer().gains_at(setup, line.poses, line.approaches)
        np.testing.assert_allclose(gains, _gains(asked, line), rtol=1e-6)


def test_the_state_after_readings_is_the_dense_one() -> None:
    asked = _asked(3, nest=True)
    state = asked.state.after_readings(asked.lattice)
    expected = dense.after_readings(_known(asked), asked.lattice)
    assert state.observation.cells == expected.observation.cells
    np.testing.assert_allclose(
        state.factor @ state.factor.T, expected.covariance, atol=1e-9 * float(expected.covariance.max())
    )


CANDIDATES, READINGS, WIDTH = 40, 6, 2


class _Plain:
    """The same tables, everything taken off at once.  cross, reach : (N, w, w, M), columns of a reading first"""

    def __init__(self, cross: Array, reach: Array) -> None:
        self.cross, self.reach = cross.copy(), reach.copy()

    def change(self, scaled: Array, half: Array, cross: Array) -> None:
        def product(mine: Array, other: Array) -> Array:
            found: Array = np.einsum("kbn,kim->nbim", mine[:, :, CANDIDATES:], other[:, :, :CANDIDATES])
            return found

        self.cross -= product(cross, scaled)
        self.reach -= product(half, scaled) + product(scaled, half)


@pytest.mark.parametrize("seed", range(4))
def test_columns_are_those_of_tables_from_which_everything_is_taken_off_at_once(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tables = rng.normal(size=(2, READINGS, WIDTH, WIDTH, CANDIDATES))
    found, plain = ReadingColumns(*tables), _Plain(*tables)
    for step in range(60):
        slot = int(rng.integers(READINGS))
        if rng.integers(3) == 0:
            columns = rng.normal(size=(2, WIDTH, WIDTH, CANDIDATES))
            found.put(slot, *columns)
            plain.cross[slot], plain.reach[slot] = columns
        else:
            count = 30 if step % 10 == 9 else int(rng.integers(1, 4))
            parts = rng.normal(size=(3, count, WIDTH, CANDIDATES + READINGS))
            found.change(*parts)
            plain.change(*parts)
        there = found.copy() if step % 7 == 0 else found
        for slot in range(READINGS):
            cross, reach = there.against(slot)
            np.testing.assert_allclose(cross, plain.cross[slot], atol=1e-11)
            np.testing.assert_allclose(reach, plain.reach[slot], atol=1e-11)


def test_a_candidate_opens_the_cells_that_a_reading_there_opens() -> None:
    task = mixed(60)
    pool, observation = Pool(task.observation, task.lattice), task.observation
    for index in range(0, len(pool), 5):
        opened = pool.opened(observation, index)
        assert dict(opened.cells) == dict(visited(observation, pool.lattice.single(index)).cells)
        observation = opened
    assert len(observation.cells) > 0
    assert pool.opened(observation, 0) is observation


@pytest.mark.parametrize("memory", [1e9, 0.0])
def test_products_with_visited_cells_are_those_of_whole_rows(memory: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a lattice that takes too much memory they are made of pieces, and of whole rows otherwise."""
    monkeypatch.setattr(candidate_rows, "_MEMORY", memory)
    task, rng = mixed(60), np.random.default_rng(5)
    pool, observation = Pool(task.observation, task.lattice), task.observation
    for index in range(0, len(pool), 7):
        observation = pool.opened(observation, index)
    for count in (1, 3, 9):
        vectors = rng.normal(size=(observation.size, count))
        products = pool.products(observation, vectors)
        for index in range(len(pool)):
            rows = pool.rows(observation, index)
            np.testing.assert_allclose(products[:, : len(rows), index], (rows @ vectors).T, atol=1e-12)
            assert not products[:, len(rows) :, index].any()
