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
    tests = files_of_tests(PACKAGE / "numerics" / "waves.py")
    assert {"tests/numerics/test_waves.py", "tests/numerics/test_cubic.py"} <= set(tests)
    assert "tests/inference/test_outliers.py" not in tests
    assert "tests/estimation/test_believed.py" in files_of_tests(PACKAGE / "estimation" / "believed.py")


def test_lines_of_a_change_are_those_of_its_statement() -> None:
    source = "if (\n    a\n    and b\n):\n    c = (\n        d\n    )\nelse:\n    e = 1\n"
    lines = [list(statement(ast.parse(source), line)) for line in range(1, 10)]
    assert lines[:4] == [[1, 2, 3, 4]] * 4
    assert lines[4:7] == [[5, 6, 7]] * 3
    assert lines[8] == [9]


def test_a_test_is_known_by_the_lines_that_it_runs_and_fails_on_a_change_of_them(tmp_path: Path) -> None:
    pytest.importorskip("coverage", reason="needs the environment of `make mutants`")
    (tmp_path / "room.py").write_text("def twice(x):\n    return 2 * x\n\n\ndef half(x):\n    return x / 2\n")
    trial = tmp_path / "test_room.py"
    trial.write_text("from room import half, twice\n\n\ndef test_twice():\n    assert twice(3) == 6\n\n\n")
    with trial.open("a") as file:
        file.write("def test_half():\n    assert half(6) == 3\n\n\ndef test_wrong():\n    assert half(6) == 4\n")
    _covering(tmp_path, f"learn([{str(trial)!r}], Path({str(tmp_path)!r}), Path('covered.json'))")
    covered = Covered.read(tmp_path / "covered.json")
    (only,) = covered.tests_of(str(tmp_path / "room.py"), [6])
    assert only.endswith("test_half")
    assert len(covered.tests_of(str(tmp_path / "room.py"), [1])) == 2
    (tmp_path / "tests.json").write_text(json.dumps([only]))
    _covering(tmp_path, "run(Path('tests.json'))")
    assert not failed_of(tmp_path / "tests.json").exists()
    (tmp_path / "room.py").write_text("def twice(x):\n    return 2 * x\n\n\ndef half(x):\n    return x / 3\n")
    _covering(tmp_path, "run(Path('tests.json'))")
    assert failed_of(tmp_path / "tests.json").read_text() == only


def _covering(folder: Path, call: str) -> None:
    """Call a function of `tests.reliability.covering` in a folder, in a process of its own."""
    surroundings = {**os.environ, "PYTHONPATH": f"{folder}:{HOUSE}", "PYTHONDONTWRITEBYTECODE": "1"}
    program = f"from pathlib import Path\nfrom tests.reliability.covering import *\n{call}"
    subprocess.run([sys.executable, "-c", program], cwd=folder, env=surroundings, capture_output=True, check=False)
