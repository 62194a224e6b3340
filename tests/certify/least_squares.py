"""NIST's reference regressions through the belief with a flat prior, judged by their correct digits.

Score of NIST's users: log relative error, LRE = -log10 max |found / certified - 1|.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from axiscal.estimation.belief import Belief
from axiscal.numerics import Array

DIGITS = {"longley": 10.0, "wampler1": 9.0, "wampler2": 11.0, "filip": 7.0}
"""Correct digits asked for. NumPy's QR of the readings alone has 10.9, 9.3, 12.6 and about 7."""
FLAT = 1e13
"""Prior standard deviation of what a column adds to the readings, in norms of the readings: any value from 1e12 to
1e16 would do; below, the prior pulls Filip's coefficients, of which the smallest direction is 1e-10 of the largest."""
_DATA = Path(__file__).resolve().parents[1] / "golden" / "nist_strd.json"


def digits(name: str) -> tuple[float, float]:
    """Return the correct digits of coefficients and of their standard deviations (infinite: none certified)."""
    data: dict[str, Any] = json.loads(_DATA.read_text())[name]
    certified, read = np.array(data["certified"], dtype=float), np.array(data["y"], dtype=float)
    rows = _rows(data, len(certified))
    prior = np.diag((FLAT * np.linalg.norm(read) / np.linalg.norm(rows, axis=0)) ** 2)
    ones, order = np.ones(len(read)), np.arange(len(read), dtype=np.intp)
    found = Belief(np.zeros(len(certified)), prior).update_many(rows, read, ones, ones, order).belief
    residual = read - rows @ found.mean
    scale = float(np.sqrt(residual @ residual / (len(read) - len(certified))))
    if "certified_sd" not in data:
        return _correct(found.mean, certified), np.inf
    return _correct(found.mean, certified), _correct(
        scale * np.sqrt(np.diagonal(found.covariance)), np.array(data["certified_sd"])
    )


def _rows(data: dict[str, Any], size: int) -> Array:
    """Return the columns that are stated, or the powers of x."""
    if "columns" in data:
        return np.array(data["columns"], dtype=float).T
    return np.array(data["x"], dtype=float)[:, None] ** np.arange(size)


def _correct(found: Array, certified: Array) -> float:
    return float(-np.log10(max(float(np.max(np.abs(found / certified - 1))), 1e-15)))
