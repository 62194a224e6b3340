"""What `make mutants` leaves alone, runs and says."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from scipy.stats import binom

from tests.certify.kept import HOUSE
from tests.reliability.covering import Covered, failed_of
from tests.reliability.mutants import PACKAGE, files_of_tests, score, silent, statement


@pytest.mark.parametrize(("killed", "tried"), [(0, 10), (57, 60), (60, 60)])
def test_the_interval_of_a_score_is_clopper_and_pearsons(killed: int, tried: int) -> None:
    share, low, high = score(killed, tried)
    assert share == killed / tried
    assert binom.sf(killed - 1, tried, low) == pytest.approx(0.025 if killed else 1.0)
    assert binom.cdf(killed, tried, high) == pytest.approx(0.025 if killed < tried else 1.0)


def test_types_and_decorators_are_left_alone_and_nothing_else() -> None:
    source = "@kept(1)\ndef f(a: int | None = 2) -> int | str:\n    b: list[3] = a | 4\n    return b"
    left = sorted(silent(ast.parse(source)))
    lines = source.splitlines()
    assert [lines[begin[0] - 1][begin[1] : end[1]] for begin, end in left] == [
        "kept(1)",
        "int | None",
        "int | str",
        "list[3]",
    ]


def test_tests_of_a_module_are_those_of_its_room_and_those_that_name_it() -> None:
    tests = files_of_tests(PACKAGE / "numerics" / "gaussian.py")
    assert {"tests/numerics/test_gaussian.py"} <= set(tests)
    assert "tests/estimation/test_outliers.py" not in tests
    assert "tests/estimation/test_concluded.py" in files_of_tests(PACKAGE / "estimation" / "believed.py")


def test_lines_of_a_change_are_those_of_its_statement() -> None:
    source = "if (\n    a\n    and b\n):\n    c = (\n        d\n    )\nelse:\n    e = 1\n"
    lines = [list(statement(ast.parse(source), line)) for line in range(1, 10)]
    assert lines[:4] == [[1, 2, 3, 4]] * 4
    assert lines[4:7] == [[5, 6, 7]] * 3
    assert lines[8] == [9]


def test_tests_of_a_line_come_fastest_first_and_of_one_run_at_loading_from_the_file(tmp_path: Path) -> None:
    said = {"seconds": {"slow": 3.0, "quick": 0.1}, "lines": {"room.py": {"0": [0, 1], "1": [], "2": [1, 0], "6": [0]}}}
    (tmp_path / "covered.json").write_text(json.dumps(said))
    covered = Covered.read(tmp_path / "covered.json")
    assert covered.tests_of("room.py", [6]) == ["slow"]
    assert covered.tests_of("room.py", [1]) == covered.tests_of("room.py", [2, 6]) == ["quick", "slow"]
    assert covered.tests_of("other.py", [1]) == []


@pytest.mark.long
def test_a_change_is_noticed_by_the_tests_that_are_chosen_alone(tmp_path: Path) -> None:
    (tmp_path / "room.py").write_text("def half(x):\n    return x / 2\n")
    trial = tmp_path / "test_room.py"
    trial.write_text("from room import half\n\n\ndef test_half():\n    assert half(6) == 3\n\n\n")
    with trial.open("a") as file:
        file.write("def test_wrong():\n    assert half(6) == 4\n")
    assert _failed(tmp_path, "test_half") is None
    assert _failed(tmp_path, "test_half", "test_wrong") == "test_room.py::test_wrong"
    (tmp_path / "room.py").write_text("def half(x):\n    return x // 4\n")
    assert _failed(tmp_path, "test_wrong", "test_half") == "test_room.py::test_wrong"
    assert _failed(tmp_path, "test_half") == "test_room.py::test_half"


def _failed(folder: Path, *tests: str) -> str | None:
    """Return which of these tests of a folder fails first, in a process of its own."""
    file = folder / "tests.json"
    file.write_text(json.dumps([f"test_room.py::{test}" for test in tests]))
    failed_of(file).unlink(missing_ok=True)
    program = f"from pathlib import Path\nfrom tests.reliability.covering import run\nrun(Path({str(file)!r}))"
    surroundings = {**os.environ, "PYTHONPATH": f"{folder}:{HOUSE}", "PYTHONDONTWRITEBYTECODE": "1"}
    subprocess.run([sys.executable, "-c", program], cwd=folder, env=surroundings, capture_output=True, check=False)
    return failed_of(file).read_text() if failed_of(file).exists() else None
