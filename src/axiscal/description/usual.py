"""What usually goes wrong, the sizes that readings may teach, and a machine with its sizes as learnt.

One table has a row for each cause. A new one takes a row and a kind here, its columns in `estimation/promise/passing`,
which `planning/plan/order` turns against each other, and its words in `present/findings`.

Given the logarithms θ of the sizes all causes are Gaussian, y ~ N(0, K(θ)) with K(θ) = Σ_c s_c(θ)² B_c. A size is the
default, or what somebody stated, times exp(θ). It is log-normal, with all its moments:

    θ = f (x − x₀),    x ~ N(0, 1),    f the logarithm of the row's factor

What is stated is the median of a size, x₀ = 0. Of a reversal and of what passes it is the root mean square, x₀ = f:
E exp 2θ = exp(2 f² − 2 f x₀) = 1. So a size that no reading teaches adds the variance that is stated.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.entry import ErrorEntry, PlaneEntry, Sure, side_name
from axiscal.machine.kinematics import frames
from axiscal.measurement.setup import Setup
from axiscal_core.left_out import OFF
from axiscal_core.theta import SURE, Kind, Size, Sizes


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


SMOOTH = Cause(
    "error, smooth", "Matérn-5/2 by a spline on knots", 1.0, "std as stated", SURE["roughly"],
    "learnt over stated std: 1.05, 1.35, 1.61 at 16, 50, 84 % of 38 measured curves",
)  # fmt: skip
LENGTH = Cause(
    "length of an error", "-", 1.0, "length as stated", 2.5,
    "0.09, 0.25, 0.76 of the travel at 16, 50, 84 % of the same curves",
)  # fmt: skip
SCALE = Cause(
    "scale of a linear axis", "coordinate", 30e-6, "um/m", 3.0,
    "a ground screw of class C5 has 23 um in 300 mm, two kelvins are 23 um/m",
)  # fmt: skip
ROUGH = Cause(
    "error, rough", "cells of 2 % of the travel, half of the variance in cells of 6 %", 0.045,
    "std of the error", 5.0, "0.048, 0.085, 0.20 of the same curves; maps 0.066, 0.096, 0.13; screws of controls 0.005",
)  # fmt: skip
"""Ground guides and screws have a tenth of what cast beds and mirrors have: hence the factor."""
REST = Cause(
    "rest", "white", 0.03, "std of the error", 4.0, "0.018, 0.030, 0.067 of the same curves",
)  # fmt: skip
REVERSAL = Cause("reversal", "constant", 1.0, "std as stated", 3.0, "as the errors' own factor")
"""The factor is that of errors; nobody has measured another."""
WAY = Cause(
    "reversal that needs a way", "side times exp(-d/l), d the way since the axis turned, l of 30, 100 and 350 mm", 0.06,
    "std of the reversal", 6.0, "assumption",
)  # fmt: skip
"""Assumption: a slide winds up like a spring over a hand's breadth: little of most backlashes, and most of some."""
PITCH = Cause("pitch", "one sine for each stated period", 0.02, "std of the error", 4.0, "assumption")
"""Assumption: a fiftieth of the error."""
TOGETHER = Cause(
    "two linear axes together", "product of Matérn-5/2, 0.3 of each travel", 0.15,
    "larger std of both axes' errors", 6.0, "14 beds and plates: a fifth less is missed than with 3.0 and half",
)  # fmt: skip
DRIFT = Cause(
    "drift of a zero", "linear and Brownian in time", 2.0, "noise, each over the set-up's time", 4.0,
    "nine ISO 230-2 tests: spread of run means over noise 0.9 to 12, median 2",
)  # fmt: skip
CYCLE = Cause("cycle of a zero", "Matérn-1/2 in time, 6 min", 0.5, "noise", 4.0, "assumption")
"""Assumption: an air conditioning that switches every six minutes moves a zero by half the noise."""
GROWTH = Cause(
    "growth of an axis meanwhile", "coordinate times Matérn-3/2 in time, 0.4 of the set-up's time", 2.0,
    "noise per travel", 4.0, "slopes of ISO 230-2 runs 0.4 to 1.9 noise",
)  # fmt: skip
OFFSET = Cause(
    "offset from the line that was read", "distance times pitch and yaw that are not described", 20e-6, "rad", 1.0,
    "a third of the 60 urad that ISO 10791-2 allows (remembered, not from its text)",
)  # fmt: skip
ANGLE = Cause(
    "angle beside the tool point", "as an error, where none is described", OFFSET.size, "rad", SURE["roughly"],
    "as for the offset from the line",
)  # fmt: skip
ANGLE_OF_PRINTER = Cause(
    "angle of a printer beside the nozzle", "as an error, where none is described", 1.5e-3, "rad", SURE["roughly"],
    "six published twists of X: 0.03 to 0.34 mm at some 35 mm, so 1 to 10 mrad from end to end",
)  # fmt: skip
NOISE = Cause("noise", "white", 1.0, "noise as stated", 2.0, "seating again scatters 3 to 7 still noises")
"""Factor: a stated noise is rarely off by more, and repeats tell it."""
BAD = Cause(
    "bad reading", "one reading", OFF, "noise", 1.0, "assumption: 1 of 100 readings",
)  # fmt: skip


