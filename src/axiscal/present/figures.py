"""Pictures as plain dicts that `drawing` makes SVG of; colours are CSS variables that the page resolves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from axiscal.answers.digits import numbers
from axiscal.language.spoken import said
from axiscal.present.drawing.svg_picture import Figure
from axiscal.present.drawn_by_standards import PositioningCurve
from axiscal.present.sentences import unit_text

SYMBOLS = ("circle", "square", "diamond", "triangle-up", "cross", "x", "triangle-down", "pentagon", "star", "hexagon")
"""Marker of each set-up, in order; they repeat after the last."""

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31", "#7b4173")
"""Of lines that are compared; they repeat after the last."""


def colour(number: int) -> str:
    """Return the colour of a line that is compared with others, counted from 0."""
    return COLOURS[number % len(COLOURS)]


def axis_style(title: str, **more: Any) -> Figure:
    """Return the common style of a plot axis."""
    return {"gridcolor": "var(--grid)", "linecolor": "var(--rule)", "title": {"text": title}, **more}


def layout(x: Figure, y: Figure, height: int, **more: Any) -> Figure:
    """Return the common layout of a plot; height in pixels."""
    return {"height": height, "margin": {"l": 46, "r": 10, "t": 8, "b": 42}, "xaxis": x, "yaxis": y, **more}


def line_trace(x: Sequence[float], y: Sequence[float], colour: str, width: float, dash: str = "solid") -> Figure:
    """Return a line through points.  width : pixels"""
    return {"type": "scatter", "mode": "lines", "x": x, "y": y, "line": {"color": colour, "width": width, "dash": dash}}


def positioning_figure(curve: PositioningCurve) -> Figure:
    """Return positioning from below, solid, and from above, dashed: found, and left over it, both with 95 %."""
    at, bands, lines = numbers(curve.position, f"positions of {curve.axis}"), list[Figure](), list[Figure]()
    shown = [(curve.found, "var(--truth)", "var(--truth-band)")]
    shown += [] if curve.left is None else [(curve.left, "var(--read)", "var(--read-band)")]
    for sides, colour, fill in shown:
        for values, half, dash in zip(sides, curve.half, ("solid", "dash"), strict=True):
            middle = numbers(values, f"deviations of {curve.axis}")
            bands.append(band(at, middle, numbers(half, "a band"), fill))
            lines.append(line_trace(at, middle, colour, 2.0, dash))
    x = axis_style(f"{curve.axis}, {unit_text(curve.position_unit)}", nticks=6)
    title = said("deviation, {unit}", unit=unit_text(curve.value_unit))
    y = axis_style(title, nticks=6, zeroline=True, zerolinecolor="var(--rule)")
    return {"data": [*bands, *lines], "layout": layout(x, y, 260)}


def band(position: list[float], middle: list[float], half: list[float], fill: str) -> Figure:
    """Return a filled band middle ± half as one closed outline."""
    upper = [m + h for m, h in zip(middle, half, strict=True)]
    lower = [m - h for m, h in zip(middle, half, strict=True)]
    outline = {"x": position + position[::-1], "y": numbers(upper + lower[::-1], "a band")}
    style = {"fill": "toself", "fillcolor": fill, "mode": "lines"}
    return {"type": "scatter", **outline, **style}


def finite_range(values: Sequence[float]) -> list[float]:
    """Return an axis range with a margin around values, at least as wide as a picture needs."""
    low, high = min(values, default=-1.0), max(values, default=1.0)
    margin = max(0.08 * (high - low), 1e-3 * max(abs(low), abs(high)), 1e-9)
    return numbers([low - margin, high + margin], "range") if math.isfinite(margin) else [-1.0, 1.0]
