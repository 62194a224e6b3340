"""What usually goes wrong, the sizes that readings may teach, and a machine with its sizes as learnt.

One table, `causes.toml`, has a row for each cause. A new one takes a row there, a kind here, its columns in
`axiscal_core.causes`, which `planning/plan/order` turns against each other, and its words in `present/findings`.

Given the logarithms θ of the sizes all causes are Gaussian, y ~ N(0, K(θ)) with K(θ) = Σ_c s_c(θ)² B_c. A size is the
default, or what somebody stated, times exp(θ). It is log-normal, with all its moments:

    θ = f (x − x₀),    x ~ N(0, 1),    f the logarithm of the row's factor

What is stated is the median of a size, x₀ = 0. Of a reversal and of what passes it is the root mean square, x₀ = f:
E exp 2θ = exp(2 f² − 2 f x₀) = 1. So a size that no reading teaches adds the variance that is stated.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import resources
from itertools import combinations
from typing import TypeVar

import numpy as np

from axiscal.machine.error_names import side_name
from axiscal.measurement.setup import Setup
from axiscal_core.axes import Axis
from axiscal_core.errors import Error
from axiscal_core.left_out import OFF
from axiscal_core.machine import Machine
from axiscal_core.theta import SURE, Kind, Size, Sizes, Sure

Built = TypeVar("Built", bound=Machine)


@dataclass(frozen=True, slots=True)
class Cause:
    """One row of the table.

    name : as reports call it
    kernel : correlation, in words
    size : default standard deviation, in `unit`
    unit : what the default is a multiple of
    factor : one standard deviation of the logarithm of the size is log(factor); 1 for a size that is exact
    source : where the default comes from
    """

    name: str
    kernel: str
    size: float
    unit: str
    factor: float
    source: str

    @property
    def spread(self) -> float:
        """Scale of the logarithm of the size."""
        return math.log(self.factor)


_ROWS = tomllib.loads(resources.files(__package__).joinpath("causes.toml").read_text(encoding="utf-8"))
_CAUSES = {name: Cause(**row) for name, row in _ROWS.items()}
LENGTH, SCALE, ROUGH, REST = map(_CAUSES.__getitem__, ("length", "scale", "rough", "rest"))
REVERSAL, WAY, PITCH, TOGETHER = map(_CAUSES.__getitem__, ("reversal", "way", "pitch", "together"))
DRIFT, CYCLE, GROWTH, NOISE = map(_CAUSES.__getitem__, ("drift", "cycle", "growth", "noise"))
OFFSET, ANGLE, ANGLE_OF_PRINTER = map(_CAUSES.__getitem__, ("offset", "angle", "angle_of_printer"))
BAD = Cause("bad reading", "one reading", OFF, "noise", 1.0, "assumption: 1 of 100 readings")
"""Its size is that of the core."""
NONE_VARY = Sizes(())
"""All sizes are as stated."""


_NO_LEVER = 1e-6
"""m: rounding."""
LENGTH_OF_TRAVEL = 0.25
"""Of the travel: the length of an error of which none is stated."""
_TOGETHER_KNOTS, _TOGETHER_LENGTH = 5, 0.3
"""Knots, and length as a share of the travel, along each side of what two axes do together."""


def usual_machine(machine: Built, setups: Sequence[Setup], printer: bool = False) -> Built:
    """Return the machine with what usually goes wrong in it.

    Each curve has its usual length and its rough part; each stated period has a wave. Two linear axes that move in one
    set-up have an error of both together. Angles that an instrument beside the tool point sees are there.

    printer : its axes are those of a 3D printer
    """
    angles = (Error(name, (ANGLE_OF_PRINTER if printer else ANGLE).size) for name in _angles(machine, setups))
    errors = [_as_usual(entry, machine.axis(entry.axis)) for entry in (*_single(machine), *angles)]
    stated = {entry.name for entry in errors}
    waves = [wave for entry in errors for wave in _wave(entry) if wave.name not in stated]
    planes = [replace(entry, rest=_usual_rest(entry), learnt_rest=False) for entry in _double(machine)]
    return replace(machine, errors=(*errors, *waves, *planes, *_together(machine, setups)))


def _single(machine: Machine) -> list[Error]:
    return [error for error in machine.stated if not error.sides]


def _double(machine: Machine) -> list[Error]:
    return [error for error in machine.stated if error.sides]


def _angles(machine: Machine, setups: Sequence[Setup]) -> list[str]:
    """Return the angles of linear axes that set-ups beside the tool point see, and that are not described."""
    found = dict[str, None]()
    for setup in setups:
        at = machine.frames(np.array([setup.park]))
        arm = at.tool[0] @ np.array(setup.offset or (0.0, 0.0, 0.0))
        for axis in (k for k in setup.moves if not machine.axes[k].rotary):
            levers = np.cross(at.rotations[axis, 0].T, arm) @ np.array(setup.direction)
            names = (f"E{letter}{machine.axes[axis].name}" for letter in "ABC")
            found |= {name: None for name, lever in zip(names, levers, strict=True) if abs(lever) > _NO_LEVER}
    stated = {entry.name for entry in machine.stated}
    return [name for name in found if name not in stated]


def _wave(entry: Error) -> Iterator[Error]:
    """Yield the wave of a screw, scale or rack whose period is stated with the curve."""
    if entry.period is not None and entry.kind == "motion" and not entry.repeats:
        yield Error(f"{entry.name}_pitch", PITCH.size * entry.std, period=entry.period)


def _together(machine: Machine, setups: Sequence[Setup]) -> Iterator[Error]:
    """Yield what pairs of linear axes do together that move in one set-up, where nobody stated it.

    Machines with rotary axes yield none: it would add half as many unknowns again.
    """
    if any(axis.rotary for axis in machine.axes):
        return
    pairs = dict.fromkeys(pair for setup in setups for pair in combinations(setup.moves, 2))
    stds = {entry.name: entry.std for entry in _single(machine) if entry.kind == "motion"}
    stated = {entry.name for entry in _double(machine)}
    for pair in pairs:
        axes = [machine.axes[k] for k in pair]
        for component in range(3):
            names = [side_name(component, axis.name) for axis in axes]
            std = max((stds[name] for name in names if name in stds), default=0.0)
            name, turned = f"{names[0]}{axes[1].name}", f"{names[1]}{axes[0].name}"
            if std and not {name, turned} & stated:
                sides = [
                    Error(name, 1.0, knots=_TOGETHER_KNOTS, length=_TOGETHER_LENGTH * axis.length)
                    for name, axis in zip(names, axes, strict=True)
                ]
                yield Error(name, TOGETHER.size * std, sides=tuple(sides), usual=True)


def _as_usual(entry: Error, axis: Axis) -> Error:
    if entry.count < 2 or entry.repeats or entry.joints:
        return entry
    if entry.scale is None and not axis.rotary and entry.name == axis.positioning_error:
        entry = replace(entry, scale=SCALE.size)
    if entry.length is None:
        entry = replace(entry, length=LENGTH_OF_TRAVEL * axis.length)
    return replace(entry, rest=_usual_rest(entry), learnt_rest=False)


def _usual_rest(entry: Error) -> float:
    """Return the white and the rough part of an error together, m or rad."""
    white = REST.size * entry.std if entry.rest is None else entry.rest
    return float(np.hypot(white, ROUGH.size * entry.std))


def sizes_of(machine: Machine, setups: Sequence[Setup], sure: Sure, *, usual: bool, inherited: bool) -> Sizes:
    """Return the sizes that vary: one factor for errors that are alike.

    sure : how well stated sizes are known where an error does not say; usual : with what usually goes wrong
    inherited : the errors' prior is an earlier campaign's, whose sizes stay
    """
    found = [] if inherited else [*_of_errors(machine, sure)]
    found += [Size("rest", owners, ROUGH.spread) for owners in _rests(machine, usual)]
    names = tuple(setup.name for setup in setups)
    if usual:
        passing: tuple[tuple[Kind, float], ...] = (
            ("drift", DRIFT.spread), ("cycle", CYCLE.spread), ("growth", GROWTH.spread)
        )  # fmt: skip
        found += [Size(kind, names, spread) for kind, spread in passing]
        turning = tuple(entry.name for entry in _single(machine) if needs_a_way(entry.kind, machine.axis(entry.axis)))
        found += [Size("way", turning, WAY.spread)] if turning else []
    elif sure != "exactly":
        wandering = tuple(setup.name for setup in setups if setup.drift > 0)
        found += [Size("drift", wandering, DRIFT.spread)] if wandering else []
    if usual or sure != "exactly":
        found += [Size("noise", (name,), NOISE.spread) for name in names]
    return Sizes(tuple(found))


def needs_a_way(kind: str, axis: Axis) -> bool:
    """Return whether an error of an axis may be complete only some way after the axis has turned."""
    return kind == "reversal" and not axis.rotary


def _of_errors(machine: Machine, sure: Sure) -> Iterator[Size]:
    """Yield the factors on sizes and lengths of errors."""
    kinds: tuple[tuple[Kind, float], ...] = (
        ("std", SURE["roughly"]), ("length", LENGTH.factor), ("scale", SCALE.factor), ("reversal", REVERSAL.factor)
    )  # fmt: skip
    for kind, most in kinds:
        groups = dict[tuple[float, tuple[bool, ...]], list[str]]()
        for entry in _single(machine):
            key, factor = _alike(entry, kind, machine), min(SURE[entry.sure or sure], most)
            if key is not None and factor > 1:
                groups.setdefault((factor, key), []).append(entry.name)
        for (factor, _), names in groups.items():
            yield Size(kind, tuple(names), float(np.log(factor)))
    planes = _double(machine)
    if planes and sure != "exactly":
        yield Size("together", tuple(entry.name for entry in planes), TOGETHER.spread)
        if stated := tuple(entry.name for entry in planes if not entry.usual and entry.std):
            yield Size("length", stated, LENGTH.spread)


def _alike(entry: Error, kind: Kind, machine: Machine) -> tuple[bool, ...] | None:
    """Return what errors have in common that share a size of a kind; None where an error has no such size."""
    rotary = machine.axis(entry.axis).rotary
    if entry.kind != ("reversal" if kind == "reversal" else "motion"):
        return None
    if kind == "scale":
        return (rotary,) if entry.scale else None
    if kind == "length":
        return (rotary,) if entry.length is not None else None
    return (rotary, entry.angular, entry.repeats)


def _rests(machine: Machine, usual: bool) -> list[tuple[str, ...]]:
    """Return the names of errors that share the size of their rough part: all with usual causes, else some."""
    groups = dict[object, list[str]]()
    for entry in machine.stated:
        if entry.first_rest > 0 and (usual or entry.learnt_rest):
            alike = "together" if entry.sides else machine.axis(entry.axis).rotary
            groups.setdefault(alike, []).append(entry.name)
    return [tuple(names) for names in groups.values()]


def rescaled_machine(machine: Built, sizes: Mapping[tuple[Kind, str], float]) -> Built:
    """Return the machine with its priors at other sizes.  sizes : factors by kind and owner"""
    return replace(machine, errors=tuple(_rescaled(each, sizes) for each in machine.stated))


def _rescaled(entry: Error, sizes: Mapping[tuple[Kind, str], float]) -> Error:
    kind: Kind = "together" if entry.sides else "reversal" if entry.kind == "reversal" else "std"
    longer = sizes.get(("length", entry.name), 1.0)
    return replace(
        entry,
        std=entry.std * sizes.get((kind, entry.name), 1.0),
        scale=None if entry.scale is None else entry.scale * sizes.get(("scale", entry.name), 1.0),
        length=None if entry.length is None else entry.length * longer,
        stretch=tuple(each * longer for each in entry.stretch),
        rest=entry.first_rest * sizes.get(("rest", entry.name), 1.0),
        free_knots=False,  # a spline does not move because its prior was learnt
    )
