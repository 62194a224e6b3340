"""What somebody believes who knows a machine, and the machine itself: for `drawn_and_known`, or control values."""

from __future__ import annotations

import numpy as np

from axiscal.errors.volume import whole_travel
from axiscal.estimation.belief import Belief
from axiscal.estimation.machine_estimate import Estimate
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal_core.machine import Machine


def sure(mean: Array) -> Belief:
    """Return the belief that control values are these, (n,)."""
    return Belief(mean, 1e-20 * np.eye(len(mean)))


def told(belief: Belief, rows: Array, values: Array, variances: Array | float) -> Belief:
    """Return the belief after readings, one after another.  rows : (m, n); values : (m,)"""
    noise = np.broadcast_to(variances, values.shape)
    return belief.update_many(rows, values, noise, noise, np.arange(len(values))).belief


def known_to_be(model: Machine, mean: Array) -> Estimate:
    """Return what somebody believes over the whole travel who knows the control values, (n,)."""
    return Estimate(model, sure(mean), whole_travel(model))


def truth_of(estimate: Estimate) -> VirtualMachine:
    """Return the machine that is as somebody believes."""
    model, mean = estimate.model, estimate.mean
    curves = tuple((lambda *t, f=f: f.rows(*t) @ mean[f.columns]) for f in model.terms)
    return VirtualMachine(model, curves, {})
