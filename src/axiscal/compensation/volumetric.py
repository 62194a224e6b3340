"""Every error motion as a table over its own axis, and what a control does that knows the chain: move the TCP back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.compensation.hats import Hats
from axiscal.error_model.model import ErrorFunction, ErrorModel
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.kinematics import frames
from axiscal.machine.names import parse_error_name
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class SampledError:
    """One error at positions (n,) of its axis, m or rad; a constant has one position."""

    positions: Array
    values: Array


def curves(estimate: Estimate, grids: Mapping[int, Array]) -> dict[str, SampledError]:
    """Return the error motions and location errors by name; grids : positions of each axis.

    What repeats with a period and what steps is part of its error motion. Reversal values have no place among them.
    """
    found = dict[str, SampledError]()
    for function in estimate.model.functions:
        control = estimate.mean[function.columns]
        if function.kind == "location":
            found[function.name] = SampledError(np.zeros(1), control)
        elif function.kind == "motion":
            at = grids[function.axis]
            closed = estimate.machine.axes[function.axis].cyclic
            hats = Hats.on(at, function.basis.knots, estimate.box[function.axis], closed)
            values, name = hats.best() @ (function.basis.rows(hats.nodes) @ control), _name(function)
            found[name] = SampledError(at, values + found[name].values if name in found else values)
    return found


def anchored(model: ErrorModel, found: Mapping[str, SampledError]) -> dict[str, SampledError]:
    """Return the errors with constants taken off so that the tool stays where it is at machine zero.

    With rotary axes the place of the rotor matters and nothing is taken off. A constant goes into a displacement along
    its direction, the positioning of an axis first; where the machine has none it stays.
    """
    result = dict(found)
    if any(axis.rotary for axis in model.machine.axes):
        return result
    at_zero = _deviation(model, found, np.array([model.machine.zero]))[0]
    for direction, constant in enumerate(at_zero):
        own = [f for f in model.functions if f.kind == "motion" and f.component == direction and _name(f) in found]
        for function in sorted(own, key=lambda f: f.name != model.machine.axes[f.axis].positioning_error)[:1]:
            sign, curve = model.machine.axes[function.axis].sign, found[_name(function)]
            result[_name(function)] = SampledError(curve.positions, curve.values - sign * constant)
    return result


def tip_control(model: ErrorModel, found: Mapping[str, SampledError]) -> Control:
    """Return the control that takes the TCP deviation of these errors away with its linear axes.

    Raises TableError when the machine has not three linear axes that span space.
    """
    linear = [k for k, axis in enumerate(model.machine.axes) if not axis.rotary]
    if len(linear) != 3:
        raise TableError(f"the machine has {len(linear)} linear axes", "volumetric compensation needs three")

    def control(poses: Array, approaches: Array) -> Array:
        deviation = _deviation(model, found, poses)
        rotations = frames(model.machine, poses).rotations
        moves = np.stack([rotations[k] @ np.array(model.machine.axes[k].direction) for k in linear], axis=2)
        added = np.zeros_like(poses)
        added[:, linear] = -np.linalg.solve(moves, deviation[:, :, None])[:, :, 0]
        return added

    return control


def _deviation(model: ErrorModel, found: Mapping[str, SampledError], poses: Array) -> Array:
    """Return what the errors do to the TCP, (m, 3), m."""
    named = {_name(f): i for i, f in enumerate(model.functions) if f.kind != "reversal"}
    chosen = [named[name] for name in found if name in named]
    values = np.stack([_value(model, i, found, poses) for i in chosen])
    deviation: Array = np.einsum("fmc,fm->mc", model.levers(poses)[chosen], values)
    return deviation


def _value(model: ErrorModel, index: int, found: Mapping[str, SampledError], poses: Array) -> Array:
    function = model.functions[index]
    curve = found[_name(function)]
    return np.interp(poses[:, function.axis], curve.positions, curve.values)


def _name(function: ErrorFunction) -> str:
    """Return the name of the error motion that a function is, or is part of."""
    return parse_error_name(function.name).bare
