"""Text in CSV files: no formula for a spreadsheet, and every text comes back as itself."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.measurement.readers.csv_readings import read_readings
from axiscal.measurement.readers.csv_table import csv_text, unshielded

FORMULAS = [
    f"{sign}{rest}" for sign in "=+-@\t" for rest in ("X laser", "1+2", "SUM(A1:A9)", "cmd|' /C calc'!A0", "'x")
]


def back(text: str) -> list[list[str]]:
    return [[unshielded(cell) for cell in row] for row in csv.reader(io.StringIO(text))]


@pytest.mark.parametrize("name", FORMULAS)
def test_no_cell_is_a_formula(name: str) -> None:
    (cell,) = next(csv.reader(io.StringIO(csv_text([[name]]))))
    assert cell[0] == "'"
    assert back(csv_text([[name]])) == [[name]]


@pytest.mark.parametrize("number", ["-1.5", "+2", "0.0", "-1e-6", "-.5"])
def test_numbers_are_left_alone(number: str) -> None:
    assert csv_text([[number, "x"]]) == f"{number},x\n"


@given(st.lists(st.lists(st.text(st.characters(exclude_characters="\r\n")), min_size=1), min_size=1))
def test_every_text_comes_back(rows: list[list[str]]) -> None:
    assert back(csv_text(rows)) == rows


@given(st.lists(st.lists(st.text(st.characters(exclude_characters="\r\n")), min_size=2), min_size=1))
def test_written_read_and_written_again_it_is_the_same_to_the_byte(rows: list[list[str]]) -> None:
    text = csv_text(rows)
    assert csv_text(back(text)) == text


@pytest.mark.parametrize(
    "name", ["+X laser", "=1+2", "-probe", "@home", "'+X laser", "laser, along X", 'the "long" one']
)
def test_a_set_up_comes_back_as_itself(name: str, tmp_path: Path) -> None:
    path = tmp_path / "readings.csv"
    path.write_text(csv_text([["setup", "X_mm", "value_um"], [name, "10", "-1.5"]]))
    (reading,) = read_readings(path)
    assert (reading.setup, reading.value) == (name, -1.5e-6)
