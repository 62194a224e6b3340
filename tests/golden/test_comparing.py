"""The comparison: equal is equal, each difference is named with its place, and the tolerance is kept."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.golden.comparing import differences
from tests.golden.showing import _document, _masked

KEPT = {"rms_um": 1.25, "curve": [0.0, 40.0, -3.0], "text": "RMS 2.5 um after 3 readings", "seen": True}


def _folder(path: Path, **files: object) -> Path:
    path.mkdir()
    for name, content in files.items():
        text = content if isinstance(content, str) else json.dumps(content)
        (path / name.replace("_", ".")).write_text(text)
    return path


def _found(tmp_path: Path, first: dict[str, Any], second: dict[str, Any]) -> list[str]:
    folders = _folder(tmp_path / "first", **first), _folder(tmp_path / "second", **second)
    return [str(each) for each in differences(*folders)]


def test_what_is_equal_has_no_difference(tmp_path: Path) -> None:
    assert _found(tmp_path, {"a_json": KEPT, "b_txt": "1 2\n"}, {"a_json": KEPT, "b_txt": "1 2\n"}) == []


def test_a_difference_names_file_place_and_both_values(tmp_path: Path) -> None:
    other = {**KEPT, "curve": [0.0, 40.01, -3.0]}
    assert _found(tmp_path, {"a_json": KEPT}, {"a_json": other}) == ["a.json: $.curve[1]: 40.0 | 40.01"]


@pytest.mark.parametrize(
    "change",
    [
        {"rms_um": 1.2502},
        {"rms_um": "1.25"},
        {"rms_um": None},
        {"seen": 1},
        {"curve": [0.0, 40.0]},
        {"curve": [0.0, 40.0, -3.0, 0.0]},
        {"curve": [0.005, 40.0, -3.0]},
        {"text": "RMS 2.5 um after 4 readings"},
        {"text": "RMS 2.5 um of 3 readings"},
        {"more": 0.0},
    ],
)
def test_no_change_that_people_see_passes(change: dict[str, Any], tmp_path: Path) -> None:
    assert len(_found(tmp_path, {"a_json": KEPT}, {"a_json": {**KEPT, **change}})) == 1


@pytest.mark.parametrize(
    "change",
    [{"rms_um": 1.25001}, {"curve": [0.003, 40.0, -3.0]}, {"text": "RMS 2.50001 um after 3 readings"}],
)
def test_what_rounding_does_passes(change: dict[str, Any], tmp_path: Path) -> None:
    assert _found(tmp_path, {"a_json": KEPT}, {"a_json": {**KEPT, **change}}) == []


def test_lines_of_a_table_are_compared_by_their_numbers(tmp_path: Path) -> None:
    tables = {"x_comp": "0.0 1.5 2\n10.0 1.5 2\n"}, {"x_comp": "0.0 1.6 2\n10.0 1.7 2\n20.0 0 0\n"}
    found = _found(tmp_path, *tables)
    assert found == ["x.comp: line 2: 10.0 1.5 2 | 10.0 1.7 2", "x.comp: line 3: (nothing) | 20.0 0 0"]


def test_a_file_that_is_gone_is_a_difference(tmp_path: Path) -> None:
    assert _found(tmp_path, {"a_json": KEPT, "b_txt": "1"}, {"a_json": KEPT}) == [
        "b.txt: the file: is there | is missing"
    ]


def test_versions_are_masked_and_nothing_else() -> None:
    said = '12.5 um, axiscal 0.1.0, {"numpy": "2.4.6", "schema": "axiscal-result/1"}'
    assert _masked(said) == '12.5 um, axiscal <version>, {"numpy": "<version>", "schema": "axiscal-result/1"}'


def test_of_long_lists_and_grids_some_are_kept_and_of_things_the_last() -> None:
    grid = [[float(100 * row + column) for column in range(40)] for row in range(3)]
    lists = {"curve": [0.1] * 100, "rows": [{"a": number / 3} for number in range(100)], "grid": grid}
    kept = json.loads(_document(json.dumps(lists)))
    assert kept["curve"] == {"length": 100, "every": 13, "values": [0.1] * 8}
    assert kept["rows"]["values"][-1] == {"a": 33.0}
    assert [each["a"] for each in kept["rows"]["values"][:2]] == pytest.approx([1 / 3, 8 / 3])
    assert kept["grid"] == {"lengths": [3, 40], "every": [1, 5], "values": [row[::5] for row in grid]}
