"""Numbers and sentences as a reader sees them."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.campaign.ending import because_text
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.language.spoken import said, speaking
from axiscal.present.drawing.svg_picture import PixelScale
from axiscal.present.sentences import (
    constant_note,
    coordinate,
    curve_note,
    figure,
    iso_name,
    position_heading,
    quantity,
    short,
)
from axiscal.present.summary import ConstantSummary, CurveSummary, HistoryRow


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


def test_units_and_what_a_person_chose() -> None:
    assert [quantity(2, u) for u in ("um", "arcsec", "deg", "urad")] == [
        "2.00\u00a0µm",
        "2.00″",
        "2.00°",
        "2.00\u00a0µrad",
    ]
    assert [short(v) for v in (2.0, 2.5, 100.0, 1e9)] == ["2", "2.5", "100", "1.00 × 10⁹"]
    assert [coordinate(v) for v in (120.0, -0.0001, 1.2345)] == ["120", "0", "1.234"]
    assert [iso_name(n) for n in ("A", "E_up", "R_down", "B_mean")] == ["A", "E↑", "R↓", "B mean"]


def _curve(std: float, seen: float, prior: float) -> CurveSummary:
    return CurveSummary("EXX", "X", "", [0.0, 1.0], [0.0, 0.0], [std] * 2, [seen] * 2, [prior] * 2, "mm", "um")


def test_a_curve_says_what_it_owes_to_the_readings() -> None:
    read = replace(_curve(1.0, 1.0, 10.0), from_readings=0.4)
    assert curve_note(read) == "±1.96\u00a0µm, stated ±19.6; 40 % from readings"
    assert curve_note(replace(read, from_readings=0.09)) == "±1.96\u00a0µm, hardly touched by the readings"


def test_a_constant_has_the_decimals_of_its_uncertainty() -> None:
    for mean, half, text in (
        (-1360.4188, 7.171, "−1\u202f360.42 ± 7.17\u00a0µm"),
        (-5.92e-4, 0.205, "−0.001 ± 0.205\u00a0µm"),
        (1e-5, 58.83, "0.0 ± 58.8\u00a0µm"),
        (2.5, 0.0, "2.50 ± 0\u00a0µm"),
        (12.0, 1960.0, "12 ± 1\u202f960\u00a0µm"),
    ):
        assert constant_note(ConstantSummary("C", "", mean, half / BAND, 1.0, "um")) == text


def test_a_sentence_has_no_exponent_where_a_person_writes_none() -> None:
    assert said("{size:.2g} um, {share:.0%}", size=228.0, share=0.5) == "230 um, 50 %"
    assert said("{size:.2g} um", size=2.3e7) == "2.3e+07 um"
    with speaking("de"):
        assert said("{size:.2g} um", size=1.26e2) == "130 um"


@pytest.mark.parametrize(("low", "high", "count"), [(-35, 35, 2), (-300, 300, 2), (0.2, 0.9, 1), (1e4, 3e4, 1)])
def test_a_scale_has_two_ticks_at_least(low: float, high: float, count: int) -> None:
    ticks = PixelScale(low, high, 0.0, 100.0).ticks(count)
    assert 2 <= len(ticks) <= 7
    assert all(0.0 <= at <= 100.0 for at, _ in ticks)


@pytest.mark.parametrize(
    ("axes", "said_above"),
    [("XY", "position, mm"), ("C", "position, °"), ("XC", "position, mm and °"), ("", "position, mm")],
)
def test_the_heading_of_positions_has_the_units_that_occur(axes: str, said_above: str) -> None:
    place = dict.fromkeys(axes, 1.0) or None
    rows = [HistoryRow(n, "a", where, 1.0, 0, 1, 9.0, 9.0, 3.0) for n, where in enumerate((None, place))]
    assert position_heading(rows) == said_above
