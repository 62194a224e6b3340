"""Every error motion as a table over its own axis, and what a control does that knows the chain: move the TCP back.

An error of two axes together is in the motion of the later one: a table over both, if the format has that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.error_names import side_name
from axiscal.numerics import Array
from axiscal.tables.sampling import hats_along
from axiscal.tables.surface import Control, Mesh, by_linear_axes
from axiscal_core.machine import Machine
from axiscal_core.terms import Term

_POINTS_PER_INTERVAL, _RECORDS = 4, 4000
"""Of a table over two axes: points as of one over one axis, as far as so many lines last."""
_NOTHING = 1e-12
"""m or rad: rounding."""


@dataclass(frozen=True, eq=False, slots=True)
class SampledError:
    """One error at positions (n,) of its axis, m or rad; a constant has one position.

    over, across : another axis that it depends on as well, and positions (k,) of that; values are (k, n) then
    """

    positions: Array
    values: Array
    over: str = ""
    across: Array = field(default_factory=lambda: np.zeros(0))

    def at(self, position: Array, other: Array) -> Array:
        """Return it at positions (m,) of its axis and of the other one: linear between points, constant outside."""
        if self.over:
            return Mesh(self.positions, self.across, self.values).at(position, other)
        return np.interp(position, self.positions, self.values)


def curves(estimate: Estimate, grids: Mapping[int, Array], together: bool = False) -> dict[str, SampledError]:
    """Return the error motions and location errors by name; grids : positions of each axis.

    What repeats with a period and what steps is part of its error motion. Reversal values have no place among them.
    together : a motion may depend on a second axis, so that it holds an error of two axes, the first that there is
    """
    found = dict[str, SampledError]()
    for function in estimate.model.curves:
        control = estimate.mean[function.columns]
        if function.kind == "location":
            found[function.name] = SampledError(np.zeros(1), control)
        elif function.kind == "motion":
            at = grids[function.axis]
            hats = hats_along(estimate, function.axis, at)
            values, name = hats.best(function.spline.rows(hats.nodes) @ control), _name(estimate.model, function)
            found[name] = SampledError(at, values + found[name].values if name in found else values)
    for plane in estimate.model.planes if together else ():
        _take_in(estimate, plane, grids, found)
    return found


def _take_in(estimate: Estimate, plane: Term, grids: Mapping[int, Array], found: dict[str, SampledError]) -> None:
    """Add what two axes do together to the motion of the later one, where that depends on no other axis yet."""
    name, own = _name(estimate.model, plane), plane.axis
    ((other, intervals),) = ((side.axis, len(side.spline.knots) - 1) for side in plane.sides if side.axis != own)
    fit = max(min(_POINTS_PER_INTERVAL * intervals, _RECORDS // len(grids[own]) - 1), intervals)
    across = np.linspace(*estimate.machine.axes[other].travel, fit + 1)
    sides = [hats_along(estimate, axis, at) for axis, at in ((other, across), (own, grids[own]))]
    nodes = np.meshgrid(sides[0].nodes, sides[1].nodes, indexing="ij")
    places = {other: nodes[0].ravel(), own: nodes[1].ravel()}
    rows = plane.rows(*(places[axis] for axis in plane.axes))
    field_of = (rows @ estimate.mean[plane.columns]).reshape(nodes[0].shape)
    values = sides[1].best(sides[0].best(field_of).T).T
    before = found.get(name, SampledError(grids[own], np.zeros(len(grids[own]))))
    if before.over or np.max(np.abs(values)) < _NOTHING:
        return
    found[name] = SampledError(grids[own], before.values + values, estimate.machine.axes[other].name, across)


def anchored(model: Machine, found: Mapping[str, SampledError]) -> dict[str, SampledError]:
    """Return the errors with constants taken off so that the tool stays where it is at machine zero.

    With rotary axes the place of the rotor matters and nothing is taken off. A constant goes into a displacement along
    its direction, the positioning of an axis first; where the machine has none it stays.
    """
    result = dict(found)
    if any(axis.rotary for axis in model.axes):
        return result
    at_zero = _deviation(model, found, np.array([model.zero]))[0]
    for direction, constant in enumerate(at_zero):
        own = [f for f in model.curves if f.kind == "motion" and f.component == direction and _name(model, f) in found]
        for function in sorted(own, key=lambda f: f.name != model.axes[f.axis].positioning_error)[:1]:
            sign, curve = model.axes[function.axis].sign, found[_name(model, function)]
            result[_name(model, function)] = replace(curve, values=curve.values - sign * constant)
    return result


def tip_control(model: Machine, found: Mapping[str, SampledError]) -> Control:
    """Return the control that takes the TCP deviation of these errors away with its linear axes.

    Raises TableError when the machine has not three linear axes that span space.
    """
    taken = by_linear_axes(model)
    return lambda poses, approaches: taken(poses, _deviation(model, found, poses))


def _deviation(model: Machine, found: Mapping[str, SampledError], poses: Array) -> Array:
    """Return what the errors do to the TCP, (m, 3), m."""
    named = {_name(model, term): i for i, term in reversed([*enumerate(model.terms)]) if term.kind != "reversal"}
    chosen = {name: named[name] for name in found if name in named}
    values = []
    for name, index in chosen.items():
        other = model.index(found[name].over) if found[name].over else model.terms[index].axis
        values.append(found[name].at(poses[:, model.terms[index].axis], poses[:, other]))
    deviation: Array = np.einsum("fmc,fm->mc", model.levers(poses)[list(chosen.values())], np.stack(values))
    return deviation


def _name(model: Machine, term: Term) -> str:
    """Return the name of the error motion that a term is, or is part of: of two axes that of the later one."""
    own = side_name(term.component, model.axes[term.axis].name)
    return own if term.kind == "motion" else term.name
