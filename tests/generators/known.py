"""What somebody believes who knows a machine, and the machine itself: for `drawn_and_known`, or control values."""

import numpy as np

from axiscal.errors.volume import whole_travel
from axiscal.estimation.machine_estimate import Estimate
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal


def sure(mean: Array) -> Normal:
    """Return the belief that control values are these, (n,)."""
    return Normal(mean, 1e-20 * np.eye(len(mean)))


def known_to_be(model: Machine, mean: Array) -> Estimate:
    """Return what somebody believes over the whole travel who knows the control values, (n,)."""
    return Estimate(model, sure(mean), whole_travel(model))


def truth_of(estimate: Estimate) -> VirtualMachine:
    """Return the machine that is as somebody believes."""
    model, mean = estimate.model, estimate.mean
    curves = tuple((lambda *t, f=f: f.rows(*t) @ mean[f.columns]) for f in model.terms)
    return VirtualMachine(model, curves, {})