NONE_VARY = Sizes(())
"""All sizes are as stated."""


_NO_LEVER = 1e-6
"""m: rounding."""
LENGTH_OF_TRAVEL = 0.25
"""Of the travel: the length of an error of which none is stated."""
_TOGETHER_KNOTS, _TOGETHER_LENGTH = 5, 0.3
"""Knots, and length as a share of the travel, along each side of what two axes do together."""


def usual_machine(machine: Machine, setups: Sequence[Setup], printer: bool = False) -> Machine:
    """Return the machine with what usually goes wrong in it.

    Each curve has its usual length and its rough part; each stated period has a wave. Two linear axes that move in one
    set-up have an error of both together. Angles that an instrument beside the tool point sees are there.

    printer : its axes are those of a 3D printer
    """
    angles = (ErrorEntry(name, (ANGLE_OF_PRINTER if printer else ANGLE).size) for name in _angles(machine, setups))
    errors = [_as_usual(entry, machine.axis(entry.axis)) for entry in (*machine.errors, *angles)]
    stated = {entry.name for entry in errors}
    waves = [wave for entry in errors for wave in _wave(entry) if wave.name not in stated]
    planes = [replace(entry, rest=_usual_rest(entry), rest_estimated=False) for entry in machine.planes]
    known = {frozenset((entry.component, *entry.axes)) for entry in planes}
    together = [plane for plane in _together(machine, setups) if frozenset((plane.component, *plane.axes)) not in known]
    return replace(machine, errors=(*errors, *waves), planes=(*planes, *together))


def _angles(machine: Machine, setups: Sequence[Setup]) -> list[str]:
    """Return the angles of linear axes that set-ups beside the tool point see, and that are not described."""
    found = dict[str, None]()
    for setup in setups:
        at = frames(machine, np.array([setup.park]))
        arm = at.tool[0] @ np.array(setup.offset or (0.0, 0.0, 0.0))
        for axis in (k for k in setup.moves if not machine.axes[k].rotary):
            levers = np.cross(at.rotations[axis, 0].T, arm) @ np.array(setup.direction)
            names = (f"E{letter}{machine.axes[axis].name}" for letter in "ABC")
            found |= {name: None for name, lever in zip(names, levers, strict=True) if abs(lever) > _NO_LEVER}
    stated = {entry.name for entry in machine.errors}
    return [name for name in found if name not in stated]


def _wave(entry: ErrorEntry) -> Iterator[ErrorEntry]:
    """Yield the wave of a screw, scale or rack whose period is stated with the curve."""
    if entry.period is not None and entry.kind == "motion" and not entry.harmonics:
        yield ErrorEntry(f"{entry.name}_pitch", PITCH.size * entry.std, period=entry.period, harmonics=1)


def _together(machine: Machine, setups: Sequence[Setup]) -> Iterator[PlaneEntry]:
    """Yield what pairs of linear axes do together that move in one set-up.

    Machines with rotary axes yield none: it would add half as many unknowns again.
    """
    if any(axis.rotary for axis in machine.axes):
        return
    pairs = dict.fromkeys(pair for setup in setups for pair in combinations(setup.moves, 2))
    stds = {entry.name: entry.std for entry in machine.errors if entry.kind == "motion"}
    for pair in pairs:
        axes = [machine.axes[k] for k in pair]
        for component in range(3):
            names = [side_name(component, axis.name) for axis in axes]
            std = max((stds[name] for name in names if name in stds), default=0.0)
            if std:
                sides = [
                    ErrorEntry(name, 1.0, knots=_TOGETHER_KNOTS, length=_TOGETHER_LENGTH * axis.length)
                    for name, axis in zip(names, axes, strict=True)
                ]
                name = f"{side_name(component, axes[0].name)}{axes[1].name}"
                yield PlaneEntry(name, component, TOGETHER.size * std, (sides[0], sides[1]), usual=True)


