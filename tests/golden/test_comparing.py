"""The comparison: equal is equal, each difference is named with its place, and the tolerance is kept."""

import json
from pathlib import Path
from typing import Any

import pytest

from tests.golden.comparing import differences

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
