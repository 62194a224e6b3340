"""The statement of uncertainty: whoever redoes its sum by hand finds the figures that it states."""

import math

import pytest

from axiscal.estimation.estimate import concluded
from axiscal.present.result_of_campaign import WORTH, budget_rows
from tests.generators.laser_axis import CASE, machine, read
from tests.golden.surfaces import redone


def test_sources_with_a_row_and_those_without_add_up() -> None:
    known = concluded(CASE, read(machine(3), 24))
    rows, smaller = budget_rows(known)
    assert all(row.share >= WORTH for row in rows)
    assert 0.0 < smaller < rows[0].rms_um
    whole = math.hypot(smaller, *(row.rms_um for row in rows))
    assert whole == pytest.approx(1e6 * known.accuracy.rms, rel=1e-5)


def test_a_part_that_is_left_out_is_found() -> None:
    sources = [["noise", "3.000 µm", "36.0 %"], ["detail", "4.000 µm", "64.0 %"]]
    total = "u = √(sum of squares) = 5.000 µm. U = k u = 2.000 · 5.000 µm = 10.0 µm."
    assert redone(sources, total).faults == []
    assert redone(sources[:1], total).faults == ["u: 3.0 instead of 5.0"]
