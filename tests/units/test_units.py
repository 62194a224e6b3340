"""Quantities with units, by hand, by fractions and by properties; nonsense is a UnitError and nothing else."""

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import UnitError
from axiscal.units import (
    EXAMPLES,
    Dimension,
    find_unit,
    format_quantity,
    from_unit,
    parse_quantity,
    to_unit,
)

RIGHT: list[tuple[str, Dimension, float]] = [
    ("12 um", "length", 12e-6),
    ("12 µm", "length", 12e-6),
    ("12 μm", "length", 12e-6),
    ("12um", "length", 12e-6),
    ("  12  um ", "length", 12e-6),
    ("-150 mm", "length", -0.15),
    ("−150 mm", "length", -0.15),
    ("+.5 m", "length", 0.5),
    ("5. nm", "length", 5e-9),
    ("1e3 mm", "length", 1.0),
    ("1 in", "length", 0.0254),
    ("0.5 arcsec", "angle", math.radians(0.5 / 3600)),
    ("30 urad", "angle", 30e-6),
    ("30 µrad", "angle", 30e-6),
    ("180 deg", "angle", math.pi),
    ("180°", "angle", math.pi),
    ("60 arcmin", "angle", math.radians(1)),
    ("1 rev", "angle", math.tau),
    ("5 µm/m", "angle", 5e-6),
    ("5 um / m", "angle", 5e-6),
    ("0.1 mm/m", "angle", 1e-4),
    ("90 min", "time", 5400.0),
    ("1 s", "time", 1.0),
    ("250 ms", "time", 0.25),
    ("2 h", "time", 7200.0),
    ("10 m/min", "speed", 10 / 60),
    ("600 mm/s", "speed", 0.6),
    ("30 rpm", "rotation_speed", math.pi),
    ("360 deg/s", "rotation_speed", math.tau),
    ("30 rev/min", "rotation_speed", math.pi),
    ("2 m/s^2", "acceleration", 2.0),
    ("2 m/s2", "acceleration", 2.0),
    ("2 m/s²", "acceleration", 2.0),
    ("3 rad/s^2", "rotation_acceleration", 3.0),
    ("180 deg/s^2", "rotation_acceleration", math.pi),
    ("20 degC", "temperature", 293.15),
    ("20 °C", "temperature", 293.15),
    ("0 K", "temperature", 0.0),
    ("0.5 K", "temperature_difference", 0.5),
    ("11.7 um/m/K", "expansion", 11.7e-6),
    ("11.7 µm/(m K)", "expansion", 11.7e-6),
    ("11.7 um/(m·K)", "expansion", 11.7e-6),
    ("11.7e-6 1/K", "expansion", 11.7e-6),
]


@pytest.mark.parametrize(("text", "dimension", "value"), RIGHT)
def test_a_quantity_is_read_to_si(text: str, dimension: Dimension, value: float) -> None:
    assert parse_quantity(text, dimension) == pytest.approx(value, rel=1e-15, abs=0)


@pytest.mark.parametrize("dimension", EXAMPLES)
def test_the_example_shown_for_a_dimension_is_one(dimension: Dimension) -> None:
    assert math.isfinite(parse_quantity(EXAMPLES[dimension], dimension))


@pytest.mark.parametrize("text", ["120 mm", "0.3 um", "7 nm", "12.7 cm", "254 inch"])
def test_lengths_are_the_nearest_double(text: str) -> None:
    number, unit = text.split()
    metres = {"mm": "1e-3", "um": "1e-6", "nm": "1e-9", "cm": "1e-2", "inch": "0.0254"}[unit]
    exact = Fraction(number) * Fraction(metres)
    assert abs(Fraction(parse_quantity(text, "length")) - exact) <= Fraction(math.ulp(float(exact)))


def test_a_value_is_written_as_it_is_read() -> None:
    assert format_quantity(12e-6, "um") == "12 um"
    assert format_quantity(math.pi, "deg") == "180 deg"
    assert format_quantity(1 / 3e6, "um", digits=3) == "0.333 um"
    assert parse_quantity(format_quantity(0.123456789012345, "mm", digits=17), "length") == pytest.approx(
        0.123456789012345, rel=1e-15
    )


def test_an_unknown_unit_is_refused_with_the_nearest() -> None:
    with pytest.raises(UnitError, match='Perhaps "mm" is meant'):
        from_unit(1.0, "Mm")
    with pytest.raises(UnitError, match="Units are written like"):
        find_unit("bushel")
    assert find_unit("um/m").dimension == "angle"


DIMENSIONS: list[Dimension] = list(EXAMPLES)
UNITS = ["nm", "um", "mm", "m", "urad", "arcsec", "deg", "um/m", "s", "min", "m/min", "rpm", "deg/s^2", "1/K"]
sizes = st.floats(-1e12, 1e12, allow_nan=False).filter(lambda value: value == 0 or abs(value) > 1e-12)


@given(sizes, st.sampled_from(UNITS))
def test_writing_and_reading_give_the_value_back(value: float, unit: str) -> None:
    read = parse_quantity(format_quantity(value, unit, digits=17), find_unit(unit).dimension)
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
