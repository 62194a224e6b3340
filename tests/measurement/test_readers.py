"""CSV: readings, poses, truth curves, refusals in words; every text comes back, and none is a formula."""

import csv
import io
from math import pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import ReadingError
from axiscal.machine import load_machine
from axiscal.measurement.readers.csv_readings import read_poses
from axiscal.measurement.readers.csv_table import csv_text, table_of, unshielded
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.readers.text_file import TextFile, lines_of
from axiscal.measurement.simulation import read_truth

TRUTH = """error,position_mm,position_deg,value_um,value_urad
EXX,0,,1.5,
EXX,100.5,,-2,
EAX,0,,,10
ECC,,-180,,1
ECC,,180,,2
C0Y,,,,30
EXX_reversal,,,3,
"""


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "file.csv"
    path.write_text(text)
    return path


def test_poses(tmp_path: Path) -> None:
    poses = read_poses(written(tmp_path, "C_deg,X_mm,approach\n180,10,X-\n0,20,\n"))
    found = [(each.position, each.approach, each.line) for each in poses]
    assert found == [({"C": pi, "X": 0.01}, {"X": -1}, 2), ({"C": 0.0, "X": 0.02}, {}, 3)]


def test_truth_curves(tmp_path: Path) -> None:
    curves = read_truth(written(tmp_path, TRUTH))
    assert list(curves) == ["EXX", "EAX", "ECC", "C0Y", "EXX_reversal"]
    assert curves["EXX"].positions == pytest.approx([0, 0.1005])
    assert curves["EXX"].values == pytest.approx([1.5e-6, -2e-6])
    positions, values = curves["ECC"]
    assert positions == pytest.approx([-pi, pi])
    assert values == pytest.approx([1e-6, 2e-6])
    assert (curves["C0Y"].positions.tolist(), curves["C0Y"].values.tolist()) == ([0.0], [pytest.approx(3e-5)])
    assert curves["EXX_reversal"].values == pytest.approx([3e-6])


def test_truth_curves_may_interleave_and_be_spelt_in_full(tmp_path: Path) -> None:
    curves = read_truth(written(tmp_path, "error,position_mm,value_um\nEXX,0,1\nEYX,0,5\nEXX,1,2\nEYX,1,6\n"))
    assert np.array_equal(curves["EYX"].values, np.array([5e-6, 6e-6]))
    assert list(read_truth(written(tmp_path, "error,position_mm,value_urad\nEC(0X)Y,,5\n"))) == ["C0Y"]


def test_a_file_without_a_header_is_shown_that_of_the_machine(tmp_path: Path) -> None:
    with pytest.raises(ReadingError, match=r"line 1.*names the columns, such as setup,C_deg,B_deg,Y_mm"):
        read_any(written(tmp_path, "s,0,0,1,1,1,X+,2\n"), load_machine("dmu60").axes)


@given(st.text())
def test_any_text_is_a_table_or_refused(text: str) -> None:
    try:
        table = table_of(TextFile("file.csv", lines_of(text, "file.csv")))
    except ReadingError:
        return
    assert table.rows
    assert all(len(row.texts) == len(table.columns) for row in table.rows)


@given(st.lists(st.lists(st.floats(-1e3, 1e3, exclude_min=True, exclude_max=True), min_size=3, max_size=3), min_size=1))
def test_numbers_come_back_as_written(rows: list[list[float]]) -> None:
    text = "X_m,Y_m,Z_m\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows)
    table = table_of(TextFile("file.csv", lines_of(text, "file.csv")))
    assert [[row.of(axis).quantity() for axis in "XYZ"] for row in table.rows] == rows


@given(st.text(alphabet="0123456789.,'eE+-_ naif١²", min_size=1))
def test_a_number_is_read_only_when_everybody_reads_it_so(cell: str) -> None:
    """A mark that stands once is the decimal one, unless three digits behind it may be thousands."""
    table = table_of(TextFile("file.csv", ("X_m,Y_m", f'"{cell}",1')))
    try:
        value = table.rows[0].of("X").quantity()
    except ReadingError:
        return
    marks = [letter for letter in cell if letter in ".,"]
    decimal = marks[-1] if marks and marks.count(marks[-1]) == 1 else ""
    kept = (each for each in cell.strip(" '") if each == decimal or each not in ".,' ")
    plain = "".join("." if each == decimal else each for each in kept)
    assert value == float(plain)
    assert set(plain) <= set("0123456789.eE+-")


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


@given(st.lists(st.lists(st.text(st.characters(exclude_characters="\r\n")), min_size=1), min_size=1))
def test_every_text_comes_back(rows: list[list[str]]) -> None:
    assert back(csv_text(rows)) == rows
