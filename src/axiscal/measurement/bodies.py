"""What moves and what stands: tool, holder and spindle nose, and the balls with their posts that they keep clear of.

A cylinder of radius r about the stem n lies within the segment between its ends, grown by r √(1 − n_i²) along each
axis i. So it enters a box only where the segment enters the box grown by as much.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from axiscal.measurement.artefact import Artefact
from axiscal.numerics import Array
from axiscal_core.machine import Machine

CLEAR = 5e-3
"""m by which everything keeps clear of a body: it is put down by eye, and a touch goes 4 mm too far."""
_POST = 1.0
"""m: below that much of a post, or of what it stands on, no spindle gets."""
_SQUARE = 1e-9
"""Sine: a post that leans by less stands straight."""


class Cylinder(NamedTuple):
    """A cylinder about the stem.  start, stop : m from the tip towards the spindle; radius : m"""

    start: float
    stop: float
    radius: float


def parts(machine: Machine) -> tuple[Cylinder, ...]:
    """Return what moves, from the tip on: stylus, tool with holder, spindle nose. The first of them is what touches."""
    free = min(machine.nose.reach, machine.tool_length) if machine.nose.stylus > 0 else 0.0
    body = Cylinder(free, machine.tool_length, machine.nose.radius)
    found = (
        [Cylinder(-machine.nose.stylus / 2, free, machine.nose.stylus / 2), body] if machine.nose.stylus > 0 else [body]
    )
    if machine.nose.head:
        wide, high = machine.nose.head
        found.append(Cylinder(machine.tool_length, machine.tool_length + high, wide / 2))
    return tuple(found)


def lever(machine: Machine) -> float:
    """Return how far from the tip the furthest place of what moves is, m."""
    return max(math.hypot(max(abs(part.start), part.stop), part.radius) for part in parts(machine))


def posts(artefact: Artefact) -> tuple[Array, ...]:
    """Return the boxes about each ball and the post below it, as wide as the ball, (n, 3, 2) m each, with what is kept.

    None where nobody says how large the balls are. A post that leans is a row of boxes.
    """
    if artefact.diameter is None:
        return ()
    wide, down = artefact.diameter / 2 + CLEAR, -np.array(artefact.free)
    straight = np.abs(down).max() >= 1.0 - _SQUARE
    edges = np.linspace(0.0, _POST, 2 if straight else 1 + math.ceil(_POST / wide))
    ends = (ball + np.outer(edges, down) for ball in artefact.points)
    pairs = (np.stack([at[:-1], at[1:]], axis=2) for at in ends)
    return tuple(np.stack([pair.min(axis=2) - wide, pair.max(axis=2) + wide], axis=2) for pair in pairs)
