"""The comparison: equal is equal, each difference is named with its place, and a tolerance is kept."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.scenarios.comparing import differences
from tests.scenarios.writing import masked

KEPT = {"rms_um": 1.25, "curve": [0.0, 40.0, -3.0], "text": "RMS 2.5 um after 3 readings", "seen": True}


def _folder(path: Path, **files: object) -> Path:
    path.mkdir()
    for name, content in files.items():
        text = content if isinstance(content, str) else json.dumps(content)
        (path / name.replace("_", ".")).write_text(text)
    return path


def _found(tmp_path: Path, first: dict[str, Any], second: dict[str, Any], tolerance: float = 0.0) -> list[str]:
    folders = _folder(tmp_path / "first", **first), _folder(tmp_path / "second", **second)
    return [str(each) for each in differences(*folders, tolerance)]


def test_what_is_equal_has_no_difference(tmp_path: Path) -> None:
    assert _found(tmp_path, {"a_json": KEPT, "b_txt": "1 2\n"}, {"a_json": KEPT, "b_txt": "1 2\n"}) == []


def test_a_difference_names_file_place_and_both_values(tmp_path: Path) -> None:
    other = {**KEPT, "curve": [0.0, 40.000001, -3.0]}
    assert _found(tmp_path, {"a_json": KEPT}, {"a_json": other}) == ["a.json: $.curve[1]: 40.0 | 40.000001"]


@pytest.mark.parametrize(
    "change",
    [
        {"rms_um": 1.26},
        {"rms_um": "1.25"},
        {"rms_um": None},
        {"seen": 1},
        {"curve": [0.0, 40.0]},
        {"curve": [0.0, 40.0, -3.0, 0.0]},
        {"text": "RMS 2.5 um after 4 readings"},
        {"more": 0.0},
    ],
)
@pytest.mark.parametrize("tolerance", [0.0, 1e-6])
def test_no_change_that_people_see_passes(change: dict[str, Any], tolerance: float, tmp_path: Path) -> None:
    assert len(_found(tmp_path, {"a_json": KEPT}, {"a_json": {**KEPT, **change}}, tolerance)) == 1


@pytest.mark.parametrize(
    ("change", "least"),
    [
        ({"rms_um": 1.25 * (1 + 1e-9)}, 1e-9),
        ({"curve": [40e-9, 40.0, -3.0]}, 1e-9),
        ({"text": "RMS 2.50000001 um after 3 readings"}, 4e-9),
    ],
)
def test_numbers_pass_within_the_tolerance_only(change: dict[str, Any], least: float, tmp_path: Path) -> None:
    for folder, factor, count in (("within", 1.01, 0), ("beyond", 0.9, 1)):
        (tmp_path / folder).mkdir()
        first, second = {"a_json": KEPT}, {"a_json": {**KEPT, **change}}
        assert len(_found(tmp_path / folder, first, second, factor * least)) == count


def test_lines_of_a_table_are_compared_by_their_numbers(tmp_path: Path) -> None:
    tables = {"x_comp": "0.0 1.5 2\n10.0 1.5 2\n"}, {"x_comp": "0.0 1.5 2\n10.0 1.6 2\n20.0 0 0\n"}
    found = _found(tmp_path, *tables, 1e-6)
    assert found == ["x.comp: line 2: 10.0 1.5 2 | 10.0 1.6 2", "x.comp: line 3: (nothing) | 20.0 0 0"]


def test_a_file_that_is_gone_and_one_in_another_form_are_differences(tmp_path: Path) -> None:
    first = {"a_json": '{"a": 1, "b": 2}', "b_txt": "1"}
    found = _found(tmp_path, first, {"a_json": '{"b": 2, "a": 1}'})
    assert found == [
        "a.json: the form: the same values | in other bytes",
        "b.txt: the file: is there | is missing",
    ]


def test_times_and_versions_are_masked_and_nothing_else() -> None:
    said = '2026-11-20 at 12.5 um, axiscal 0.1.0, {"numpy": "2.4.6", "schema": "axiscal-result/1"} 2025-01-02T03:04:05Z'
    kept = '<date> at 12.5 um, axiscal <version>, {"numpy": "<version>", "schema": "axiscal-result/1"} <date>'
    assert masked(said) == kept
