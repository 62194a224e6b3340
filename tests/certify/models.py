"""Random models of up to 120 unknowns whose directions differ in information by up to 12 decades, against 80 digits."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from axiscal.estimation.belief import Belief
from axiscal.numerics import Array

LIMIT = 1e-8
_BITS = 270
"""80 decimal digits and a few."""


@dataclass(frozen=True)
class Model:
    """Prior variances (n,), rows (m, n), values (m,), one noise variance, and what is asked of the posterior (p, n)."""

    prior: Array
    rows: Array
    values: Array
    variance: float
    probes: Array


def random_model(rng: np.random.Generator) -> Model:
    """Return a model of 2 to 120 unknowns; the last quarter of the cases' directions may not be read at all."""
    size = int(rng.integers(2, 121))
    decades, unseen = float(rng.uniform(0, 12)), int(rng.integers(0, 1 + size // 4))
    count = size + int(rng.integers(1, 20))
    left, right = (np.linalg.qr(rng.standard_normal((n, size)))[0] for n in (count, size))
    strength = 10 ** (-np.linspace(0, decades / 2, size))
    strength[size - unseen :] = 0.0
    rows = left * strength @ right.T
    prior, variance = 10 ** rng.uniform(-1, 1, size), 10.0 ** -(decades + 2)
    values = rows @ rng.standard_normal(size) + np.sqrt(variance) * rng.standard_normal(count)
    return Model(prior, rows, values, variance, np.vstack([rows[:20], right.T, np.eye(size)]))


def error(model: Model) -> float:
    """Return the worst relative error of a standard deviation or mean (a mean in units of itself or its deviation)."""
    mean, std = exact(model)
    found = Belief(np.zeros(len(model.prior)), np.diag(model.prior))
    seen = found.update(model.rows, model.values, model.variance).predict(model.probes)
    off = np.abs(seen.mean - mean) / np.maximum(np.abs(mean), std)
    return float(max(np.max(np.abs(seen.std / std - 1)), np.max(off)))


def exact(model: Model) -> tuple[Array, Array]:
    """Return mean and standard deviation of the probes by ball arithmetic: C = (P⁻¹ + GᵀG/σ²)⁻¹, m = C Gᵀy/σ²."""
    flint: Any = importlib.import_module("flint")  # untyped
    flint.ctx.prec = _BITS
    try:
        rows, probes = flint.arb_mat(model.rows.tolist()), flint.arb_mat(model.probes.tolist())
        weight = 1 / flint.arb(model.variance)
        information = rows.transpose() * rows * weight
        for i, variance in enumerate(model.prior):
            information[i, i] += 1 / flint.arb(float(variance))
        spread = information.solve(probes.transpose())
        centre = spread.transpose() * (rows.transpose() * flint.arb_mat([[float(v)] for v in model.values]) * weight)
        count = len(model.probes)
        variances = [sum(probes[i, k] * spread[k, i] for k in range(probes.ncols())) for i in range(count)]
        return (
            np.array([float(centre[i, 0].mid()) for i in range(count)]),
            np.array([float(v.sqrt().mid()) for v in variances]),
        )
    finally:
        flint.ctx.prec = 53
