"""The columns of the readings of a plan against plain tables, whatever waits to be taken off."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.measurement.visits import visited
from axiscal.numerics import Array
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.running_gains import ReadingColumns
from tests.planning.test_three_values import mixed

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
            cross, reach = there.of(slot)
            np.testing.assert_allclose(cross, plain.cross[slot], atol=1e-11)
            np.testing.assert_allclose(reach, plain.reach[slot], atol=1e-11)


def test_a_candidate_opens_the_cells_that_a_reading_there_opens() -> None:
    task = mixed(60)
    pool, observation = Pool(task.observation, task.lattice), task.observation
    for index in range(0, len(pool), 5):
        opened = pool.opened(observation, index)
        assert dict(opened.cells) == dict(visited(observation, pool.lattice.at(index)).cells)
        observation = opened
    assert len(observation.cells) > 0
    assert pool.opened(observation, 0) is observation


def test_products_with_visited_cells_are_those_of_whole_rows() -> None:
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
