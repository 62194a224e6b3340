"""Which sizes vary, and how: exp θ is log-normal where x is standard normal."""

import numpy as np
import pytest
from scipy.stats import lognorm, norm

from axiscal_core.theta import Kind, Size, Sizes


def test_a_size_is_lognormal_about_what_is_stated() -> None:
    """Quantiles of the factors by scipy; of a drift as stated the prior adds just the variance that is stated."""
    x = np.linspace(-3, 3, 13)
    sizes = Size("std", ("EXX", "EYY"), 0.5), Size("drift", ("laser",), 1.4), Size("noise", ("laser",), 0.7)
    theta, _ = Sizes(sizes).theta(np.tile(x[:, None], 3))
    for column, (spread, median) in enumerate(((0.5, 1.0), (1.4, np.exp(-(1.4**2))), (0.7, 1.0))):
        wanted = lognorm(spread, scale=median)
        np.testing.assert_allclose(wanted.cdf(np.exp(theta[:, column])), norm.cdf(x), rtol=1e-9)
    assert lognorm(1.4, scale=np.exp(-(1.4**2))).moment(2) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("kind", "most"),
    [(kind, 10) for kind in ("std", "reversal", "rest", "together")] + [("drift", 30), ("growth", 30), ("way", 60)],
)
def test_no_size_is_learnt_far_beyond_what_is_stated(kind: Kind, most: float) -> None:
    """Behind that it does not move; a length may be anything, and a noise as wide as a bad reading."""
    theta, slope = Sizes((Size(kind, ("EXX",), np.log(3.0)),)).theta(np.array([[1.0], [9.0], [-9.0]]))
    assert np.exp(theta[1, 0]) == pytest.approx(most)
    assert theta[2, 0] == -7.0
    assert [bool(each) for each in slope[:, 0]] == [True, False, False]
