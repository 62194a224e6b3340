"""What follows from the formulas of ISO 230-2 for any readings whatever."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from axiscal.evaluation import Positioning, PositioningTest, evaluate
from axiscal.numerics import Array

FIGURES = [
    f.name for f in fields(Positioning) if f.name not in ("per_target", "rotary", "warnings", "uncertainty", "vdi3441")
]
SIDES = ("A", "E", "R")


@st.composite
def readings(draw: st.DrawFn) -> tuple[Array, Array]:
    n, up, down = draw(st.integers(1, 8)), draw(st.integers(2, 5)), draw(st.integers(2, 5))
    value = st.floats(-1e-3, 1e-3)
    return draw(arrays(np.float64, (n, up), elements=value)), draw(arrays(np.float64, (n, down), elements=value))


def figures(up: Array, down: Array) -> dict[str, float]:
    result = evaluate(PositioningTest(np.arange(float(len(up))), up, down))
    vdi3441 = {f"VDI {name}": value for name, value in result.vdi3441.items()}
    return {**{name: getattr(result, name) for name in FIGURES}, **vdi3441}


@given(readings())
def test_inequalities(data: tuple[Array, Array]) -> None:
    f, slack = figures(*data), 1e-15
    for greater, lesser in [
        ("A", "E"), ("A", "R"), ("A", "A_up"), ("A", "A_down"), ("E", "M"), ("E", "E_up"), ("E", "E_down"), ("E", "B"),
        ("R", "R_up"), ("R", "R_down"), ("R", "B"),
    ]:  # fmt: skip
        assert f[greater] >= f[lesser] - slack, (greater, lesser)
    assert abs(f["B_mean"]) <= f["B"] + slack


@given(readings(), st.floats(-1e-2, 1e-2))
def test_a_constant_added_to_all_readings_changes_nothing(data: tuple[Array, Array], shift: float) -> None:
    assert figures(*(side + shift for side in data)) == pytest.approx(figures(*data), abs=1e-14)


@given(readings())
def test_swapping_the_directions_flips_only_the_sign_of_the_mean_reversal(data: tuple[Array, Array]) -> None:
    before, after = figures(*data), figures(*data[::-1])
    expected = before | {"B_mean": -before["B_mean"]}
    expected |= {f"{s}_up": before[f"{s}_down"] for s in SIDES} | {f"{s}_down": before[f"{s}_up"] for s in SIDES}
    assert after == pytest.approx(expected, abs=1e-15)


@given(readings(), st.floats(-100, 100))
def test_scaling_the_readings_scales_every_figure(data: tuple[Array, Array], scale: float) -> None:
    scaled = figures(*(scale * side for side in data))
    expected = {name: abs(scale) * value for name, value in figures(*data).items()}
    expected["B_mean"] = scale * figures(*data)["B_mean"]
    assert scaled == pytest.approx(expected, rel=1e-9, abs=1e-13)


@given(readings())
def test_the_order_of_runs_does_not_matter(data: tuple[Array, Array]) -> None:
    assert figures(*(side[:, ::-1] for side in data)) == pytest.approx(figures(*data), abs=1e-15)
