"""What of a machine moves, as solid cylinders, and how near it comes to posts and boxes: sampled, in no hurry."""

from typing import NamedTuple

import numpy as np

from axiscal.numerics import Array
from tests.generators.kinematics import Chain, stem, tip

_APART = 4e-3
"""m from sample to sample of a post."""


class Solid(NamedTuple):
    """A cylinder about the stem of the tool.  first, last : m from the tip; radius : m"""

    first: float
    last: float
    radius: float


def solids(machine: Chain) -> dict[str, Solid]:
    """Return stylus, holder and nose of a machine, as far as it has them; without a stylus the holder is at the tip."""
    free = min(machine.nose.reach, machine.tool_length) if machine.nose.stylus else 0.0
    found = {"holder": Solid(free, machine.tool_length, machine.nose.radius)}
    if machine.nose.stylus:
        found["stylus"] = Solid(-machine.nose.stylus / 2, free, machine.nose.stylus / 2)
    if machine.nose.head:
        found["nose"] = Solid(machine.tool_length, machine.tool_length + machine.nose.head[1], machine.nose.head[0] / 2)
    return found


def post(ball: Array, down: float) -> Array:
    """Return places on the middle of a post from its ball on, (n, 3) m.  down : how far"""
    steps = np.arange(0.0, down, _APART)
    return np.asarray(ball - steps[:, None] * np.array([0.0, 0.0, 1.0]))


def nearest(tips: Array, stems: Array, solid: Solid, points: Array) -> Array:
    """Return how near a solid cylinder comes to the nearest of some points (n, 3), (m,) m; 0 within.

    tips, stems : (m, 3), of each pose
    """
    away = points - tips[:, None]
    up = np.einsum("mnc,mc->mn", away, stems)
    aside = np.sqrt(np.maximum(np.einsum("mnc,mnc->mn", away, away) - up**2, 0.0)) - solid.radius
    beyond = np.maximum(np.maximum(solid.first - up, up - solid.last), 0.0)
    return np.asarray(np.hypot(beyond, np.maximum(aside, 0.0)).min(axis=1), dtype=np.float64)


def filled(machine: Chain, pose: Array, solid: Solid) -> Array:
    """Return places all over a solid cylinder, (n, 3) m."""
    along = stem(machine, pose)
    first = np.linalg.svd(along[None])[2][1]
    turn, shares = np.linspace(0, 2 * np.pi, 24, endpoint=False), np.linspace(0, 1, 5)
    ring = np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * np.cross(along, first)
    disc = solid.radius * (shares[:, None, None] * ring).reshape(-1, 3)
    heights = np.linspace(solid.first, solid.last, 60)
    points: Array = (tip(machine, pose) + heights[:, None, None] * along + disc).reshape(-1, 3)
    return points
