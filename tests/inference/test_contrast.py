"""The test for the end: its squares against least squares, its threshold against draws of its own."""

from __future__ import annotations

import numpy as np
import pytest
from axiscal.inference.contrast import contrast, explained_squares
from scipy import stats

from axiscal.numerics import Array


def _parts(rng: np.random.Generator) -> tuple[Array, list[Array]]:
    """Return whitened columns of departures with one and two columns, also as a list of matrices."""
    columns = [rng.standard_normal((30, 1 + index % 2)) for index in range(12)]
    padded = np.stack([np.hstack([c, np.zeros_like(c)])[:, :2] for c in columns], axis=1)
    return padded, columns


def test_the_squares_are_what_least_squares_explains() -> None:
    rng = np.random.default_rng(1)
    parts, columns = _parts(rng)
    y = rng.standard_normal(30)
    wanted = [float(np.sum((c @ np.linalg.lstsq(c, y, rcond=None)[0]) ** 2)) for c in columns]
    assert explained_squares(parts, y) == pytest.approx(wanted)


def test_the_value_is_the_smallest_chance_of_any_of_them() -> None:
    rng = np.random.default_rng(2)
    parts, columns = _parts(rng)
    y = rng.standard_normal(30)
    squares = [float(np.sum((c @ np.linalg.lstsq(c, y, rcond=None)[0]) ** 2)) for c in columns]
    wanted = max(-np.log10(stats.chi2(c.shape[1]).sf(square)) for c, square in zip(columns, squares, strict=True))
    assert contrast(parts, y).value == pytest.approx(wanted)


@pytest.mark.long
def test_chance_exceeds_the_threshold_in_one_campaign_of_twenty() -> None:
    rng = np.random.default_rng(3)
    parts, _ = _parts(rng)
    threshold = contrast(parts, np.zeros(30)).threshold
    fired = sum(contrast(parts, rng.standard_normal(30)).value > threshold for _ in range(400))
    assert 5 <= fired <= 36  # 20 expected, 4.4 standard deviations either way


def test_a_column_twice_tells_no_more_than_once() -> None:
    rng = np.random.default_rng(4)
    column, y = rng.standard_normal(30), rng.standard_normal(30)
    twice = np.stack([column, 2 * column], axis=1)[:, None]
    once = np.stack([column, np.zeros(30)], axis=1)[:, None]
    assert contrast(twice, y) == contrast(once, y)
