"""The largest ratio over boxes: against dense sampling, against ratios whose maximum is known, and with few boxes."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.numerics import Array
from axiscal.numerics.bernstein import Forms, Patches, largest_ratio, misfit, patches


def _forms(seed: int, degree: int = 6) -> Forms:
    """Return a polynomial above zero over another one, of a degree in both coordinates."""
    rng = np.random.default_rng(seed)
    half = degree // 2 + 1
    above, below = rng.normal(size=(2, 3, half, half))

    def squares(places: Array, of: Array) -> Array:
        values = np.array([np.polynomial.polynomial.polyval2d(places[:, 0], places[:, 1], each) for each in of])
        total: Array = np.sum(values**2, axis=0)
        return total

    return lambda places: (squares(places, above), 0.05 + squares(places, below))


BREAKS = np.array([-1.0, -0.2, 0.5, 1.0]), np.array([-1.0, 0.3, 1.0])


def _over(forms: Forms, degree: tuple[int, ...], breaks: tuple[Array, ...] = BREAKS) -> Patches:
    """Return the forms over all boxes between breaks."""
    low, high = (
        np.stack([g.ravel() for g in np.meshgrid(*(each[part] for each in breaks), indexing="ij")], axis=1)
        for part in (slice(None, -1), slice(1, None))
    )
    return patches(forms, low, high, degree)


@pytest.mark.parametrize("seed", range(3))
def test_no_place_of_a_million_is_better(seed: int) -> None:
    forms = _forms(seed)
    found = largest_ratio(_over(forms, (6, 6)))
    tried = np.random.default_rng(99).uniform(-1, 1, (1_000_000, 2))
    above, below = forms(tried)
    best = float((above / below).max())
    assert best <= found.upper
    assert found.upper <= found.lower * (1 + 2e-6)
    assert found.lower >= best * (1 - 1e-4), "corners come close to the place itself"
    at = forms(found.place[None])
    assert float(at[0][0] / at[1][0]) == pytest.approx(found.lower, rel=1e-9)


def test_what_is_known_saves_boxes_and_few_boxes_still_bound() -> None:
    forms = _forms(3)
    whole = largest_ratio(_over(forms, (6, 6)))
    again = largest_ratio(_over(forms, (6, 6)), known=whole.lower)
    assert again.boxes <= whole.boxes
    assert again.upper == pytest.approx(whole.upper, rel=2e-6)
    poor = largest_ratio(_over(forms, (6, 6)), boxes=0)
    assert poor.boxes < whole.boxes
    assert poor.upper >= whole.lower


def test_a_degree_that_is_too_low_is_noticed() -> None:
    assert misfit(_forms(1), _over(_forms(1), (6, 6))) < 1e-11
    assert misfit(_forms(1), _over(_forms(1), (6, 5))) > 1e-6
    assert misfit(_forms(1), _over(_forms(1), (5, 6))) > 1e-6


@pytest.mark.parametrize("axes", [1, 3])
@pytest.mark.parametrize("seed", range(3))
def test_lines_and_boxes_of_three_are_enclosed(axes: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    curves = rng.normal(size=(axes, 4, 4))

    def forms(places: Array) -> tuple[Array, Array]:
        """The squared length of a sum of cubics, one per axis, over one."""
        seen = sum(np.polynomial.polynomial.polyval(at, each).T for at, each in zip(places.T, curves, strict=True))
        return np.asarray(np.sum(np.square(seen), axis=1)), np.ones(len(places))

    breaks = tuple(np.sort(rng.uniform(-1, 1, 4)) for _ in range(axes))
    found = largest_ratio(_over(forms, (6,) * axes, breaks), gap=1e-3)
    tried = np.stack([rng.uniform(each[0], each[-1], 300_000) for each in breaks], axis=1)
    best = float(forms(tried)[0].max())
    assert best <= found.upper <= found.lower * (1 + 2e-3)
    assert forms(found.place[None])[0][0] == pytest.approx(found.lower, rel=1e-9)
