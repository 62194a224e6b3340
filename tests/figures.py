"""Figures that tests hold below a limit, shown by `pytest -rP`."""

import sys


def held(what: str, value: float, limit: float, unit: str) -> None:
    """Assert that a figure is at most its limit, and print both."""
    value, limit = float(value), float(limit)
    sys.stdout.write(f"{what}: {value:.2g} of {limit:.3g} {unit}\n")
    assert value <= limit, f"{what}: {value:.4g} {unit} is above {limit:.4g}"
