"""What the program must not load before it is needed, and benches that start in any folder."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import axiscal
from tests.docs.howtos import DOCS

STOPPED = """
import sys
wanted = sys.argv[1]
class Stop:
    def find_spec(self, name, path=None, target=None):
        if name == wanted:
            raise KeyboardInterrupt
sys.meta_path.insert(0, Stop())
import axiscal.cli
sys.argv = ["axiscal", "status", "none.axiscal"]
sys.exit(axiscal.cli.main())
"""


@pytest.mark.parametrize("module", ["axiscal.cli.app", "typer", "axiscal.cli.status", "axiscal.campaign.campaign"])
def test_ctrl_c_while_the_program_is_loaded_is_as_clean_as_later(module: str) -> None:
    run = subprocess.run([sys.executable, "-c", STOPPED, module], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout) == (1, "")
    assert run.stderr.startswith("axiscal: Stopped by Ctrl-C")
    assert "Traceback" not in run.stderr


BEFORE = """
import sys
before = set(sys.modules)
import axiscal.cli
print(*(name for name in set(sys.modules) - before if not name.startswith(("axiscal", "importlib"))))
"""


def test_little_is_loaded_before_ctrl_c_is_answered() -> None:
    """Until `main` runs, Ctrl-C ends in a traceback: `typing` and what it loads stood there, most of a start's time."""
    sources = {**os.environ, "PYTHONPATH": str(Path(axiscal.__file__).parents[1])}
    said = subprocess.run(
        [sys.executable, "-S", "-c", BEFORE], env=sources, capture_output=True, text=True, check=True
    ).stdout
    assert set(said.split()) <= {"__future__", "warnings"}


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
    assert len(OF_OURS) >= 4
