"""Quantities survive writing and reading; nothing but a UnitError comes out of nonsense."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import UnitError
from axiscal.units import EXAMPLES, Dimension, dimension_of, format_quantity, from_unit, parse_quantity, to_unit

DIMENSIONS: list[Dimension] = list(EXAMPLES)
UNITS = ["nm", "um", "mm", "m", "urad", "arcsec", "deg", "um/m", "s", "min", "m/min", "rpm", "deg/s^2", "1/K"]
sizes = st.floats(-1e12, 1e12, allow_nan=False).filter(lambda value: value == 0 or abs(value) > 1e-12)


@given(sizes, st.sampled_from(UNITS))
def test_writing_and_reading_give_the_value_back(value: float, unit: str) -> None:
    read = parse_quantity(format_quantity(value, unit, digits=17), dimension_of(unit))
    assert read == pytest.approx(value, rel=4e-16 * 4, abs=0)


@given(sizes, st.sampled_from(UNITS))
def test_to_and_from_a_unit_are_inverse(value: float, unit: str) -> None:
    assert from_unit(to_unit(value, unit), unit) == pytest.approx(value, rel=1e-15, abs=0)


@given(sizes, sizes, st.sampled_from(UNITS))
def test_order_is_kept(one: float, other: float, unit: str) -> None:
    assert (from_unit(one, unit) <= from_unit(other, unit)) or one > other


near_quantities = st.builds(
    "".join,
    st.lists(st.sampled_from([*"0123456789.,+-eE ²µ°/^()", "um", "mm", "deg", "nan", "inf", "rad", "\n"]), max_size=12),
)


@given(st.text(max_size=40) | near_quantities, st.sampled_from(DIMENSIONS))
def test_any_text_is_a_finite_quantity_or_a_unit_error(text: str, dimension: Dimension) -> None:
    assert math.isfinite(_value_or_nan(text, dimension)) or _refusal(text, dimension).isprintable()


def _value_or_nan(text: str, dimension: Dimension) -> float:
    try:
        value = parse_quantity(text, dimension)
    except UnitError:
        return math.nan
    assert math.isfinite(value)
    return value


def _refusal(text: str, dimension: Dimension) -> str:
    with pytest.raises(UnitError) as failure:
        parse_quantity(text, dimension)
    return str(failure.value)
