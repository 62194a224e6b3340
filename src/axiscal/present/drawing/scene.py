"""A scene of solids, lines, arrows and words in metres, drawn as SVG from the front, the right and above.

Solids are boxes and cylinders; of two it is told which hides the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import NamedTuple, Self

import numpy as np

from axiscal.numerics import Array
from axiscal.present.drawing.strokes import (
    FONT,
    Bounds,
    Label,
    Point,
    corners_way,
    covered,
    placed,
    short_number,
    text_safe,
    text_width,
    window,
)

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
    points = [solid.points for solid in solids]
    normals = [np.array([face.normal for face in solid.faces if face.edged]) for solid in solids]
    later = set[tuple[int, int]]()  # of each pair that hides, the nearer one first
    for i, j in combinations(range(len(solids)), 2):
        nearer = _nearer(points[i], points[j], np.vstack([normals[i], normals[j]]), eye)
        later |= {(i, j)} if nearer > 0 else {(j, i)} if nearer < 0 else set()
    left, done = sorted(range(len(solids)), key=lambda k: float(points[k].mean(axis=0) @ eye)), list[Solid]()
    while left:
        first = next((k for k in left if not any((k, j) in later for j in left)), left[0])
        done.append(solids[first])
        left.remove(first)
    return done


def _nearer(first: Array, second: Array, directions: Array, eye: Array) -> int:
    """Return +1 where the first of two point clouds is nearer by a plane between them, −1 the second, 0 for neither."""
    facing = directions @ eye
    kept = np.abs(facing) > _TOUCHING
    towards = directions[kept] * np.sign(facing[kept])[:, None]
    one, other = first @ towards.T, second @ towards.T
    if np.any(one.min(axis=0) >= other.max(axis=0) - _TOUCHING):
        return 1
    return -1 if np.any(other.min(axis=0) >= one.max(axis=0) - _TOUCHING) else 0


_TURN, _LIFT = np.radians(33.0), np.radians(27.0)
"""How far who looks stands to the right of the front, and above the floor, rad; a matter of taste."""
RIGHT: Array = np.array([np.cos(_TURN), np.sin(_TURN), 0.0])
"""Unit vector of the scene that runs to the right in the picture."""
UP: Array = np.array([-np.sin(_TURN) * np.sin(_LIFT), np.cos(_TURN) * np.sin(_LIFT), np.cos(_LIFT)])
"""Unit vector of the scene that runs up in the picture."""
EYE: Array = np.cross(RIGHT, UP)
"""Unit vector towards who looks."""
_DARK = {(0, 1): 0.16, (0, -1): 0.1, (1, 1): 0.12, (1, -1): 0.07, (2, 1): 0.0, (2, -1): 0.22}
"""Share of black on faces that look along a direction, and against it; a matter of taste."""
_HEAD, _HALF_HEAD = 11.0, 4.5
"""Pixels of the head of an arrow; a matter of taste."""
_SHARES = (0.0, -0.5, 0.5, -1.0, 1.0, -1.5, 1.5)
"""Of its length by which an arrow moves out of the way of another, the first that does."""
_MARGIN = 14.0
"""Pixels around what is drawn, for the names of arrows."""


@dataclass(frozen=True, eq=False, slots=True)
class _OverSolids:
    """What lies over all solids.  points : (n, 3) m, or (3,) of what has one place"""

    points: Array

    def moved(self, motion: Array) -> Self:
        """Return the same moved by a rigid motion, (4, 4)."""
        return replace(self, points=self.points @ motion[:3, :3].T + motion[:3, 3])


@dataclass(frozen=True, eq=False, slots=True)
class Stroke(_OverSolids):
    """A line.  width : pixels; filled : colour of what it encloses, "" for none"""

    colour: str
    width: float = 1.5
    dash: str = ""
    opacity: float = 1.0
    filled: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class RoundMark(_OverSolids):
    """A ball.  points : its centre, (3,) m; radius : m; least : radius in pixels below which it does not shrink"""

    radius: float
    colour: str
    least: float = 2.6


@dataclass(frozen=True, eq=False, slots=True)
class Arrow(_OverSolids):
    """A way with a head at its end and a name there.  points : straight where there are two"""

    name: str
    colour: str = "ink"


@dataclass(frozen=True, eq=False, slots=True)
class Caption(_OverSolids):
    """Words beside a place, (3,) m."""

    words: str


Part = Solid | Stroke | RoundMark | Arrow | Caption
Mark = Stroke | RoundMark | Arrow


@dataclass(frozen=True, slots=True)
class Viewport:
    """Frame of a scene, pixels."""

    left: float
    top: float
    width: float
    height: float


def flat(points: Array) -> Array:
    """Return points of a scene as seen, (n, 2) m, right and down.  points : (n, 3) m"""
    return np.stack([points @ RIGHT, -(points @ UP)], axis=1)


@dataclass(frozen=True, eq=False, slots=True)
class Fit:
    """How a scene lies in its frame: pixel = scale · seen + shift."""

    scale: float
    shift: Array

    @classmethod
    def into(cls, points: Array, frame: Viewport) -> Fit:
        """Return the largest way to fit points, (n, 3) m, into a frame."""
        seen = flat(points)
        low, high = seen.min(axis=0), seen.max(axis=0)
        size, room = np.maximum(high - low, 1e-12), np.array([frame.width, frame.height]) - 2 * _MARGIN
        scale = float((room / size).min())
        middle = np.array([frame.left + frame.width / 2, frame.top + frame.height / 2])
        return cls(scale, middle - scale * (low + high) / 2)

    def pixels(self, points: Array) -> Array:
        """Return where points (n, 3) or (3,) m stand, (n, 2)."""
        return flat(np.atleast_2d(points)) * self.scale + self.shift


def points_of(parts: Sequence[Part]) -> Array:
    """Return all points of parts, (n, 3) m."""
    return np.vstack([part.points for part in parts])


def drawn(parts: Sequence[Part], frame: Viewport, within: Array | None = None) -> str:
    """Return a scene as SVG elements, as large as its frame allows; what lies outside of the frame is cut off.

    within : points that fill the frame, (n, 3) m, in place of those of the parts; several scenes get one scale by it
    """
    fitted = Fit.into(points_of(parts) if within is None else within, frame)
    parts = list(_apart(parts, fitted))
    solids = far_to_near([part for part in parts if isinstance(part, Solid)], EYE)
    marks = [part for part in parts if isinstance(part, (Stroke, RoundMark, Arrow))]
    labels = [_label(part, fitted) for part in parts if isinstance(part, (Arrow, Caption))]
    over = [_around(part, fitted) for part in marks if isinstance(part, (Arrow, RoundMark))]
    shown = placed(labels, (frame.left, frame.top, frame.left + frame.width, frame.top + frame.height), over)
    inside = "".join([*(_solid(each, fitted) for each in solids), *(_mark(each, fitted) for each in marks)])
    cut = window(frame.left, frame.top, frame.width, frame.height, inside)
    return cut + "".join(label.svg() for label in shown)


def _solid(solid: Solid, fitted: Fit) -> str:
    """Return the faces that are seen, and their shades over all of them: strips of a round side leave no seams."""
    facing = [(corners_way(fitted.pixels(face.points)) + "z", face) for face in solid.faces if face.normal @ EYE > 1e-9]
    inside, shades = "", ""
    for d, face in facing:
        edge = "edge" if face.edged else solid.paint
        colours = f'fill="var(--{solid.paint})" stroke="var(--{edge})"'
        inside += f'<path d="{d}" {colours} stroke-width=".9" stroke-linejoin="round"/>'
        dark = sum(float(part) ** 2 * _DARK[k, 1 if part > 0 else -1] for k, part in enumerate(face.normal))
        shades += f'<path d="{d}" fill="#000000" fill-opacity="{dark:.3f}"/>' if dark > 5e-3 else ""
    return inside + shades if solid.opacity == 1 else f'<g opacity="{solid.opacity:g}">{inside}{shades}</g>'


def _mark(mark: Mark, fitted: Fit) -> str:
    colour, at = f"var(--{mark.colour})", fitted.pixels(mark.points)
    if isinstance(mark, RoundMark):
        radius = max(mark.radius * fitted.scale, mark.least)
        return (
            f'<circle cx="{short_number(at[0, 0])}" cy="{short_number(at[0, 1])}" r="{short_number(radius)}" '
            f'fill="{colour}" stroke="var(--paper)" stroke-width="1"/>'
        )
    if isinstance(mark, Arrow):
        return _arrow(at, colour)
    dash = f' stroke-dasharray="{mark.dash}"' if mark.dash else ""
    faint = f' stroke-opacity="{mark.opacity:g}"' if mark.opacity != 1 else ""
    inside = f'"var(--{mark.filled})" fill-opacity=".35"' if mark.filled else '"none"'
    return (
        f'<path d="{corners_way(at)}" fill={inside} stroke="{colour}" stroke-width="{mark.width:g}"{dash}{faint} '
        'stroke-linejoin="round" stroke-linecap="round"/>'
    )


def _arrow(at: Array, colour: str) -> str:
    tip, along = at[-1], at[-1] - at[-2]
    along = along / max(float(np.hypot(*along)), 1e-9)
    across, neck = np.array([-along[1], along[0]]), tip - _HEAD * along
    shaft = np.vstack([at[:-1][np.hypot(*(at[:-1] - tip).T) > _HEAD], neck])
    head = corners_way(np.array([tip, neck + _HALF_HEAD * across, neck - _HALF_HEAD * across])) + "z"
    line = f'<path d="{corners_way(shaft)}" fill="none" stroke="{colour}" stroke-width="2.4"/>'
    return f'{line}<path d="{head}" fill="{colour}"/>'


def _apart(parts: Sequence[Part], fitted: Fit) -> Iterator[Part]:
    """Yield the parts, straight arrows moved along themselves where they would lie over another one."""
    taken = list[Bounds]()
    for part in parts:
        if isinstance(part, Arrow) and len(part.points) == 2:
            way = part.points[1] - part.points[0]
            tried = [replace(part, points=part.points + share * way) for share in _SHARES]
            free = (each for each in tried if not covered(_around(each, fitted), taken))
            part = next(free, part)
            taken.append(_around(part, fitted))
        yield part


def _around(part: Arrow | RoundMark, fitted: Fit) -> Bounds:
    """Return the bounds of a ball, or of the last piece of an arrow, pixels."""
    at = fitted.pixels(part.points)[-2:]
    reach = 0.0 if isinstance(part, Arrow) else max(part.radius * fitted.scale, part.least)
    (left, top), (right, bottom) = at.min(axis=0) - reach, at.max(axis=0) + reach
    return float(left), float(top), float(right), float(bottom)


def _label(part: Arrow | Caption, fitted: Fit) -> Label:
    at = fitted.pixels(part.points)
    if isinstance(part, Caption):
        return Label(part.words, _point(at[0]), "soft")
    along = at[-1] - at[-2]
    along = along / max(float(np.hypot(*along)), 1e-9)
    reach = 6.0 + abs(along[0]) * text_width(part.name, FONT + 2) / 2 + abs(along[1]) * FONT / 2
    return Label(part.name, _point(at[-1]), "axis", FONT + 2, first=_point(at[-1] + reach * along))


def _point(at: Array) -> Point:
    return float(at[0]), float(at[1])


def page(width: float, height: float, body: str, label: str) -> str:
    """Return an SVG element of a page; its colours are variables of the page.  label : for people who hear it"""
    size = f'viewBox="0 0 {width:g} {height:g}" width="{width:g}" height="{height:g}"'
    return f'<svg class="picture scene" {size} role="img" aria-label="{text_safe(label)}">{body}</svg>'
