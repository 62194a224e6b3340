"""A scene of lines, arrows and words in metres, drawn as SVG from the front, the right and above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array
from axiscal.present.drawing.strokes import (
    FONT,
    Bounds,
    Label,
    Point,
    corners_way,
    placed,
    short_number,
    text_width,
    window,
)

_TURN, _LIFT = np.radians(33.0), np.radians(27.0)
"""How far who looks stands to the right of the front, and above the floor, rad; a matter of taste."""
RIGHT: Array = np.array([np.cos(_TURN), np.sin(_TURN), 0.0])
"""Unit vector of the scene that runs to the right in the picture."""
UP: Array = np.array([-np.sin(_TURN) * np.sin(_LIFT), np.cos(_TURN) * np.sin(_LIFT), np.cos(_LIFT)])
"""Unit vector of the scene that runs up in the picture."""
EYE: Array = np.cross(RIGHT, UP)
"""Unit vector towards who looks."""
_HEAD, _HALF_HEAD = 11.0, 4.5
"""Pixels of the head of an arrow; a matter of taste."""
_MARGIN = 14.0
"""Pixels around what is drawn, for the names of arrows."""


@dataclass(frozen=True, eq=False, slots=True)
class _Part:
    """What is drawn.  points : (n, 3) m, or (3,) of what has one place"""

    points: Array


@dataclass(frozen=True, eq=False, slots=True)
class Stroke(_Part):
    """A line.  width : pixels; filled : colour of what it encloses, "" for none"""

    colour: str
    width: float = 1.5
    dash: str = ""
    opacity: float = 1.0
    filled: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class RoundMark(_Part):
    """A ball.  points : its centre, (3,) m; radius : m; least : radius in pixels below which it does not shrink"""

    radius: float
    colour: str
    least: float = 2.6


@dataclass(frozen=True, eq=False, slots=True)
class Arrow(_Part):
    """A way with a head at its end and a name there.  points : straight where there are two"""

    name: str
    colour: str = "ink"


@dataclass(frozen=True, eq=False, slots=True)
class Caption(_Part):
    """Words beside a place, (3,) m."""

    words: str


Part = Stroke | RoundMark | Arrow | Caption
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
    marks = [part for part in parts if not isinstance(part, Caption)]
    labels = [_label(part, fitted) for part in parts if isinstance(part, (Arrow, Caption))]
    over = [_around(part, fitted) for part in marks if isinstance(part, (Arrow, RoundMark))]
    shown = placed(labels, (frame.left, frame.top, frame.left + frame.width, frame.top + frame.height), over)
    cut = window(frame.left, frame.top, frame.width, frame.height, "".join(_mark(each, fitted) for each in marks))
    return cut + "".join(label.svg() for label in shown)


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


def _around(part: Arrow | RoundMark, fitted: Fit) -> Bounds:
    """Return the bounds of a ball, or of the last piece of an arrow, pixels."""
    at = fitted.pixels(part.points)[-2:]
    reach = _HALF_HEAD if isinstance(part, Arrow) else max(part.radius * fitted.scale, part.least)
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
