"""Files of instruments that are cut off, doubled or endless: each an error with its line and what would be right."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.csv_readings import read_times
from axiscal.measurement.readers.csv_table import parse_table
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.readers.text_file import MOST_LINES
from tests.measurement.test_instrument_files import MAP, MESH, RTL
from tests.measurement.test_level_survey import SURVEY

NODES = "\n".join(MAP.split("\n")[:2])
NOTHING_PROBED = NODES + "\n0,10,0,10,-1,10,10,2,2\n0,0\n0,0\n"
FOUND = [
    ("RepRapFirmware height map file v2\nxmin,xmax\n0,1", "line 3.*the height map is cut off"),
    (MAP.replace("30.00,30.00,3,2", "30.00,30.00,9,2"), "line 3.*9 nodes from 10 to 70 mm, 30 mm apart, are no map"),
    (MAP.replace("30.00,30.00,3,2", "0,30.00,3,2"), "3 nodes from 10 to 70 mm, 0 mm apart, are no map"),
    (MAP.replace("30.00,30.00,3,2", "30.00,30.00,0,2"), "0 nodes from 10 to 70 mm, 30 mm apart, are no map"),
    (NOTHING_PROBED, "line 4.*no node was probed"),
    (MESH.replace("max_x = 70.0", "max_x = 10.0"), "line 4.*3 nodes from 10 to 10 mm, 0 mm apart, are no map"),
    (MESH.replace("x_count = 3", "x_count = 1"), "1 nodes from 10 to 70 mm, 60 mm apart, are no map"),
    (RTL[: RTL.index("1   1   0.100")], "there are no deviations"),
    (RTL.replace("0.000000 50.000000\n100.000000\n", ""), "line 5.*there are no targets"),
    ("X_mm,value_um\n" * (MOST_LINES + 1), f"has {MOST_LINES + 2:,} lines, and at most {MOST_LINES:,} are read"),
]


@pytest.mark.parametrize(("text", "says"), FOUND)
def test_what_is_cut_off_or_endless_is_refused(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "file.txt"
    path.write_text(text)
    with pytest.raises(ReadingError, match=says):
        read_any(path)


def test_what_stands_around_a_mesh_does_not_count(tmp_path: Path) -> None:
    path = tmp_path / "printer.cfg"
    path.write_text(MESH)
    plain = read_any(path)
    path.write_text(MESH.replace("#*# version = 1", "#*#\n#*# version = 1\n#*# 1, 2, 3"))  # between keys
    assert [(each.position, each.value) for each in read_any(path)] == [(each.position, each.value) for each in plain]
    path.write_text(MESH + "[gcode_macro]\n")
    assert read_any(path) == plain


def test_remarks_of_a_survey_may_be_apart_and_alone(tmp_path: Path) -> None:
    path = tmp_path / "survey.txt"
    path.write_text(SURVEY)
    plain = read_any(path)
    path.write_text(SURVEY.replace("# base", "\n# base"))
    assert [each.value for each in read_any(path)] == [each.value for each in plain]
    path.write_text("# level survey\n# base = 100 mm\n")
    with pytest.raises(ReadingError):
        read_any(path)


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
