"""From an estimate to a file of the component: every curve as the cubics that it is, on all knots of its axis.

What a control does with it: rotary axes turn their own error back, linear ones the tip,

    Δ_k = -s_k ε_kk of a rotary axis;  [u_x u_y u_z] Δ = -δp without these for the linear axes

and the same once more at the positions to which the axes are sent. The component's own core is held to that in tests,
over random chains.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import resources
from typing import Any, ClassVar

import numpy as np

from axiscal.document.ports import templates
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.axis import letter_direction
from axiscal.numerics import Array
from axiscal.tables.conditional import taken_by_rotor
from axiscal.tables.exporter import OFF, Exporter, ExportOptions, Written
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.offer import spread_poses
from axiscal.tables.surface import Control, by_linear_axes, spanning_axes
from axiscal.units import from_unit, to_unit
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine
from axiscal_core.terms import Term

CORE = "axiscal_vcomp_core.h"
"""The component's core in C, beside this file: what LinuxCNC's component and grblHAL's plugin include."""
_FORM = "axiscal-vcomp 1"
_KNOTS, _MOTIONS = 96, 6
"""By the component's source: knots of an axis, error motions of an axis."""
_FADE_MM, _FADE_DEG = 5.0, 5.0
"""By the component's source: over so much beyond the last knot a curve's slope fades to nothing."""
_NOTHING = 1e-12
"""m or rad: rounding."""
_MARGIN, _LEAST = 1.5, 5e-6
"""Share and m or rad beyond the largest correction over the volume at which a control refuses it."""
_APART = 1e-9
"""Share of the travel: knots nearer than this are one, by rounding."""


def fnv1a(data: bytes) -> int:
    """Return the 32-bit FNV-1a hash of bytes (Fowler, Noll, Vo): any single changed byte changes it."""
    found = 2166136261
    for byte in data:
        found = (found ^ byte) * 16777619 & 0xFFFFFFFF
    return found


def refuse_changed(text: str, name: str) -> None:
    """Raise TableError where the checksum of a file is another."""
    body, _, end = text.rpartition("end ")
    if end != f"{fnv1a(body.encode()):08x}\n":
        remedy = "export it again; nothing in it may be changed"
        raise TableError("the checksum is wrong: the file was changed", remedy, name)


