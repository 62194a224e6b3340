"""What a reading shall make small: J(C) = tr(W C), with W in factorised form W = Vᵀ V."""

from __future__ import annotations

from typing import Literal

import numpy as np

from axiscal.belief import Belief
from axiscal.error_model.model import ErrorFunction, ErrorModel
from axiscal.error_model.volume import VolumeMoments
from axiscal.numerics import Array

CriterionName = Literal["volume", "joint", "worst"]
_ROUNDING = 1e-15


def weight_root(weight: Array) -> Array:
    """Return V (r, n) with W = VᵀV for a positive semidefinite weight (n, n) of any rank."""
    values, vectors = np.linalg.eigh(weight)
    kept = values > _ROUNDING * values[-1]
    result: Array = (vectors[:, kept] * np.sqrt(values[kept])).T
    return result


def volume_root(moments: VolumeMoments) -> Array:
    """Return V of the criterion `volume`, W = E[HᵀH]: the mean variance of the TCP deviation over the volume."""
    return weight_root(moments.weight)


def joint_root(model: ErrorModel) -> Array:
    """Return V of the paper's criterion: one Gram matrix per spline (B&H eq. 24-26; several joints B&H eq. 34-36).

    A rotation counts as the displacement it makes at the machine's own reach, half the diagonal of its linear travels.
    """
    weight = np.zeros((model.size, model.size))
    reach = machine_reach(model)
    for function in model.functions:
        scale = reach if function.angular else 1.0
        weight[function.columns, function.columns] = scale**2 * function.basis.gram()
    return weight_root(weight)


def machine_reach(model: ErrorModel) -> float:
    """Return half the diagonal of the linear travels, m; 1 for a machine without linear axes."""
    travels = [axis.length for axis in model.machine.axes if not axis.rotary]
    return float(np.linalg.norm(travels)) / 2 if travels else 1.0


def value(belief: Belief, weight: Array) -> float:
    """Return J = tr(W C) of the leading coefficients.  weight : V (w, n), n at most the belief's size."""
    return float(np.sum((weight @ belief.factor[: weight.shape[1]]) ** 2))


def spline_variance(belief: Belief, function: ErrorFunction) -> float:
    """Return the interval variances of one spline, summed: ∫ var S(t) dt, m² m or the like (B&H eq. 24-26)."""
    factor = belief.factor[function.columns]
    return float(np.sum(function.basis.gram() * (factor @ factor.T)))
