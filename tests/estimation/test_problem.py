"""A problem keeps the variance of every reading, whatever has no column of its own."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.estimation.promise import problem, unknowns
from axiscal.estimation.promise.dense import Dense
from axiscal.estimation.promise.problem import MOST_COLUMNS, MOST_NUMBERS, PlaneUnknowns, Problem
from axiscal.estimation.promise.spaces import parts_of
from axiscal.estimation.promise.unknowns import Unknowns
from axiscal.machine import load_machine
from axiscal.numerics import Array
from tests.generators.problems import asked

_MANY = MOST_NUMBERS // 3 + 1
"""Readings of three numbers that are more than the room of the numbers serves."""


def _variances(given: Problem) -> Array:
    """Return the variance of each number at the sizes as stated, m²."""
    covariance = Dense(given).covariance(np.zeros(len(given.sizes)))
    return np.asarray(np.diagonal(covariance) * given.noise**2)


def _strongest(given: Problem) -> int:
    """Return the error whose rests add most to the variances of readings."""
    part = slice(given.first_cell, given.first_cell + len(given.cells))
    added = np.sum((given.rows[:, part] * given.noise[:, None]) ** 2, axis=0)
    return int(np.argmax(np.bincount([term for term, _ in given.cells], added)))


def test_rests_without_a_column_count_as_noise(monkeypatch: pytest.MonkeyPatch) -> None:
    """What moves readings most keeps its cells, columns are no more than allowed, and no variance is lost."""
    few = asked("five axes", _MANY)
    monkeypatch.setattr(problem, "MOST_COLUMNS", 10_000)
    every = asked("five axes", _MANY)
    assert few.rows.shape[1] <= MOST_COLUMNS < every.rows.shape[1]
    assert _strongest(every) in {term for term, _ in few.cells}
    assert set(few.cells) < set(every.cells)
    np.testing.assert_allclose(_variances(few), _variances(every), rtol=1e-9)


def test_readings_are_left_out_alike_in_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    given = asked("two set-ups", 9)
    found = Unknowns(given).given(np.zeros(len(given.sizes)))
    assert found is not None
    for part in parts_of(given.reading):
        whole = found.left_out(part)
        monkeypatch.setattr(unknowns, "_AT_ONCE", 4)
        for one, other in zip(found.left_out(part), whole, strict=True):
            np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12 * float(np.abs(other).max()))
        monkeypatch.undo()


@pytest.mark.parametrize("times", [1.0, 30.0, 5000.0])
def test_an_error_of_two_axes_has_a_root_at_any_length(times: float) -> None:
    """A draw of the sizes for the bed of a real printer took it to a thousand times the stated one."""
    (plane,) = ErrorModel(load_machine("printer-gantry")).planes
    columns = np.arange(len(plane.pairs))[None]
    unknown = PlaneUnknowns(columns, plane, np.array([0]))
    (root,) = unknown.roots(np.array([np.log(times)]))
    expected = plane.prior(plane.entry.std, (times, times))
    np.testing.assert_allclose(root @ root.T, expected, rtol=1e-6, atol=2e-9 * plane.entry.std**2)
