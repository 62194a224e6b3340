"""What docstrings show runs as it says; the package loads quickly, and what it needs is little."""

from __future__ import annotations

import doctest
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import axiscal_core

PACKAGE = Path(axiscal_core.__path__[0])
MODULES = ["axiscal_core", *(f"axiscal_core.{path.stem}" for path in sorted(PACKAGE.glob("[a-z]*.py")))]
SHOWING = 12
LINES = 400


@pytest.mark.parametrize("module", MODULES)
def test_docstrings_run(module: str) -> None:
    assert doctest.testmod(import_module(module)).failed == 0


def test_many_modules_show_what_they_do() -> None:
    finder = doctest.DocTestFinder()
    shown = [module for module in MODULES if any(each.examples for each in finder.find(import_module(module)))]
    assert len(shown) >= SHOWING


def test_loading_takes_no_scipy_and_nothing_of_the_product() -> None:
    """scipy alone takes twice as long to load as all of the rest; it is loaded by the first estimate."""
    say = "import sys, axiscal_core; print(*sorted({name.partition('.')[0] for name in sys.modules}))"
    loaded = subprocess.run([sys.executable, "-c", say], check=True, capture_output=True, text=True).stdout.split()
    assert not {"scipy", "axiscal", "pydantic", "threadpoolctl", "pandas"} & set(loaded)


def test_loading_takes_little_time_beside_numpy() -> None:
    say = "import time, numpy; start = time.process_time(); import axiscal_core; print(time.process_time() - start)"
    program = [sys.executable, "-c", say]
    took = [float(subprocess.run(program, check=True, capture_output=True, text=True).stdout) for _ in range(3)]
    assert min(took) < 0.15


def test_files_stay_small() -> None:
    lengths = {path.name: len(path.read_text(encoding="utf-8").splitlines()) for path in PACKAGE.glob("*.py")}
    assert {name: length for name, length in lengths.items() if length > LINES} == {}
