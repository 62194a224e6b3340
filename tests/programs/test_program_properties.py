"""Measuring programs by properties: any plan, any name, any control."""

import csv
import io
import math
import re

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from axiscal.machine.axis import iso_axis
from axiscal.programs import controllers
from axiscal.programs.program import plain, program_name
from axiscal.programs.scale import AxisScale
from axiscal_core.axes import Axis
from tests.programs.judge import Plan, random_plan, read_back

seeds = st.integers(10**6, 2 * 10**6)


def plan_of(seed: int) -> Plan:
    """Return the random plan of a seed, on any axes that every control can name."""
    return random_plan(np.random.default_rng(seed), "XYZABCUVW")


@pytest.mark.parametrize("controller", controllers())
@given(seed=seeds)
def test_any_plan_does_what_was_planned_and_nothing_else(controller: str, seed: int) -> None:
    for moves, faults in read_back(plan_of(seed), controller):
        assert moves > 0
        assert faults == []


@given(seed=seeds)
def test_the_list_has_every_reading_where_it_was_planned(seed: int) -> None:
    plan = plan_of(seed)
    rows = [row for p in plan.programs("sinumerik") for row in csv.DictReader(io.StringIO(p.listing, newline=""))]
    assert sorted(int(row["reading"]) for row in rows) == list(range(1, len(plan.places) + 1))
    for row in rows:
        place = plan.places[int(row["reading"]) - 1]
        assert re.sub(_SHIELD, "", row["setup"]) == place.setup
        signs = [
            axis.name + "+-"[side < 0] for axis, side in zip(plan.machine.axes, place.approach, strict=True) if side
        ]
        assert row["approach"].split() == signs
        for axis, value in zip(plan.machine.axes, place.pose, strict=True):
            off = math.degrees(value) - float(row[f"{axis.name}_deg"]) if axis.rotary else value - _metres(row, axis)
            assert math.isclose(off, 360 * round(off / 360) if axis.cyclic else 0, abs_tol=1.01e-4)


_SHIELD = r"^'(?='*[=+\-@\t\r])"
"""The apostrophe before text that a spreadsheet would compute (docs/readings.md)."""


def _metres(row: dict[str, str], axis: Axis) -> float:
    return float(row[f"{axis.name}_mm"]) / 1000


@given(text=st.text(max_size=200))
@example("a" * 59 + " " + "b" * 300)
def test_any_text_becomes_plain(text: str) -> None:
    assert re.fullmatch(r"[A-Z0-9 _.+-]{0,60}", plain(text))
    assert plain(plain(text)) == plain(text)


@given(text=st.text(max_size=200), number=st.integers(1, 99), longest=st.integers(12, 30))
def test_any_set_up_makes_a_name_that_every_control_takes(text: str, number: int, longest: int) -> None:
    name = program_name(number, text, longest)
    assert re.fullmatch("AXISCAL_[0-9]{2}(_[A-Z0-9]+)*", name)
    assert len(name) <= longest


@given(
    low=st.floats(-2, 2),
    length=st.floats(1e-4, 3),
    share=st.floats(0, 1),
    decimals=st.integers(3, 6),
    turns=st.booleans(),
)
def test_a_written_coordinate_is_the_nearest_within_the_travel(
    low: float, length: float, share: float, decimals: int, turns: bool
) -> None:
    axis = iso_axis("A" if turns else "X", False, (low, low + length))
    scale = AxisScale.of_axis(axis, decimals)
    value = min(low + share * length, low + length)
    number = scale.nearest(value)
    assert number is not None
    written = float(scale.written(number))
    assert float(scale.low) <= written <= float(scale.high)
    assert abs(written - (math.degrees(value) if turns else value * 1000)) <= 10.0**-decimals
    assert scale.nearest(low - 1e-6 * length - 1e-9) is None
    assert scale.nearest(low + length * (1 + 1e-6) + 1e-9) is None
