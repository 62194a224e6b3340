"""Each bench that pages name as a script finds what it imports, wherever it is started."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.howtos import DOCS

BENCHES = DOCS.parent / "benchmarks"
OF_OURS = [path for path in sorted(BENCHES.glob("bench_*.py")) if "from benchmarks" in path.read_text(encoding="utf-8")]


@pytest.mark.long
@pytest.mark.parametrize("path", OF_OURS, ids=lambda path: path.stem)
def test_a_bench_that_shares_with_others_finds_them_from_any_folder(path: Path, tmp_path: Path) -> None:
    """As the interpreter starts a script: its own folder is the first that modules are looked for in."""
    start = f"import runpy, sys; sys.path[0] = {str(path.parent)!r}; runpy.run_path({str(path)!r}, run_name='bench')"
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys.executable, "-c", start]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment)
    assert done.returncode == 0, done.stderr


def test_there_are_such() -> None:
    assert len(OF_OURS) >= 5
