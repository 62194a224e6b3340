"""What standards draw, from the estimate and of what tables leave.

Positioning as of ISO 230-2: both directions of approach, found and left, where it was read. The circle of a ball bar as
of ISO 230-4, enlarged: as it was read, and what tables leave of the machine's share.

    picture = circle_picture(circle, 340)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.language.spoken import said
from axiscal.machine.kinematics import frames
from axiscal.measurement.instrument import instrument_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.present.drawing.scene import page
from axiscal.present.drawing.strokes import Point, dots, line, rounded_up, short_number, text, text_width, way
from axiscal.tables.surface import Control, left_by
from axiscal.units import to_unit


@dataclass(frozen=True, slots=True)
class PositioningCurve:
    """Deviations along the line on which an axis was read, the mean of both directions taken off, in display units.

    found : as estimated, from below and from above; half : ± of it, 95 %; left : with tables, None where there are none
    """

    axis: str
    position_unit: str
    value_unit: str
    position: Sequence[float]
    found: tuple[Sequence[float], Sequence[float]]
    half: tuple[Sequence[float], Sequence[float]]
    left: tuple[Sequence[float], Sequence[float]] | None


def positioning_curves(estimation: Estimation, control: Control | None = None) -> list[PositioningCurve]:
    """Return the positioning of every axis that was read along, or about, itself.  control : what tables do, if any"""
    estimate, found = estimation.estimate(), list[PositioningCurve]()
    description = estimation.stated.description
    for row in asked_rows(description, estimation.readings):
        if row.want.row.kind != "positioning" or row.map is None:
            continue
        (line,), axis = row.lines, description.machine.axes[row.lines[0].axis]
        unit = "urad" if axis.rotary else "um"
        at, left = row.map.poses, None
        if axis.rotary:
            read = row.map.rows(estimate.model) @ estimate.mean
        else:
            read = row.map.row(estimate.deviation(at, row.map.sides))
        if control is not None and not axis.rotary:
            after = left_by(estimate.machine, estimate.deviation, control, at, row.map.sides)
            left = _sides(row.map.row(after), unit)
        half = BAND * np.sqrt(row.map.spectra(estimate.model, estimate.factor)[:, 0])
        positions = to_unit(line.positions, axis.unit).tolist()
        own = (axis.name, axis.unit, unit, positions)
        found.append(PositioningCurve(*own, _sides(read, unit), _sides(half, unit), left))
    return found


def _sides(values: Array, unit: str) -> tuple[list[float], list[float]]:
    """Return what comes from below and what comes from above, of which the second follows the first."""
    up, down = np.split(np.asarray(to_unit(values, unit)), 2)
    return up.tolist(), down.tolist()


_FEWEST = 8
"""Readings on a circle before it has a shape."""
_LEVEL = 0.25
"""By how much of the bar readings may lie off one plane, and an arc may miss of a whole turn."""
_SHARE = 0.35
"""Of the radius, that the largest deviation has at most."""


@dataclass(frozen=True, slots=True)
class BallBarCircle:
    """One circle in a plane, its readings by rising angle; the centre and the length that fit best are taken off.

    plane : names of both directions, such as "xy"; angle : deg
    read, found : um along the bar, as read and as estimated; left : with tables, None where there are none
    """

    setup: str
    plane: str
    angle: Sequence[float]
    read: Sequence[float]
    found: Sequence[float]
    left: Sequence[float] | None


def ball_bar_circles(estimation: Estimation, control: Control | None = None) -> list[BallBarCircle]:
    """Return the circles of all ball-bar set-ups whose readings lie in a plane, and go round; arguments as above."""
    kept = [reading for n, reading in enumerate(estimation.readings) if n not in estimation.left_out]
    found = []
    for setup in estimation.stated.description.setups:
        mine = [reading for reading in kept if reading.setup == setup.name]
        if instrument_of(setup).site == "bar" and len(setup.standing) == 1 and len(mine) >= _FEWEST:
            found += _circle(estimation, setup, mine, control)
    return found


def _circle(
    estimation: Estimation, setup: Setup, readings: Sequence[Reading], control: Control | None
) -> list[BallBarCircle]:
    estimate = estimation.estimate()
    poses, sides = (np.array([getattr(r, name) for r in readings], dtype=float) for name in ("pose", "approach"))
    bars = frames(estimate.machine, poses).tcp - np.array(setup.standing[0])
    across = int(np.argmin(np.ptp(bars, axis=0)))
    first, second = (k for k in range(3) if k != across)
    turns = np.mod(np.arctan2(bars[:, second], bars[:, first]), math.tau)
    order = np.argsort(turns)
    turns, length = turns[order], float(np.linalg.norm(bars, axis=1).mean())
    gaps = np.diff([*turns, turns[0] + math.tau])
    if np.ptp(bars[:, across]) > _LEVEL * length or gaps.max() > 2 * math.pi * _LEVEL:
        return []
    along = (bars / np.linalg.norm(bars, axis=1)[:, None])[order]
    poses, sides = poses[order], sides[order]

    def shape(values: Array) -> list[float]:
        columns = np.stack([np.ones_like(turns), np.cos(turns), np.sin(turns)], axis=1)  # length and centre, ISO 230-4
        left: Array = values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0]
        shaped: list[float] = np.asarray(to_unit(left, "um")).tolist()
        return shaped

    left = None
    if control is not None:
        after = left_by(estimate.machine, estimate.deviation, control, poses, sides)
        left = shape(np.sum(along * after, axis=1))
    read = shape(np.array([reading.value for reading in readings])[order])
    found = shape(np.sum(along * estimate.deviation(poses, sides), axis=1))
    return [BallBarCircle(setup.name, "xyz"[first] + "xyz"[second], np.degrees(turns).tolist(), read, found, left)]


def circle_picture(circle: BallBarCircle, width: float) -> str:
    """Return the circle as an SVG element of a page: dots as read, lines as found and left.  width : pixels"""
    middle, radius, step = width / 2, 0.32 * width, division(circle)
    scale = _SHARE * radius / (5 * step)
    rings, at = "", short_number(middle)
    for k in range(-5, 6):
        colour, wide = ("var(--soft)", 1.4) if k == 0 else ("var(--grid)", 1.0)
        r = short_number(radius + k * step * scale)
        rings += f'<circle cx="{at}" cy="{at}" r="{r}" fill="none" stroke="{colour}" stroke-width="{wide:g}"/>'
    spokes, reach = "", 1.4 * radius
    for name, across, down in zip(circle.plane, (1.0, 0.0), (0.0, -1.0), strict=True):  # to the right and up
        ends = [(middle - reach * across, middle - reach * down), (middle + reach * across, middle + reach * down)]
        beside, foot = (reach - text_width(name)) * across + 8 * (1 - across), reach * down + 12 - 18 * across
        spokes += line(way(ends), "var(--rule)", 1.0) + text(middle + beside, middle + foot, name, "axis")
    shown = [(circle.found, "var(--truth)"), *([] if circle.left is None else [(circle.left, "var(--read)")])]
    turns = np.linspace(0.0, 360.0, 181)
    lines = ""
    for values, colour in shown:  # evenly from one reading to the next
        between = np.interp(turns, circle.angle, values, period=360.0)
        lines += line(way(_points(turns, between, middle, radius, scale), closed=True), colour, 2.0)
    read = _points(np.array(circle.angle), np.array(circle.read), middle, radius, scale)
    marks = dots(read, "var(--ink)", 6.0)
    words = said("one division: {size} µm", size=f"{step:g}")
    return page(width, width + 16, rings + spokes + lines + marks + text(middle, width + 8, words, "soft", "middle"),
                said("Ball bar: {setup}", setup=circle.setup))  # fmt: skip


def division(circle: BallBarCircle) -> float:
    """Return how much lies between two rings, um: 1, 2 or 5 times a power of ten; five hold all."""
    every = [*circle.read, *circle.found, *(circle.left or ())]
    return rounded_up(max(max(abs(value) for value in every), 1e-3) / 5)


def _points(turns: Array, values: Array, middle: float, radius: float, scale: float) -> list[Point]:
    """Return where values stand.  turns : deg; values : um; scale : pixels for one of them"""
    far, at = radius + scale * values, np.radians(turns)
    return list(zip((middle + far * np.cos(at)).tolist(), (middle - far * np.sin(at)).tolist(), strict=True))
