"""The first lines of every README.txt: what loading the files moves, and what was taken for granted about the axes.

Without rotary axes files add nothing at machine zero, every axis at 0 or at the end of its travel nearest to it, so
what is found there stays. Rotary axes have a place: files then hold the constant that puts the tool right to them.
"""

from __future__ import annotations

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.machine.questions import uncounted
from axiscal.numerics import Array
from axiscal.units import format_quantity, to_unit


def foreword(estimate: Estimate, control: Control) -> tuple[str, ...]:
    """Return the sentences; control : what the files do."""
    machine = estimate.machine
    places = np.stack([np.array(machine.zero), np.mean(np.array(estimate.box), axis=1)])
    moved = to_unit(shifts(machine, control, places), "um")
    at_zero, in_the_middle = (f"{_place(machine, p)} by {_shown(m)}" for p, m in zip(places, moved, strict=True))
    return (
        "ZERO WORK OFFSETS, TOOL SETTER AND PROBE ANEW after loading. The files move the tool relative to the "
        f"workpiece: at machine zero, {at_zero}; in the middle of the volume, {in_the_middle} (both directions' mean).",
        *_unsaid(machine),
    )


def shifts(machine: Machine, control: Control, poses: Array) -> Array:
    """Return how a control moves the tool on the workpiece at poses (m, q), the mean of both directions, (m, 3), m."""
    ways = [np.full(poses.shape, side) for side in (1.0, -1.0)]
    sent = [frames(machine, poses + control(poses, way)).tcp for way in ways]
    moved: Array = (sent[0] + sent[1]) / 2 - frames(machine, poses).tcp
    return moved


def _place(machine: Machine, pose: Array) -> str:
    at = zip(machine.axes, pose, strict=True)
    return " ".join(f"{axis.name} {format_quantity(float(value) + 0.0, axis.unit)}" for axis, value in at)


def _shown(moved: Array) -> str:
    parts = (f"{name} {round(float(value), 1) + 0.0:+.1f}" for name, value in zip("xyz", moved, strict=True))
    return f"{', '.join(parts)} um"


def _unsaid(machine: Machine) -> tuple[str, ...]:
    them = uncounted(machine)
    if not them:
        return ()
    return (
        f"WHICH WAY DO {them} COUNT? machine.toml does not say, and ISO 841 was supposed: counting up, the tool turns "
        "by the right hand about it relative to the workpiece, a table the other way. Turn them by hand and look: "
        "where it is against that (as LinuxCNC's xyzac- and xyzbc-trt-kins are), write in its table direction = "
        '"reversed", else "iso", and evaluate the readings again: with the wrong direction these files make it worse.',
    )
