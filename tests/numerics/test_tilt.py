"""How much of one wave a turn, a tilt of a rotary axis, a cyclic spline can follow."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.numerics.cubic import CyclicSpline


@pytest.mark.parametrize(("points", "expected"), [(2, 0.70), (3, 0.063), (4, 0.0125), (5, 0.0040)])
def test_two_control_points_miss_most_of_a_tilt(points: int, expected: float) -> None:
    turn = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    rows = CyclicSpline(np.linspace(0, 2 * np.pi, points + 1)).rows(turn)
    waves = np.cos(turn[:, None] - np.linspace(0, 2 * np.pi, 36, endpoint=False))
    left = waves - rows @ np.linalg.lstsq(rows, waves, rcond=None)[0]
    assert np.sqrt(np.mean(left**2) / np.mean(waves**2)) == pytest.approx(expected, rel=0.03)
