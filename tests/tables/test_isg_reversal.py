"""ISG and Beckhoff: bilateral leadscrew tables, read by a reader of its own (TF5200: actual less setpoint, 0.1 um)."""

from __future__ import annotations

import re

import numpy as np
import pytest

from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import machine_from_text
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.registry import export
from axiscal.tables.round_trip import drawn_and_known
from tests.generators.texts import machine_text

MACHINE = machine_text(
    "w-C'-X'-b-Y-Z-t",
    {"X": (-50, 350), "Y": (0, 300), "Z": (-200, 0), "C": (0, 360)},
    {
        "EXX": 'std = "10 um", knots = 7, length = "150 mm"',
        "EXX_reversal": 'std = "6 um", knots = 4',
        "EYY": 'std = "10 um", knots = 7, length = "150 mm"',
        "ECC": 'std = "40 urad", knots = 9, length = "120 deg"',
        "ECC_reversal": "60 urad",
    },
    tool=100,
    name="M",
)


def known() -> Estimate:
    return drawn_and_known(machine_from_text(MACHINE), 2)


def error(text: str, at: float, side: str) -> float:
    """Return what a list says the axis is off by, mm or deg."""
    keys = dict(re.findall(r"^kw\.ssfk\.(\w+)\s+(-?\d+)$", text, re.MULTILINE))
    rows = re.findall(rf"^kw\.ssfk\.table\[(\d+)\]\.{side}\s+(-?\d+)$", text, re.MULTILINE)
    values = [int(value) for _, value in sorted(rows, key=lambda row: int(row[0]))]
    assert keys["unit"] == keys["bilateral"] == "1"
    assert len(values) == int(keys["kw_nr_max"])
    points = int(keys["kw_startpos"]) + int(keys["interval"]) * np.arange(len(values))
    if keys["modulo"] == "1":
        at = points[0] / 1e4 + (at - points[0] / 1e4) % 360
    return float(np.interp(1e4 * at, points, values)) / 1e4


def test_the_reversal_is_in_a_bilateral_table_of_its_axis() -> None:
    estimate = known()
    made = export(estimate, "isg", ExportOptions())
    assert {name for name in made.files if name.startswith("ssfk")} == {"ssfk_X.lis", "ssfk_C.lis"}
    reversal = estimate.model.names["EXX_reversal"]
    for at in (-50.0, 30.0, 77.0, 350.0):
        carried = float(reversal.basis.rows(np.array([at * 1e-3]))[0] @ estimate.mean[reversal.columns])
        step = -1e3 * carried  # X' carries the workpiece: the tool is displaced the other way
        assert error(made.files["ssfk_X.lis"], at, "pos") == pytest.approx(step / 2, abs=2e-4)
        assert error(made.files["ssfk_X.lis"], at, "neg") == pytest.approx(-step / 2, abs=2e-4)
    assert "hold what the directions are apart" in made.readme
    assert "the reversal of straightness" in made.readme


def test_a_rotary_table_has_the_reversal_in_degrees_and_repeats() -> None:
    estimate = known()
    text = export(estimate, "isg", ExportOptions()).files["ssfk_C.lis"]
    reversal = estimate.model.names["ECC_reversal"]
    step = -np.degrees(estimate.mean[reversal.columns][0])
    for at in (10.0, 370.0, -350.0):
        assert error(text, at, "pos") == pytest.approx(step / 2, abs=1e-4)
    assert abs(step) > 1e-3
