"""From an estimate to a file of the component: every curve as the cubics that it is, on all knots of its axis.

A file of the component, read as the component reads it, from the layout of the file and not from the writer.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from axiscal.document.ports import templates
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.axis import letter_direction
from axiscal.numerics import Array
from axiscal.tables.exporter import Draft, Exporter, ExportOptions, Written
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.offer import spread_poses
from axiscal.tables.vcomp_applying import (
    KNOTS,
    MOTIONS,
    VcompAxis,
    VcompFile,
    at_zero,
    component_control,
    fnv1a,
    whole_control,
)
from axiscal.units import to_unit
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine
from axiscal_core.terms import Term

_FORM = "axiscal-vcomp 1"
_AGAIN = "export it again; nothing in it may be changed"
_NOTHING = 1e-12
"""m or rad: rounding."""


def read(text: str, name: str = "axiscal.vcomp") -> VcompFile:
    """Return what a file holds; raises TableError where its checksum, or its form, is another.

    The checksum guards all that `text_of` wrote; what else a file must not hold the component says when it is loaded.
    """
    body, _, end = text.rpartition("end ")
    if end != f"{fnv1a(body.encode()):08x}\n":
        raise TableError("the checksum is wrong: the file was changed", _AGAIN, name)
    lines = _Lines(line.split(" ") for line in body.splitlines() if not line.startswith("#"))
    try:
        lines.after(_FORM)
        (campaign,), (unit,) = lines.after("campaign"), lines.after("units")
        limit, limit_deg = lines.numbers("limits").tolist()
        tool, (count,) = lines.numbers("tool"), lines.after("axes")
        axes = tuple(_axis(lines) for _ in range(int(count)))
        return VcompFile(campaign, unit, limit, limit_deg, tool, axes)
    except (ValueError, LookupError):
        raise TableError("this is no file of the form {form}", _AGAIN, name, form=_FORM) from None


class VolumetricFormat(Exporter):
    """A control that knows the chain and reads one such file.

    step : m or rad, that digits and rounds of it may leave of any axis
    """

    tried = True
    step: ClassVar[float]

    @abstractmethod
    def seconds(self, estimate: Estimate) -> list[float]:
        """Return how long the reversal of each axis takes, s."""

    @abstractmethod
    def write(self, file: VcompFile) -> Written:
        """Return the files that hold it."""

    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files; raises TableError."""
        machine, wanted = estimate.machine, whole_control(estimate.machine, estimate.mean)
        poses, _ = spread_poses(estimate)
        largest = np.max([np.abs(wanted(poses, way * np.ones_like(poses))) for way in (1.0, -1.0)], axis=(0, 1))
        if np.max(largest) <= _NOTHING:
            return Draft({}, {}, (), self.holds, self.left_out, control=wanted, wanted=wanted)
        numbers, unit = options.joints(machine), options.unit_of(machine) if "--unit" in self.takes else "mm"
        given = [(numbers[axis.name], own) for axis, own in zip(machine.axes, self.seconds(estimate), strict=True)]
        written = self.write(content_of(estimate, given, unit, largest, options.origin))
        steps = {axis.name: self.step for axis in machine.axes}
        return self.draft(replace(written, steps=steps), wanted, machine, options)

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the control makes of files that are called .vcomp; raises TableError where none is."""
        own = [read(file.text, file.name) for file in files if file.name.lower().endswith(".vcomp")]
        if not own:
            names = ", ".join(dict.fromkeys(file.name for file in files))
            raise TableError("{names} is no file of the whole correction", "give axiscal.vcomp", names=names)
        return Loaded(others=tuple(component_control(each, machine) for each in own))


class _Lines:
    """The lines of a file that are no comment, one after the other; raises ValueError for another than is expected."""

    def __init__(self, rest: Iterator[list[str]]) -> None:
        self._rest = rest

    def after(self, key: str) -> list[str]:
        """Return the words behind the key of the next line."""
        words, wanted = next(self._rest, []), key.split(" ")
        if words[: len(wanted)] != wanted:
            raise ValueError(f"a line {key} is expected")
        return words[len(wanted) :]

    def numbers(self, key: str = "") -> Array:
        """Return the numbers of the next line."""
        return np.array([float(word) for word in (self.after(key) if key else next(self._rest, []))])


def _axis(lines: _Lines) -> VcompAxis:
    name, along, _, rotary, _, side, _, sense, _, *joints = lines.after("axis")
    origin, place, tilt = (lines.numbers(key) for key in ("origin", "location", "travel-tilt"))
    count, _, cyclic, _, reverses, seconds = lines.after("knots")
    knots, curves = _curves(lines, int(count), 2 * MOTIONS if reverses == "1" else MOTIONS)
    return VcompAxis(
        name,
        "xyz".index(along),
        rotary == "1",
        int(side),
        int(sense),
        tuple(int(joint) for joint in joints if joint != "-1"),
        origin,
        place,
        tilt,
        cyclic == "1",
        float(seconds),
        knots,
        curves[:, :MOTIONS],
        curves[:, MOTIONS:],
    )


def _curves(lines: _Lines, count: int, curves: int) -> tuple[Array, Array]:
    """Return the knots (n,) and the coefficients (n - 1, curves, 4); the last knot has none."""
    knots, found = np.empty(count), np.empty((count - 1, curves, 4))
    for i in range(count):
        (knots[i],) = lines.numbers("knot")
        if i < count - 1:
            found[i] = [lines.numbers() for _ in range(curves)]
    return knots, found


_MARGIN, _LEAST = 1.5, 5e-6
"""Share and m or rad beyond the largest correction over the volume at which a control refuses it."""
_APART = 1e-9
"""Share of the travel: knots nearer than this are one, by rounding."""


def content_of(
    estimate: Estimate, given: Sequence[tuple[Sequence[int], float]], unit: str, largest: Array, origin: str
) -> VcompFile:
    """Return the file of an estimate; raises TableError for what it cannot hold.

    given : joints of each axis, and how long its reversal takes, s; unit : mm or in
    largest : (q,) m or rad, that each axis is corrected by; origin : hash of the record
    """
    model, mean, axes = estimate.machine, estimate.mean, estimate.machine.axes
    own = [axis_content(model, mean, k, joints, unit, seconds) for k, (joints, seconds) in enumerate(given)]
    turning = [axis.rotary for axis in axes]
    if not any(turning):
        own = list(anchored(own, to_unit(1.0, unit) * at_zero(model, mean)))
    furthest = max(_MARGIN * float(np.max(largest[~np.array(turning)])), _LEAST)
    turned = max(_MARGIN * float(np.max(largest[turning], initial=0.0)), _LEAST)
    tool = np.array([0.0, 0.0, -to_unit(model.tool_length, unit)])
    limits = float(to_unit(furthest, unit)), float(to_unit(turned, "deg"))
    return VcompFile(origin[:16] or "none", {"mm": "mm", "in": "inch"}[unit], *limits, tool, tuple(own))


def axis_content(
    model: Machine, mean: Array, index: int, joints: Sequence[int], unit: str, seconds: float
) -> VcompAxis:
    """Return one axis.  mean : (size,) control values; unit : mm or in; seconds : that a reversal takes

    Raises TableError for an axis that the file cannot hold.
    """
    axis = model.axes[index]
    _refuse_axis(axis, joints)
    own = [function for function in model.curves if function.axis == index]
    per_m, at = float(to_unit(1.0, unit)), float(to_unit(1.0, "deg" if axis.rotary else unit))
    scale = np.array([per_m] * 3 + [1.0] * 3)
    place, sense = np.zeros(MOTIONS), -1 if axis.reversed else 1
    for function in own:
        if function.kind == "location":
            place[function.component] += mean[function.columns][0]
    knots = _knots(axis, own)
    kinds = [[f for f in own if f.kind == kind] for kind in ("motion", "reversal")]
    motions, reversals = (_cubics(functions, mean, knots, sense, at) * scale[:, None] for functions in kinds)
    straight = not axis.rotary
    return VcompAxis(
        axis.name,
        letter_direction(axis.letter),
        axis.rotary,
        axis.sign,
        sense,
        tuple(joints),
        np.array(axis.origin) * per_m * axis.rotary,
        np.zeros(MOTIONS) if straight else place * scale,
        place[3:] if straight else np.zeros(3),
        axis.cyclic,
        seconds,
        np.sort(sense * knots * at),
        motions,
        sense * reversals if kinds[1] else np.zeros((len(knots) - 1, 0, 4)),
    )


def text_of(file: VcompFile, statement: str) -> str:
    """Return the file as text, with its checksum.  statement : of what it is not, for whoever looks into it"""
    rendering = templates("axiscal.tables", row=_row).get_template("vcomp.jinja")
    body = rendering.render(form=_FORM, file=file, statement=statement)
    return f"{body}end {fnv1a(body.encode()):08x}\n"


def _row(numbers: Array | Sequence[float]) -> str:
    return " ".join(f"{float(number) + 0.0:.12g}" for number in numbers)


def _refuse_axis(axis: Axis, joints: Sequence[int]) -> None:
    if len(axis.name) != 1:
        raise TableError("LinuxCNC has no axis {axis}", "Its axes are X Y Z A B C U V W", axis=axis.name)
    if len(joints) > 2:
        remedy = "The component takes two for an axis"
        raise TableError("{axis} has {count} joints", remedy, axis=axis.name, count=len(joints))


def _knots(axis: Axis, own: Sequence[Term]) -> Array:
    """Return the union of the knots of all curves of an axis, m or rad, ends of the travel included."""
    both = np.sort(np.concatenate([np.array(axis.travel), *(f.spline.knots for f in own if f.kind != "location")]))
    knots = both[np.r_[True, np.diff(both) > _APART * axis.length]]
    if len(knots) > KNOTS:
        what = "the curves of {axis} have {count} knots together, the component holds {most}"
        remedy = "describe them with fewer, or with the same knots, and evaluate the readings again"
        raise TableError(what, remedy, axis=axis.name, count=len(knots), most=KNOTS)
    return knots


def _cubics(functions: Sequence[Term], mean: Array, knots: Array, sense: int, at: float) -> Array:
    """Return a b c d (n - 1, 6, 4) from each knot on, by position.  at : units of position in a metre or radian

    Value and derivatives in the middle give a cubic: no rounding of a knot leads to its neighbour there. An axis that
    counts the other way is mirrored.
    """
    middle, half = (knots[1:] + knots[:-1]) / 2, np.diff(knots) / 2
    total = np.zeros((len(middle), MOTIONS, 4))
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


def anchored(axes: Sequence[VcompAxis], constant: Array) -> tuple[VcompAxis, ...]:
    """Return the axes with a constant deviation (3,) taken off, as a displacement of the last one."""
    last = axes[-1]
    place = last.place.copy()
    place[:3] -= last.side * constant
    return *axes[:-1], replace(last, place=place)
