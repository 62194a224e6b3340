"""Files of instruments that are cut off, doubled or endless: each an error with its line and what would be right."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.csv_readings import read_times
from axiscal.measurement.readers.csv_table import parse_table
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.readers.text_file import MOST_LINES
from tests.measurement.test_instrument_files import MESH


def test_a_file_without_end_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("X_mm,value_um\n" * (MOST_LINES + 1))
    with pytest.raises(ReadingError, match=f"has {MOST_LINES + 2:,} lines, and at most {MOST_LINES:,} are read"):
        read_any(path)


def test_what_stands_around_a_mesh_does_not_count(tmp_path: Path) -> None:
    path = tmp_path / "printer.cfg"
    path.write_text(MESH)
    plain = read_any(path)
    path.write_text(MESH.replace("#*# version = 1", "#*#\n#*# version = 1\n#*# 1, 2, 3"))  # between keys
    assert [(each.position, each.value) for each in read_any(path)] == [(each.position, each.value) for each in plain]
    path.write_text(MESH + "[gcode_macro]\n")
    assert read_any(path) == plain


@pytest.mark.parametrize(
    ("second", "says"),
    [
        ("14:05:30", r"line 3.*'14:05:30' is written unlike those above"),
        ("2026-11-20T14:05:29", r"line 3.*is before that of the line above"),
        ("2026-11-20T14:05:31+01:00", r"line 3.*is written unlike those above"),
        ("2026-11-20", r"line 3.*is a day without a time of day"),
        ("noon", r"line 3.*'noon' is no time"),
    ],
)
def test_times_that_cannot_follow_each_other_are_refused(second: str, says: str) -> None:
    table = parse_table(f"setup,time\na,2026-11-20T14:05:30\na,{second}\n", "file.csv")
    with pytest.raises(ReadingError, match=says):
        read_times(table.rows, table.columns[1])


def test_a_number_without_a_unit_in_its_header_is_refused() -> None:
    table = parse_table("setup,target\na,1\n", "file.csv")
    with pytest.raises(ReadingError, match=r"line 2.*column 'target' has no unit.*'target_mm' or 'target_deg'"):
        table.rows[0].quantity(table.columns[1])
