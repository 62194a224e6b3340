"""The harness for any control: a machine is drawn and known, its files are written, tried, and read once more.

Whoever writes for a control tests it with this, as axiscal tests its own.
"""

from __future__ import annotations

import numpy as np

from axiscal.errors.volume import whole_travel
from axiscal.estimation.machine_estimate import Estimate
from axiscal.tables.exporter import Exporter, ExportOptions
from axiscal.tables.offer import Export, tried_out
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal

_SURE = 1e-20
"""Variance of every control value of a machine that is known, m² or rad²."""


def drawn_and_known(machine: Machine, seed: int = 1) -> Estimate:
    """Return what somebody believes who knows a machine that was drawn from its description."""
    model = machine
    drawn = np.linalg.cholesky(model.covariance()) @ np.random.default_rng(seed).standard_normal(model.size)
    return Estimate(model, Normal(drawn, _SURE * np.eye(model.size)), whole_travel(model))


def round_trip(control: Exporter, estimate: Estimate, options: ExportOptions | None = None) -> Export:
    """Return the files of a control, read back and tried out; raises TableError where they would not correct it."""
    return tried_out(type(control).__name__, estimate, control.make(estimate, options or ExportOptions()))
