"""What the program must not load before it is needed: a person waits for every start."""

from __future__ import annotations

import subprocess
import sys

import pytest

HEAVY = ["scipy", "pydantic", "plotly", "jinja2", "rich", "sqlite3"]


@pytest.mark.parametrize("module", ["axiscal", "axiscal.cli"])
def test_start_loads_nothing_heavy(module: str) -> None:
    program = f"import sys, {module}; print([name for name in {HEAVY!r} if name in sys.modules])"
    loaded = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout
    assert loaded.strip() == "[]"
