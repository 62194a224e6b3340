"""Files of people with a lead error, on which the program failed: the slope that they hold is in the table."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from tests.zoo.answers import Answer
from tests.zoo.running import given

FOLDER = Path(__file__).resolve().parents[3] / "shared" / "field" / "01-lead-error-eaten"
FAILS_TODAY: set[str] = set()
"""Campaigns and readings whose slope the program eats; goes when there are none."""


def _files() -> list[object]:
    wrong = pytest.mark.xfail(strict=True, reason="answered wrongly so far")
    return [
        pytest.param(campaign, readings, slope, id=name, marks=[wrong] if name in FAILS_TODAY else [])
        for campaign in ("lb", "asread")
        for readings, slope in (("iso20", 0.02), ("iso60", 0.06), ("S11", 0.02))
        for name in [f"{campaign} {readings}"]
    ]


@pytest.mark.skipif(not FOLDER.is_dir(), reason="needs the files of the field beside the checkout")
@pytest.mark.parametrize(("campaign", "readings", "slope"), _files())
def test_a_straight_line_that_was_read_is_in_the_table(
    tmp_path: Path, campaign: str, readings: str, slope: float
) -> None:
    estimated = given("data", "estimate", FOLDER / f"{campaign}.toml", FOLDER / f"{readings}.csv", "--out", tmp_path)
    assert estimated.status == 0, estimated
    answer = Answer(tmp_path, estimated)
    where, values = answer.axis_table("X")
    left = slope * where - values.mean(axis=0)
    assert np.polyfit(where, values.mean(axis=0), 1)[0] >= 0.98 * slope
    assert np.quantile(np.abs(left - left.mean()), 0.95) <= answer.expanded_with_tables()


def test_the_reader_of_tables_takes_the_columns_of_the_axis_itself(tmp_path: Path) -> None:
    folder = tmp_path / "tables" / "csv"
    folder.mkdir(parents=True)
    with (folder / "X.csv").open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(
            [["axis", "position_mm", "forward_um", "reverse_um"], ["X", 0, 1, 3], ["X", 10, 2, 6], ["Y", 5, 9, 9]]
        )
    where, values = Answer(tmp_path, given("--version")).axis_table("X")
    assert (where.tolist(), values.tolist()) == ([0.0, 10.0], [[1.0, 2.0], [3.0, 6.0]])
