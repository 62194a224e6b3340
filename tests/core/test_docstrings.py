"""What docstrings show runs as it says; what the package loads is little."""

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