def _as_usual(entry: ErrorEntry, axis: Axis) -> ErrorEntry:
    if entry.constant or entry.harmonics or entry.joints:
        return entry
    if entry.scale is None and not axis.rotary and entry.name == axis.positioning_error:
        entry = replace(entry, scale=SCALE.size)
    if entry.length is None:
        knots = entry.knot_count(axis)  # as they are: a length alone would ask for others
        entry = replace(entry, length=LENGTH_OF_TRAVEL * axis.length, knots=knots, spacing=None)
    return replace(entry, rest=_usual_rest(entry), rest_estimated=False)


def _usual_rest(entry: ErrorEntry | PlaneEntry) -> float:
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
        turning = tuple(entry.name for entry in machine.errors if needs_a_way(entry.kind, machine.axis(entry.axis)))
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
        for entry in machine.errors:
            key, factor = _alike(entry, kind, machine), min(SURE[entry.sure or sure], most)
            if key is not None and factor > 1:
                groups.setdefault((factor, key), []).append(entry.name)
        for (factor, _), names in groups.items():
            yield Size(kind, tuple(names), float(np.log(factor)))
    if machine.planes and sure != "exactly":
        yield Size("together", tuple(entry.name for entry in machine.planes), TOGETHER.spread)
        if stated := tuple(entry.name for entry in machine.planes if not entry.usual and entry.std):
            yield Size("length", stated, LENGTH.spread)


def _alike(entry: ErrorEntry, kind: Kind, machine: Machine) -> tuple[bool, ...] | None:
    """Return what errors have in common that share a size of a kind; None where an error has no such size."""
    rotary = machine.axis(entry.axis).rotary
    if entry.kind != ("reversal" if kind == "reversal" else "motion"):
        return None
    if kind == "scale":
        return (rotary,) if entry.scale else None
    if kind == "length":
        return (rotary,) if entry.length is not None else None
    return (rotary, entry.parts.angular, entry.harmonics > 0)


def _rests(machine: Machine, usual: bool) -> list[tuple[str, ...]]:
    """Return the names of errors that share the size of their rough part: all with usual causes, else some."""
    groups = dict[bool, list[str]]()
    for entry in machine.errors:
        if entry.first_rest > 0 and (usual or entry.rest_estimated):
            groups.setdefault(machine.axis(entry.axis).rotary, []).append(entry.name)
    planes = [entry.name for entry in machine.planes if entry.first_rest > 0 and (usual or entry.rest_estimated)]
    return [tuple(names) for names in (*groups.values(), planes) if names]


def rescaled_machine(machine: Machine, sizes: Mapping[tuple[Kind, str], float]) -> Machine:
    """Return the machine with its priors at other sizes.  sizes : factors by kind and owner"""
    errors = tuple(_rescaled(entry, machine.axis(entry.axis), sizes) for entry in machine.errors)
    lengths = [sizes.get(("length", entry.name), 1.0) for entry in machine.planes]
    planes = tuple(
        replace(
            entry,
            std=entry.std * sizes.get(("together", entry.name), 1.0),
            rest=entry.first_rest * sizes.get(("rest", entry.name), 1.0),
            stretch=(entry.stretch[0] * length, entry.stretch[1] * length),
        )
        for entry, length in zip(machine.planes, lengths, strict=True)
    )
    return replace(machine, errors=errors, planes=planes)


def _rescaled(entry: ErrorEntry, axis: Axis, sizes: Mapping[tuple[Kind, str], float]) -> ErrorEntry:
    kind: Kind = "reversal" if entry.kind == "reversal" else "std"
    length = None if entry.length is None else entry.length * sizes.get(("length", entry.name), 1.0)
    # The knots stay where they were: a spline does not move because its prior was learnt.
    knots = None if entry.constant else entry.knot_count(axis)
    return replace(
        entry,
        std=entry.std * sizes.get((kind, entry.name), 1.0),
        scale=None if entry.scale is None else entry.scale * sizes.get(("scale", entry.name), 1.0),
        length=length,
        rest=entry.first_rest * sizes.get(("rest", entry.name), 1.0),
        knots=knots,
        spacing=None,
    )
