"""Solids of a scene: boxes and cylinders, how each is moved, and which of two hides the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from axiscal.numerics import Array

_STRIPS = 40
"""Strips of the side of a cylinder; a matter of taste."""
_TOUCHING = 1e-9
"""m: solids that touch are beside each other."""


class Face(NamedTuple):
    """points : (n, 3) m, in order; normal : (3,) unit vector outwards; edged : whether its outline is drawn"""

    points: Array
    normal: Array
    edged: bool


@dataclass(frozen=True, eq=False, slots=True)
class Solid:
    """A convex solid.

    faces : all of them; paint : name of its colour; opacity : from 0 to 1
    """

    faces: tuple[Face, ...]
    paint: str
    opacity: float = 1.0

    @property
    def points(self) -> Array:
        """All corners, (n, 3) m."""
        return np.vstack([face.points for face in self.faces])

    def moved(self, motion: Array) -> Solid:
        """Return the solid moved by a rigid motion, (4, 4)."""
        turn, shift = motion[:3, :3], motion[:3, 3]
        faces = (Face(face.points @ turn.T + shift, turn @ face.normal, face.edged) for face in self.faces)
        return replace(self, faces=tuple(faces))


def box(low: Sequence[float] | Array, high: Sequence[float] | Array, paint: str, opacity: float = 1.0) -> Solid:
    """Return a box between two opposite corners, m."""
    ends = np.sort(np.array([low, high], dtype=float), axis=0)
    faces = []
    for k in range(3):
        u, v = (k + 1) % 3, (k + 2) % 3
        for side in (0, 1):
            points = np.empty((4, 3))
            points[:, k] = ends[side, k]
            points[:, u], points[:, v] = ends[[0, 1, 1, 0], u], ends[[0, 0, 1, 1], v]
            faces.append(Face(points, (2 * side - 1) * np.eye(3)[k], True))
    return Solid(tuple(faces), paint, opacity)


def cylinder(start: Sequence[float] | Array, end: Sequence[float] | Array, radius: float, paint: str) -> Solid:
    """Return a cylinder from the centre of one end to that of the other, m; its side in flat strips."""
    low, high = np.array(start, dtype=float), np.array(end, dtype=float)
    along = (high - low) / np.linalg.norm(high - low)
    u = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    u /= np.linalg.norm(u)
    angles = np.linspace(0, 2 * np.pi, _STRIPS + 1)
    outward = np.outer(np.cos(angles), u) + np.outer(np.sin(angles), np.cross(along, u))
    ring = radius * outward
    sides = [
        Face(np.array([low + a, low + b, high + b, high + a]), (m + n) / np.linalg.norm(m + n), False)
        for a, b, m, n in zip(ring, ring[1:], outward, outward[1:], strict=False)
    ]
    ends = (Face(low + ring[:-1], -along, True), Face(high + ring[:-1], along, True))
    return Solid((*sides, *ends), paint)


def far_to_near(solids: Sequence[Solid], eye: Array) -> list[Solid]:
    """Return solids so that none hides one that comes after it.  eye : (3,) unit vector towards who looks

    Of two solids with a plane between them the one beyond it is farther. The one whose middle is farther comes first if
    three hide each other in a ring, or two enter each other.
    """
    hidden_by = _hidden_by(solids, eye)
    depth = [float(solid.points.mean(axis=0) @ eye) for solid in solids]
    left, done = set(range(len(solids))), list[Solid]()
    while left:
        free = [k for k in left if not any(k in hidden_by[j] for j in left if j != k)] or list(left)
        first = min(free, key=depth.__getitem__)
        done.append(solids[first])
        left.remove(first)
    return done


def _hidden_by(solids: Sequence[Solid], eye: Array) -> list[set[int]]:
    """Return for each solid those that have to be drawn after it."""
    points = [solid.points for solid in solids]
    normals = [_directions(solid) for solid in solids]
    found: list[set[int]] = [set() for _ in solids]
    for i in range(len(solids)):
        for j in range(i + 1, len(solids)):
            nearer = _nearer(points[i], points[j], np.vstack([normals[i], normals[j]]), eye)
            if nearer > 0:
                found[j].add(i)
            elif nearer < 0:
                found[i].add(j)
    return found


def _directions(solid: Solid) -> Array:
    """Return the directions across its flat faces, (n, 3)."""
    return np.array([face.normal for face in solid.faces if face.edged])


def _nearer(first: Array, second: Array, directions: Array, eye: Array) -> int:
    """Return +1 where the first of two point clouds is nearer by a plane between them, −1 the second, 0 for neither."""
    facing = directions @ eye
    kept = np.abs(facing) > _TOUCHING
    towards = directions[kept] * np.sign(facing[kept])[:, None]
    one, other = first @ towards.T, second @ towards.T
    if np.any(one.min(axis=0) >= other.max(axis=0) - _TOUCHING):
        return 1
    return -1 if np.any(other.min(axis=0) >= one.max(axis=0) - _TOUCHING) else 0
