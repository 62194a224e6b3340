"""What the program must not load before it is needed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import axiscal

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
