"""Lines of pictures keep the points that are seen."""

from __future__ import annotations

import math

import numpy as np
import pytest

from axiscal.present.drawing.strokes import Point, simplified

_SEEN = 0.12
"""Pixels."""


def _off(point: Point, start: Point, end: Point) -> float:
    along, away = (end[0] - start[0], end[1] - start[1]), (point[0] - start[0], point[1] - start[1])
    length = math.hypot(*along)
    return abs(along[0] * away[1] - along[1] * away[0]) / length if length else math.hypot(*away)


def _kept(points: list[Point], first: int, last: int) -> set[int]:
    """Return which points between two that are kept are kept; of two as far off the later one goes first."""
    each = [(_off(points[i], points[first], points[last]), i) for i in range(first + 1, last)]
    if not each or max(each)[0] <= _SEEN:
        return set()
    far = max(each)[1]
    return {far} | _kept(points, first, far) | _kept(points, far, last)


@pytest.mark.parametrize("seed", range(12))
def test_the_points_that_are_kept_are_those_of_douglas_and_peucker(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x = np.arange(120.0)
    y = 50 + 20 * np.sin(x / (3 + seed)) + (seed % 3) * rng.random(120)
    points = list(zip(x.tolist(), (np.round(y) if seed % 4 == 1 else y).tolist(), strict=True))
    if seed % 4 == 2:
        points += points[::-1]  # there and back: it ends where it began
    kept = sorted({0, len(points) - 1} | _kept(points, 0, len(points) - 1))
    assert simplified(points) == [points[i] for i in kept]
