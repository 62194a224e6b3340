"""The statement of uncertainty: whoever redoes its sum by hand finds the figures that it states."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import pytest

from axiscal.present.statement import statement
from axiscal.present.summary import BudgetRow
from tests.present.test_page import five_axis_summary


def test_the_squares_of_the_sources_add_up_to_what_the_sum_says() -> None:
    parts = [BudgetRow(str(each), each, each**2 / 25) for each in (3.0, 4.0)]
    said = statement(replace(five_axis_summary(3), rms_um=5.0, budget=parts))
    by_hand = math.sqrt(sum(float(source[3].split("\xa0")[0]) ** 2 for source in said.sources))
    stated = [float(figure) for figure in re.findall(r"= ([\d.]+)\xa0µm", said.sum)]
    assert stated[0] == pytest.approx(by_hand, rel=0.01)
    assert 5.0 in stated


def test_tables_on_a_terminal_have_headings() -> None:
    summary = replace(five_axis_summary(3), budget=[BudgetRow("noise", 5.0, 1.0)])
    lines = [tuple(line.split("  ")) for line in statement(summary).lines]
    errors, sources = (
        ("error", "code", "before, 95 %", "now, 95 %"),
        ("source", "type", "distribution", "u", "share of u²"),
    )
    assert lines.index(errors) < lines.index(sources)
