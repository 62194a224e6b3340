"""What a case makes of its description: sides that are allowed; a problem keeps every variance."""

from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.promise import problem
from axiscal.estimation.promise.problem import MOST_COLUMNS
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal_core.columns import PlaneUnknowns
from axiscal_core.problem import MOST_NUMBERS, Problem
from tests.generators import laser_axis
from tests.generators.dense_posterior import Dense
from tests.generators.problems import asked
from tests.generators.texts import campaign_text, setup_text

SIDES = campaign_text(
    "m", setup_text("laser", "interferometer", direction="x", approach="{approach}"), target={"readings": 1}
)


@pytest.mark.parametrize(
    ("approach", "allowed"), [("+", (1,)), ("-", (-1,)), ("both", (1, -1))], ids=["from below", "from above", "both"]
)
def test_a_reading_comes_as_allowed_where_a_reversal_shows(approach: str, allowed: tuple[int, ...]) -> None:
    for text, reverses in ((laser_axis.MACHINE, True), (laser_axis.MACHINE.replace("EXX_reversal", "EYX"), False)):
        case = Case(campaign_from_texts(SIDES.format(approach=approach), "c.toml", text, "m"))
        for side in (1, -1, 0):
            reading = Reading("laser", (0.5,), (side,), 0.0)
            assert case.came_as_allowed(reading) == (side in allowed or not reverses)
            assert replace(case, both=frozenset({"laser"})).came_as_allowed(reading) == (side != 0 or not reverses)


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


@pytest.mark.parametrize("times", [1.0, 30.0, 5000.0])
def test_an_error_of_two_axes_has_a_root_at_any_length(times: float) -> None:
    """A draw of the sizes for the bed of a real printer took it to a thousand times the stated one."""
    (plane,) = load_machine("printer-gantry").planes
    columns = np.arange(len(plane.covariance))[None]
    unknown = PlaneUnknowns(columns, np.array([0]), plane)
    (root,) = unknown.roots(np.array([np.log(times)]))
    expected = plane.prior(plane.std, (times, times))
    np.testing.assert_allclose(root @ root.T, expected, rtol=1e-6, atol=2e-9 * plane.std**2)
