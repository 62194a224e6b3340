"""Numbers and sentences as a reader sees them."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.campaign.ending import because_text
from axiscal.language.spoken import said, speaking
from axiscal.present.drawing.plot import PixelScale
from axiscal.present.sentences import coordinate, figure, quantity


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (1.934, "1.93"),
        (0.82, "0.820"),
        (14.25, "14.2"),
        (9.999, "10.0"),
        (-3.0, "−3.00"),
        (0.0, "0"),
        (12345.0, "12\u202f345"),
        (999999.6, "1.00 × 10⁶"),
        (0.00099999, "0.00100"),
        (2.5e-7, "2.50 × 10⁻⁷"),
        (-1e150, "−1.00 × 10¹⁵⁰"),
    ],
)
def test_figures(value: float, expected: str) -> None:
    assert figure(value) == expected


@given(st.floats(min_value=-1e200, max_value=1e200).filter(lambda v: abs(v) > 1e-200))
def test_a_figure_says_its_value_to_three_digits(value: float) -> None:
    digits = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
    text = re.sub(r" × 10(.*)", lambda m: f"e{m[1].translate(digits)}", figure(value))
    assert float(text.replace("−", "-").replace("\u202f", "")) == pytest.approx(value, rel=5.1e-3)


def test_a_target_that_no_reading_can_reach_is_said_as_the_campaign_ended() -> None:
    kept = "rms target cannot be reached: endless readings would leave 9.7 um, these leave 9.73 um"
    assert because_text(kept) == kept
    with speaking("de"):
        assert because_text(kept).startswith("Ziel für rms")


def test_units_and_coordinates() -> None:
    assert [quantity(2, u) for u in ("um", "arcsec", "deg", "urad")] == [
        "2.00\u00a0µm",
        "2.00″",
        "2.00°",
        "2.00\u00a0µrad",
    ]
    assert [coordinate(v) for v in (120.0, -0.0001, 1.2345)] == ["120", "0", "1.234"]


def test_a_sentence_has_no_exponent_where_a_person_writes_none() -> None:
    assert said("{size:.2g} um, {share:.0%}", size=228.0, share=0.5) == "230 um, 50 %"
    assert said("{size:.2g} um", size=2.3e7) == "2.3e+07 um"
    with speaking("de"):
        assert said("{size:.2g} um", size=1.26e2) == "130 um"


@pytest.mark.parametrize(("low", "high", "apart"), [(-35, 35, 50), (-300, 300, 50), (0.2, 0.9, 99), (1e4, 3e4, 99)])
def test_a_scale_has_two_ticks_at_least(low: float, high: float, apart: float) -> None:
    ticks = PixelScale(low, high, 0.0, 100.0).ticks(apart)
    assert 2 <= len(ticks) <= 7
    assert all(0.0 <= at <= 100.0 for at, _ in ticks)
