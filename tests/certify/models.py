"""Random models of up to 120 unknowns whose directions differ in information by up to 12 decades, against 80 digits."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
    once = np.ones(len(model.values), dtype=int)
    mean, std = exact(model.prior, model.rows, model.values, once, model.variance, model.probes)
    found = Belief(np.zeros(len(model.prior)), np.diag(model.prior))
    seen = found.update(model.rows, model.values, model.variance).predict(model.probes)
    off = np.abs(seen.mean - mean) / np.maximum(np.abs(mean), std)
    return float(max(np.max(np.abs(seen.std / std - 1)), np.max(off)))


def exact(
    prior: Array, rows: Array, values: Array, counts: NDArray[np.int_], variance: float, probes: Array
) -> tuple[Array, Array]:
    """Return mean and standard deviation of the probes' rows by ball arithmetic: C = (P⁻¹ + GᵀNG/σ²)⁻¹, m = C GᵀNy/σ².

    prior : (n,) variances; counts : (m,) how often each row was read with that value
    """
    flint: Any = importlib.import_module("flint")  # untyped
    flint.ctx.prec = _BITS
    try:
        g, asked = flint.arb_mat(rows.tolist()), flint.arb_mat(probes.tolist())
        weighted = g.transpose()
        for row, count in enumerate(counts):
            for column in range(len(prior)):
                weighted[column, row] *= flint.arb(int(count)) / flint.arb(variance)
        information = weighted * g
        for i, stated in enumerate(prior):
            information[i, i] += 1 / flint.arb(float(stated))
        spread = information.solve(asked.transpose())
        centre = spread.transpose() * (weighted * flint.arb_mat([[float(v)] for v in values]))
        left = asked * spread
        return (
            np.array([float(centre[i, 0].mid()) for i in range(len(probes))]),
            np.array([float(left[i, i].sqrt().mid()) for i in range(len(probes))]),
        )
    finally:
        flint.ctx.prec = 53
