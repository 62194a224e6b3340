"""The largest ratio over a plane: against dense sampling, against ratios whose maximum is known, and with few boxes."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.numerics import Array
from axiscal.numerics.bernstein import PlaneForms, largest_ratio, misfit


def _forms(seed: int, degree: int = 6) -> PlaneForms:
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


@pytest.mark.parametrize("seed", range(6))
def test_no_place_of_a_million_is_better(seed: int) -> None:
    forms = _forms(seed)
    found = largest_ratio(forms, BREAKS, (6, 6))
    tried = np.random.default_rng(99).uniform(-1, 1, (1_000_000, 2))
    above, below = forms(tried)
    best = float((above / below).max())
    assert best <= found.upper
    assert found.upper <= found.lower * (1 + 2e-6)
    assert found.lower >= best * (1 - 1e-4), "corners come close to the place itself"
    at = forms(found.place[None])
    assert float(at[0][0] / at[1][0]) == pytest.approx(found.lower, rel=1e-9)


def test_a_maximum_that_is_known_is_found() -> None:
    """1 / (1 + (x − 0.31)² + 2 (y + 0.62)²): one, at (0.31, −0.62)."""

    def forms(places: Array) -> tuple[Array, Array]:
        x, y = places.T
        return np.ones(len(x)), 1 + (x - 0.31) ** 2 + 2 * (y + 0.62) ** 2

    found = largest_ratio(forms, BREAKS, (2, 2))
    assert found.lower == pytest.approx(1.0, rel=2e-6)
    np.testing.assert_allclose(found.place, [0.31, -0.62], atol=2e-3)
    assert found.upper >= 1.0


def test_what_is_known_saves_boxes_and_few_boxes_still_bound() -> None:
    forms = _forms(3)
    whole = largest_ratio(forms, BREAKS, (6, 6))
    again = largest_ratio(forms, BREAKS, (6, 6), known=whole.lower)
    assert again.boxes <= whole.boxes
    assert again.upper == pytest.approx(whole.upper, rel=2e-6)
    poor = largest_ratio(forms, BREAKS, (6, 6), boxes=0)
    assert poor.boxes < whole.boxes
    assert poor.upper >= whole.lower


def test_a_degree_that_is_too_low_is_noticed() -> None:
    assert misfit(_forms(1), BREAKS, (6, 6)) < 1e-11
    assert misfit(_forms(1), BREAKS, (6, 5)) > 1e-6
    assert misfit(_forms(1), BREAKS, (5, 6)) > 1e-6
