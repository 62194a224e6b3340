"""A machine as it usually is, where set-ups see more than is stated of it; and with its sizes as learnt."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from axiscal.machine.error_names import side_name
from axiscal.measurement.setup import Setup
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from axiscal_core.theta import Kind
from axiscal_core.usual import ANGLE, ANGLE_OF_PRINTER, TOGETHER, Built, as_usual

_NO_LEVER = 1e-6
"""m: rounding."""
_TOGETHER_KNOTS, _TOGETHER_LENGTH = 5, 0.3
"""Knots, and length as a share of the travel, along each side of what two axes do together."""


def usual_machine(machine: Built, setups: Sequence[Setup], printer: bool = False) -> Built:
    """Return the machine with what usually goes wrong in it.

    Each curve has its usual length and its rough part; each stated period has a wave. Two linear axes that move in one
    set-up have an error of both together. Angles that an instrument beside the tool point sees are there.

    printer : its axes are those of a 3D printer
    """
    size = (ANGLE_OF_PRINTER if printer else ANGLE).size
    angles = (Error(name, size) for name in _angles(machine, setups))
    found = as_usual(replace(machine, errors=(*machine.errors, *angles)))
    return replace(found, errors=(*found.errors, *_together(machine, setups)))


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


def _together(machine: Machine, setups: Sequence[Setup]) -> Iterator[Error]:
    """Yield what pairs of linear axes do together that move in one set-up, where nobody stated it.

    Machines with rotary axes yield none: it would add half as many unknowns again.
    """
    if any(axis.rotary for axis in machine.axes):
        return
    pairs = dict.fromkeys(pair for setup in setups for pair in combinations(setup.moves, 2))
    stds = {entry.name: entry.std for entry in machine.stated if entry.kind == "motion" and not entry.sides}
    stated = {entry.name for entry in machine.stated}
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
