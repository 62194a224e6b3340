"""How often the band holds where the display moves in steps: two readings at 13 places of a curve of ten noises."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np

from axiscal.estimation.intervals import Fitted, sites
from axiscal.numerics import Array
from axiscal.numerics.gaussian import lower_root
from axiscal_core.splines import matern

Rule = Literal["ignored", "variance", "interval"]
RULES: tuple[Rule, ...] = ("ignored", "variance", "interval")
STEPS = (1.0, 10.0, 100.0)
_CURVE, _READINGS = 10.0, 26


def held(step: float, machines: int, rule: Rule) -> float:
    """Return the share of curves that the 95 % band holds.  step : of the display, in units of the noise"""
    rng, places = np.random.default_rng(0), np.linspace(0, 1, 41)
    root = _CURVE * lower_root(matern(np.abs(places[:, None] - places) / 0.2) + 1e-9 * np.eye(41))
    at = np.repeat(np.linspace(0, 40, 13).astype(int), 2)
    shares = []
    for _ in range(machines):
        curve = root @ rng.standard_normal(41)
        shown = np.round((curve[at] + rng.standard_normal(_READINGS)) / step) * step
        mean, std = _estimate(root, root[at], *_taken(root[at], shown, step, rule))
        shares.append(np.mean(np.abs(curve - mean) <= 1.96 * std))
    return float(np.mean(shares))


def _taken(rows: Array, shown: Array, step: float, rule: Rule) -> tuple[Array, Array]:
    """Return values and variances as a rule takes what is shown."""
    noise = np.full(_READINGS, 1.0 + (step**2 / 12 if rule != "ignored" else 0.0))
    if rule != "interval":
        return shown, noise
    return sites(Fitted(rows, noise, shown, np.arange(_READINGS)), np.full(_READINGS, step), np.ones(_READINGS))


def _estimate(root: Array, rows: Array, values: Array, noise: Array) -> tuple[Array, Array]:
    covariance = np.linalg.inv(np.eye(len(root)) + (rows.T / noise) @ rows)
    return root @ covariance @ (rows.T @ (values / noise)), np.sqrt(np.diag(root @ covariance @ root.T))


def display_rows(machines: int) -> Iterator[str]:
    """Yield the lines of the table."""
    for step in STEPS:
        yield f"| {step:g} | " + " | ".join(f"{held(step, machines, rule):.1%}" for rule in RULES) + " |"