class VolumetricFormat(Exporter):
    """A control that knows the chain and reads one such file.

    step : m or rad, that digits and rounds of it may leave of any axis; source : package and name of what reads it
    """

    tried = True
    step: ClassVar[float]
    source: ClassVar[tuple[str, str]]

    @abstractmethod
    def seconds(self, estimate: Estimate) -> list[float]:
        """Return how long the reversal of each axis takes, s."""

    @abstractmethod
    def write(self, file: Mapping[str, Any]) -> Written:
        """Return the files that hold it.

        file : campaign, the beginning of its record's hash; unit, mm or inch; limit and limit_deg, the largest
        correction of a linear and of a rotary joint; tool, (3,) from the spindle nose; axes, in chain order, from the
        workpiece to the tool, as `_axis` says them, with how long the reversal takes
        """

    def make(self, estimate: Estimate, options: ExportOptions) -> Written:
        """Return the files; raises TableError for what they cannot hold."""
        machine, mean, wanted = estimate.machine, estimate.mean, whole_control(estimate.machine, estimate.mean)
        poses, _ = spread_poses(estimate)
        largest = np.max([np.abs(wanted(poses, way * np.ones_like(poses))) for way in (1.0, -1.0)], axis=(0, 1))
        if np.max(largest) <= _NOTHING:
            return Written({}, {}, ())
        joints, unit = options.joints(machine), options.unit_of(machine) if "--unit" in self.takes else "mm"
        axes = [_axis(machine, mean, k, joints[axis.name], unit) for k, axis in enumerate(machine.axes)]
        for axis, seconds in zip(axes, self.seconds(estimate), strict=True):
            axis["seconds"] = seconds
        turning = np.array([axis.rotary for axis in machine.axes])
        if not np.any(turning):  # a constant deviation is taken off, as a displacement of the last axis
            axes[-1]["place"][:3] -= axes[-1]["side"] * to_unit(1.0, unit) * _at_zero(machine, mean)
        limits = [max(_MARGIN * float(np.max(largest[own], initial=0.0)), _LEAST) for own in (~turning, turning)]
        file: dict[str, Any] = {
            "campaign": options.origin[:16] or "none",
            "unit": {"mm": "mm", "in": "inch"}[unit],
            "axes": axes,
        }
        file |= {"limit": float(to_unit(limits[0], unit)), "limit_deg": float(to_unit(limits[1], "deg"))}
        written = self.write(file | {"tool": np.array([0.0, 0.0, -to_unit(machine.tool_length, unit)])})
        sources = {name: resources.files(place) / name for place, name in (self.source, ("axiscal.tables", CORE))}
        files = {**written.files, **{name: each.read_text(encoding="ascii") for name, each in sources.items()}}
        steps = {axis.name: self.step for axis in machine.axes}
        known = replace(written, files=files, steps=steps, holds=self.holds, left_out=self.left_out, tried=self.tried)
        return replace(known, control=wanted, wanted=wanted)

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Raise TableError: nothing goes on top of a whole correction."""
        raise TableError("{name} reads no old files", OFF, name=type(self).__name__)


def _axis(model: Machine, mean: Array, index: int, joints: Sequence[int], unit: str) -> dict[str, Any]:
    """Return one axis; positions are those by ISO 841, `sense` times what its joints count.

    mean : (size,) control values; unit : mm or in
    along : 0, 1, 2 for x, y, z; side : 1 tool, -1 workpiece; joints : its numbers, two of a gantry
    origin : (3,) of a rotary axis; place : (6,) location errors; tilt : (3,) rad, of the travel of a linear axis
    knots : (n,); motions : (n - 1, 6, 4), a b c d of x y z and about x y z from each knot on
    reversals : (n - 1, r, 4), r 6 or, where there are none, 0
    Raises TableError for an axis that the file cannot hold.
    """
    axis = model.axes[index]
    if len(axis.name) != 1:
        raise TableError("LinuxCNC has no axis {axis}", "Its axes are X Y Z A B C U V W", axis=axis.name)
    if len(joints) > 2:
        remedy = "The component takes two for an axis"
        raise TableError("{axis} has {count} joints", remedy, axis=axis.name, count=len(joints))
    own = [function for function in model.curves if function.axis == index]
    per_m, at = float(to_unit(1.0, unit)), float(to_unit(1.0, "deg" if axis.rotary else unit))
    scale = np.array([per_m] * 3 + [1.0] * 3)
    place, sense = np.zeros(_MOTIONS), -1 if axis.reversed else 1
    for function in own:
        if function.kind == "location":
            place[function.component] += mean[function.columns][0]
    knots = _knots(axis, own)
    kinds = [[f for f in own if f.kind == kind] for kind in ("motion", "reversal")]
    motions, reversals = (_cubics(functions, mean, knots, sense, at) * scale[:, None] for functions in kinds)
    return {
        "name": axis.name,
        "along": letter_direction(axis.letter),
        "rotary": axis.rotary,
        "side": axis.sign,
        "sense": sense,
        "joints": tuple(joints),
        "origin": np.array(axis.origin) * per_m * axis.rotary,
        "place": place * scale * axis.rotary,
        "tilt": place[3:] * (not axis.rotary),
        "cyclic": axis.cyclic,
        "knots": np.sort(sense * knots * at),
        "motions": motions,
        "reversals": sense * reversals[:, : _MOTIONS * bool(kinds[1])],
    }


def text_of(file: Mapping[str, Any], statement: str) -> str:
    """Return the file as text, with its checksum.  statement : of what it is not, for whoever looks into it"""
    row = {"row": lambda numbers: " ".join(f"{float(number) + 0.0:.12g}" for number in numbers)}
    made = templates("axiscal.tables", **row).get_template("vcomp.jinja")
    body = made.render(form=_FORM, file=file, statement=statement)
    return f"{body}end {fnv1a(body.encode()):08x}\n"


def _knots(axis: Axis, own: Sequence[Term]) -> Array:
    """Return the union of the knots of all curves of an axis, m or rad, ends of the travel included."""
    both = np.sort(np.concatenate([np.array(axis.travel), *(f.spline.knots for f in own if f.kind != "location")]))
    knots = both[np.r_[True, np.diff(both) > _APART * axis.length]]
    if len(knots) > _KNOTS:
        what = "the curves of {axis} have {count} knots together, the component holds {most}"
        remedy = "describe them with fewer, or with the same knots, and evaluate the readings again"
        raise TableError(what, remedy, axis=axis.name, count=len(knots), most=_KNOTS)
    return knots


def _cubics(functions: Sequence[Term], mean: Array, knots: Array, sense: int, at: float) -> Array:
    """Return a b c d (n - 1, 6, 4) from each knot on, by position.  at : units of position in a metre or radian

    Value and derivatives in the middle give a cubic: no rounding of a knot leads to its neighbour there. An axis that
    counts the other way is mirrored.
    """
    middle, half = (knots[1:] + knots[:-1]) / 2, np.diff(knots) / 2
    total = np.zeros((len(middle), _MOTIONS, 4))
    for function in functions:
        control = mean[function.columns]
        f, f1, f2, f3 = (
            sense**order * function.spline.rows(middle, order) @ control / factorial
            for order, factorial in enumerate((1.0, 1.0, 2.0, 6.0))
        )
        h = -half
        total[:, function.component] += np.stack(
            [f + h * (f1 + h * (f2 + h * f3)), f1 + h * (2 * f2 + 3 * h * f3), f2 + 3 * h * f3, f3], axis=1
        )
    return (total if sense > 0 else total[::-1]) / at ** np.arange(4)


def whole_control(model: Machine, mean: Array) -> Control:
    """Return the control that takes the deviation of these errors away.  mean : (size,) control values

    Without rotary axes it adds nothing at machine zero, the mean of both directions: a constant is a matter of the
    workpiece's zero. Errors of two axes together are left, and with two linear axes what leads out of their plane.
    Raises TableError when the machine has not two or three linear axes, each along a direction of its own.
    """
    axes = model.axes
    taken, constant = by_linear_axes(model, spanning_axes(model, fewest=2)), _at_zero(model, mean)

    def once(poses: Array, approaches: Array) -> Array:
        values = _values(model, mean, poses, approaches)
        levers, turned = model.levers(poses)[: len(model.curves)], np.zeros_like(poses)
        for k in (k for k, axis in enumerate(axes) if axis.rotary):
            own = [i for i, f in enumerate(model.curves) if f.axis == k and taken_by_rotor(model, i)]
            turned[:, k] = -axes[k].sign * np.sum(axes[k].direction) * values[own].sum(axis=0)
            levers[own] = 0.0
        return turned + taken(poses, np.einsum("fmc,fm->mc", levers, values) - constant)

    return lambda poses, approaches: once(poses + once(poses, approaches), approaches)


def _at_zero(model: Machine, mean: Array) -> Array:
    """Return the constant deviation that is not corrected, (3,) m: that at machine zero, none where axes turn."""
    if any(axis.rotary for axis in model.axes):
        return np.zeros(3)
    zero = np.array([model.zero])
    values = _values(model, mean, zero, np.zeros_like(zero))
    deviation: Array = np.einsum("fmc,fm->mc", model.levers(zero)[: len(model.curves)], values)[0]
    return deviation


def _values(model: Machine, mean: Array, poses: Array, approaches: Array) -> Array:
    """Return what every error of one axis is at poses, as the component has it, (functions, m); reversals by side.

    Beyond a travel curves go on straight, ever less, until they stay as they are.
    """
    found, reached = [], poses.copy()
    for k, axis in ((k, axis) for k, axis in enumerate(model.axes) if not axis.cyclic):
        fade = from_unit(_FADE_DEG, "deg") if axis.rotary else from_unit(_FADE_MM, "mm")
        inside = np.clip(poses[:, k], *axis.travel)
        beyond = np.clip(poses[:, k] - inside, -fade, fade)
        reached[:, k] = inside + beyond - np.sign(beyond) * beyond**2 / (2 * fade)
    for function in model.curves:
        value = function.rows(reached[:, function.axis]) @ mean[function.columns]
        found.append(value * (0.5 * approaches[:, function.axis]) if function.kind == "reversal" else value)
    return np.array(found).reshape(len(model.curves), len(poses))
