"""Figures that tests hold below a limit, noted where somebody asks for them."""

from __future__ import annotations

import json
import os
from pathlib import Path

FILE = "AXISCAL_FIGURES"
"""Names the file in the environment."""


def held(what: str, value: float, limit: float, unit: str) -> None:
    """Assert that a figure is at most its limit, and note both."""
    value, limit = float(value), float(limit)
    if file := os.environ.get(FILE):
        test = os.environ["PYTEST_CURRENT_TEST"].partition(" ")[0]
        with Path(file).open("a", encoding="utf-8") as notes:
            notes.write(json.dumps({"what": what, "test": test, "value": value, "limit": limit, "unit": unit}) + "\n")
    assert value <= limit, f"{what}: {value:.4g} {unit} is above {limit:.4g}"
