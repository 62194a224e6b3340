"""The columns of the readings of a plan against plain tables, whatever waits to be taken off."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.reading_columns import ReadingColumns
from axiscal.measurement.visits import visited
from axiscal.numerics import Array
from tests.design.test_three_values import mixed

CANDIDATES = 40


class _Plain:
    """The same tables, everything taken off at once."""

    def __init__(self, cross: Array, reach: Array) -> None:
        self.cross, self.reach = cross.copy(), reach.copy()

    def put(self, own: slice, cross: Array, reach: Array) -> None:
        here = slice(CANDIDATES + own.start, CANDIDATES + own.stop)
        for table, column in ((self.cross, cross), (self.reach, reach)):
            table[:, own], table[here] = column, column[CANDIDATES:].T

    def change(self, scaled: Array, half: Array, cross: Array) -> None:
        self.cross -= scaled @ cross[CANDIDATES:].T
        self.reach -= scaled @ half[CANDIDATES:].T + half @ scaled[CANDIDATES:].T

    def room(self, start: int, count: int) -> None:
        at = np.full(count, start)
        self.cross, self.reach = (
            np.insert(np.insert(table, CANDIDATES + at, 0.0, axis=0), at, 0.0, axis=1)
            for table in (self.cross, self.reach)
        )

    def cut(self, own: slice) -> None:
        rows = np.arange(CANDIDATES + own.start, CANDIDATES + own.stop)
        self.cross, self.reach = (
            np.delete(np.delete(table, rows, axis=0), own, axis=1) for table in (self.cross, self.reach)
        )


@pytest.mark.parametrize("seed", range(4))
def test_columns_are_those_of_tables_from_which_everything_is_taken_off_at_once(seed: int) -> None:
    rng, size = np.random.default_rng(seed), 12
    cross, reach = rng.normal(size=(2, CANDIDATES + size, size))
    found, plain = ReadingColumns(cross, reach, CANDIDATES), _Plain(cross, reach)
    for step in range(60):
        kind, count = rng.integers(5), int(rng.integers(1, 4))
        start = int(rng.integers(0, size - count + 1))
        own, rows = slice(start, start + count), CANDIDATES + size
        if kind == 0 and size < 20:
            found.room(start, count)
            plain.room(start, count)
            size += count
        elif kind == 1 and size > 6:
            found.cut(own)
            plain.cut(own)
            size -= count
        elif kind == 2:
            columns = rng.normal(size=(2, rows, count))
            for column in columns:  # as of a symmetric matrix
                column[CANDIDATES + start : CANDIDATES + start + count] = np.eye(count)
            found.put(own, *columns)
            plain.put(own, *columns)
        else:
            width = 30 if step % 10 == 9 else count
            parts = rng.normal(size=(3, rows, width))
            found.change(*parts)
            plain.change(*parts)
        there = found.copy() if step % 7 == 0 else found
        everything = slice(0, size)
        np.testing.assert_allclose(there.of(everything)[0], plain.cross, atol=1e-11)
        np.testing.assert_allclose(there.of(everything)[1], plain.reach, atol=1e-11)
        some = slice(CANDIDATES, rows) if kind not in (0, 1) else slice(0, CANDIDATES)
        np.testing.assert_allclose(there.of(everything, some)[0], plain.cross[some], atol=1e-11)


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
        whole = np.concatenate([pool.rows(observation, index) for index in range(len(pool))])
        np.testing.assert_allclose(pool.products(observation, vectors), whole @ vectors, atol=1e-12)
