"""What a control does that knows the chain and every error: rotary axes turn their own error back, linear ones the tip.

Δ_k = -s_k ε_kk of a rotary axis;  [u_x u_y u_z] Δ = -δp without these for the linear axes;  the same once more at
the positions to which the axes are sent
"""

from __future__ import annotations

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.error_model.model import ErrorModel
from axiscal.exceptions import TableError
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array


def whole_control(model: ErrorModel, mean: Array) -> Control:
    """Return the control that takes the deviation of these errors away.  mean : (size,) control values

    Without rotary axes it adds nothing at machine zero, the mean of both directions: a constant is a matter of the
    workpiece's zero. Errors of two axes together are left. Raises TableError when the machine has not three linear axes
    that span space.
    """
    axes = model.machine.axes
    linear = [k for k, axis in enumerate(axes) if not axis.rotary]
    if len(linear) != 3:
        raise TableError(f"the machine has {len(linear)} linear axes", "Volumetric compensation needs three")
    constant = at_zero(model, mean)

    def once(poses: Array, approaches: Array) -> Array:
        values = _values(model, mean, poses, approaches)
        levers, added = model.levers(poses)[: len(model.functions)], np.zeros_like(poses)
        for k, own in _own(model).items():
            added[:, k] = -axes[k].sign * np.sum(axes[k].direction) * values[own].sum(axis=0)
            levers[own] = 0.0
        deviation = np.einsum("fmc,fm->mc", levers, values) - constant
        rotations = frames(model.machine, poses).rotations
        moves = np.stack([rotations[k] @ np.array(axes[k].direction) for k in linear], axis=2)
        added[:, linear] = -np.linalg.solve(moves, deviation[:, :, None])[:, :, 0]
        return added

    return lambda poses, approaches: once(poses + once(poses, approaches), approaches)


def at_zero(model: ErrorModel, mean: Array) -> Array:
    """Return the constant deviation that is not corrected, (3,) m: that at machine zero, none where axes turn."""
    if any(axis.rotary for axis in model.machine.axes):
        return np.zeros(3)
    zero = np.array([model.machine.zero])
    values = _values(model, mean, zero, np.zeros_like(zero))
    deviation: Array = np.einsum("fmc,fm->mc", model.levers(zero)[: len(model.functions)], values)[0]
    return deviation


def _values(model: ErrorModel, mean: Array, poses: Array, approaches: Array) -> Array:
    """Return what every error of one axis is at poses, (functions, m), a reversal by its side."""
    found = []
    for function in model.functions:
        value = function.rows(poses[:, function.axis]) @ mean[function.columns]
        found.append(value * (0.5 * approaches[:, function.axis]) if function.kind == "reversal" else value)
    return np.array(found).reshape(len(model.functions), len(poses))


def _own(model: ErrorModel) -> dict[int, list[int]]:
    """Return the errors by which each rotary axis turns too far about itself."""
    return {
        k: [
            i
            for i, f in enumerate(model.functions)
            if f.axis == k and f.angular and abs(axis.direction[f.component % 3]) > 0.5
        ]
        for k, axis in enumerate(model.machine.axes)
        if axis.rotary
    }
