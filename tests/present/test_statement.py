"""The statement of uncertainty: whoever redoes its sum by hand finds the figures that it states."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from axiscal.estimation.estimate import concluded
from axiscal.present.statement import statement
from axiscal.present.summarising import budget_rows
from axiscal.present.summary import WORTH, BudgetRow
from tests.generators.laser_axis import CASE, machine, read
from tests.generators.summaries import five_axis_summary
from tests.golden.surfaces import redone


def test_sources_with_a_row_and_those_without_add_up() -> None:
    known = concluded(CASE, read(machine(3), 24))
    rows, smaller = budget_rows(known)
    assert all(row.share >= WORTH for row in rows)
    assert 0.0 < smaller < rows[0].rms_um
    whole = math.hypot(smaller, *(row.rms_um for row in rows))
    assert whole == pytest.approx(1e6 * known.accuracy.rms, rel=1e-9)


def test_a_part_that_is_left_out_is_found() -> None:
    parts = [BudgetRow(str(each), each, each**2 / 25) for each in (3.0, 4.0)]
    stood = five_axis_summary(3)
    known = replace(stood.expanded, space=10.0, factor=2.0)
    *_, heading, first, second, total = statement(replace(stood, rms_um=5.0, budget=parts, expanded=known))
    assert heading.split("  ") == ["source", "type", "distribution", "u", "share of u²"]
    sources = [line.split("  ") for line in (first, second)]
    assert redone(sources, total).faults == []
    assert redone(sources[:1], total).faults == ["u: 3.0 instead of 5.0"]
