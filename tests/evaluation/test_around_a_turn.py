"""Circles against closed forms and figures put together by hand."""

import numpy as np
import pytest

from axiscal.evaluation.circles import circular
from axiscal.exceptions import ReadingError
from axiscal.numerics import Array

AROUND = np.arange(72) * np.pi / 36


def _circle(plus: Array, minus: Array | None = None, angles: Array = AROUND) -> Array:
    """Return angles, deviations and directions, (3, m)."""
    ways = [(plus, 1.0)] if minus is None else [(plus, 1.0), (minus, -1.0)]
    return np.concatenate([[angles, way, np.full(len(angles), sign)] for way, sign in ways], axis=1)


def test_an_oval_off_its_centre_has_twice_its_amplitude_as_g() -> None:
    oval = 4e-6 * np.cos(2 * AROUND + 0.3)
    place = 30e-6 * np.cos(AROUND) - 12e-6 * np.sin(AROUND)
    found = circular(_circle(7e-6 + oval + place))
    assert found.figures["G_plus"] == pytest.approx(8e-6, rel=0.01)
    assert found.figures["F_max"] == pytest.approx(11e-6, rel=0.01)
    assert found.figures["F_min"] == pytest.approx(3e-6, rel=0.01)
    assert "G_b" not in found.figures
    assert "one direction" in found.warnings[0]


def test_both_directions_are_judged_about_their_common_centre() -> None:
    lag = 2e-6 * np.sign(np.sin(2 * AROUND + 0.01))
    found = circular(_circle(1e-6 + lag, 3e-6 - lag)).figures
    assert found["G_plus"] == pytest.approx(4e-6)
    assert found["G_minus"] == pytest.approx(4e-6)
    assert found["D"] == pytest.approx(2e-6)
    assert found["G_b"] == pytest.approx(6e-6)
    assert found["F_max"] == pytest.approx(5e-6)
    assert found["F_min"] == pytest.approx(-1e-6)


@pytest.mark.parametrize("begin", [-45, -10, 0])
def test_feed_in_and_feed_out_do_not_count(begin: int) -> None:
    """The centre is taken off whole: an oval of 3 um beside it has G of 6 um however far the bar swings."""
    angles = np.radians(np.arange(begin, 361 - begin))
    oval, place = 3e-6 * np.cos(2 * angles + 0.4), 20e-6 * np.cos(angles - 1.0)
    ramps = 9e-6 * ((angles < -1e-9) | (angles > 2 * np.pi + 1e-9))
    found = circular(_circle(oval + place + ramps + 1e-6, oval + place + ramps - 1e-6, angles)).figures
    assert found["G_plus"] == pytest.approx(6e-6, abs=0.02e-6)
    assert found["G_minus"] == pytest.approx(6e-6, abs=0.02e-6)
    assert found["G_b"] == pytest.approx(8e-6, abs=0.02e-6)


def test_half_a_circle_is_refused() -> None:
    with pytest.raises(ReadingError, match="do not go all around"):
        circular(_circle(np.zeros(36), angles=AROUND[:36]))
