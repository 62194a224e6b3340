"""The largest value over boxes: against dense sampling, from what is known, and with few boxes."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.numerics import Array, bernstein
from axiscal.numerics.bernstein import Heights, Patches, largest_value, misfit, patches


def _heights(seed: int) -> Heights:
    """Return a polynomial above zero with hills inside, of degree six in both coordinates."""
    parts = np.random.default_rng(seed).normal(size=(3, 2, 2))

    def heights(places: Array) -> Array:
        x, y = places.T
        values = np.array([np.polynomial.polynomial.polyval2d(x, y, each) for each in parts])
        total: Array = np.sum((values * (1 - x**2) * (1 - y**2)) ** 2, axis=0)
        return total

    return heights


BREAKS = np.array([-1.0, -0.2, 0.5, 1.0]), np.array([-1.0, 0.3, 1.0])


def _over(heights: Heights, degree: tuple[int, ...], breaks: tuple[Array, ...] = BREAKS) -> Patches:
    """Return the polynomial over all boxes between breaks."""
    low, high = (
        np.stack([g.ravel() for g in np.meshgrid(*(each[part] for each in breaks), indexing="ij")], axis=1)
        for part in (slice(None, -1), slice(1, None))
    )
    return patches(heights, low, high, degree)


@pytest.mark.parametrize("seed", range(3))
def test_no_place_of_a_million_is_better(seed: int) -> None:
    heights = _heights(seed)
    found = largest_value(_over(heights, (6, 6)), 0.0, 1e-6)
    best = float(heights(np.random.default_rng(99).uniform(-1, 1, (1_000_000, 2))).max())
    assert best <= found.upper
    assert found.upper <= found.lower * (1 + 2e-6)
    assert found.lower >= best * (1 - 1e-4), "corners come close to the place itself"
    assert float(heights(found.place[None])[0]) == pytest.approx(found.lower, rel=1e-9)


def test_what_is_known_saves_boxes_and_few_boxes_still_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    heights = _heights(3)
    whole = largest_value(_over(heights, (6, 6)), 0.0, 1e-6)
    again = largest_value(_over(heights, (6, 6)), whole.lower, 1e-6)
    assert again.boxes <= whole.boxes
    assert again.upper == pytest.approx(whole.upper, rel=2e-6)
    monkeypatch.setattr(bernstein, "BOXES", 0)
    poor = largest_value(_over(heights, (6, 6)), 0.0, 1e-6)
    assert poor.boxes < whole.boxes
    assert poor.upper >= whole.lower


def test_a_degree_that_is_too_low_is_noticed() -> None:
    assert misfit(_heights(1), _over(_heights(1), (6, 6))) < 1e-11
    assert misfit(_heights(1), _over(_heights(1), (6, 5))) > 1e-6
    assert misfit(_heights(1), _over(_heights(1), (5, 6))) > 1e-6


@pytest.mark.parametrize("axes", [1, 3])
@pytest.mark.parametrize("seed", range(3))
def test_lines_and_boxes_of_three_are_enclosed(axes: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    curves = rng.normal(size=(axes, 4, 4))

    def heights(places: Array) -> Array:
        """The squared length of a sum of cubics, one per axis."""
        seen = sum(np.polynomial.polynomial.polyval(at, each).T for at, each in zip(places.T, curves, strict=True))
        return np.asarray(np.sum(np.square(seen), axis=1))

    breaks = tuple(np.sort(rng.uniform(-1, 1, 4)) for _ in range(axes))
    found = largest_value(_over(heights, (6,) * axes, breaks), 0.0, 1e-3)
    tried = np.stack([rng.uniform(each[0], each[-1], 300_000) for each in breaks], axis=1)
    best = float(heights(tried).max())
    assert best <= found.upper <= found.lower * (1 + 2e-3)
    assert heights(found.place[None])[0] == pytest.approx(found.lower, rel=1e-9)
