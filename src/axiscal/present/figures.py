"""Pictures as plain dicts that `drawing` makes SVG of; colours are CSS variables that the page resolves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from axiscal.answers.digits import number, numbers
from axiscal.language.spoken import said
from axiscal.present.drawing.svg_picture import Figure
from axiscal.present.drawn_by_standards import PositioningCurve
from axiscal.present.sentences import (
    figure,
    position_text,
    short,
    standardised,
    unit_text,
    values_text,
)
from axiscal.present.summary import HistoryRow, Summary

SYMBOLS = ("circle", "square", "diamond", "triangle-up", "cross", "x", "triangle-down", "pentagon", "star", "hexagon")
"""Marker of each set-up, in order; they repeat after the last."""

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31", "#7b4173")
"""Of lines that are compared; they repeat after the last."""
_LARGEST_Z = 6.0
"""Standard deviations up to which a picture reaches; what is farther is drawn at its edge, with its number."""
_SMALLEST = 1e-12
"""um; a logarithmic axis has no nought."""
_LOW_LEVEL = 0.1
"""Share of the last RMS from which a line for it is worth drawing."""


def colour(number: int) -> str:
    """Return the colour of a line that is compared with others, counted from 0."""
    return COLOURS[number % len(COLOURS)]


def axis_style(title: str, **more: Any) -> Figure:
    """Return the common style of a plot axis."""
    return {"gridcolor": "var(--grid)", "linecolor": "var(--rule)", "title": {"text": title}, **more}


def layout(x: Figure, y: Figure, height: int, **more: Any) -> Figure:
    """Return the common layout of a plot; height in pixels."""
    return {"height": height, "margin": {"l": 46, "r": 10, "t": 8, "b": 42}, "xaxis": x, "yaxis": y, **more}


def line_trace(x: Sequence[float], y: Sequence[float | None], colour: str, width: float, dash: str = "solid") -> Figure:
    """Return a line through points; a value that is None leaves a gap.  width : pixels"""
    return {"type": "scatter", "mode": "lines", "x": x, "y": y, "line": {"color": colour, "width": width, "dash": dash}}


def mark_trace(x: Sequence[float], y: Sequence[float], colour: str, size: float) -> Figure:
    """Return round marks at points.  size : pixels across"""
    return {"type": "scatter", "mode": "markers", "x": x, "y": y, "marker": {"color": colour, "size": size}}


def accuracy(summary: Summary) -> Figure:
    """Return accuracy against readings."""
    steps = [row.reading for row in summary.history]
    lines, levels = _accuracy_lines(summary), _levels(summary)
    traces = [_accuracy_trace(line, steps) for line in lines] + [
        line_trace(steps, [level.value] * len(steps), level.colour, level.width, level.dash) for level in levels
    ]
    span = _log_range([value for line in lines for value in line.values] + [level.value for level in levels])
    x = axis_style(said("readings"), range=[0, max(1, *steps)])
    y = axis_style(said("standard uncertainty, µm"), type="log", range=span)
    ends = zip(lines, _shifts(lines, span), strict=True)
    marks = zip(levels, _shifts(levels, span), strict=True)
    labels = [_label(line, f"{line.name} {figure(line.value)}", up, True) for line, up in ends]
    labels += [_label(level, f"{level.name} {short(level.value)} µm", up, False) for level, up in marks]
    drawn = layout(x, y, _ACCURACY_HEIGHT, margin=_ACCURACY_MARGIN, annotations=labels)
    return {"data": traces, "layout": drawn, "wide": True}


_ACCURACY_HEIGHT = 350
"""Pixels; a matter of taste."""
_ACCURACY_MARGIN = {"l": 56, "r": 150, "t": 12, "b": 44}
"""Pixels; a matter of taste."""
_LABEL_HEIGHT = 17
"""Pixels of a line of text."""


@dataclass(frozen=True, slots=True)
class _Line:
    """A line of the accuracy chart, or with one value a level across it."""

    name: str
    values: list[float | None]
    colour: str
    width: float
    dash: str

    @property
    def value(self) -> float:
        """The last known value."""
        return next((value for value in reversed(self.values) if value is not None), _SMALLEST)


def _accuracy_lines(summary: Summary) -> list[_Line]:
    rows = summary.history
    lines = [
        _line(said("worst place"), [row.worst_um for row in rows], "var(--worst)", 1.6, "solid"),
        _line("RMS", [row.rms_um for row in rows], "var(--accent)", 2.6, "solid"),
    ]
    return [line for line in lines if any(value is not None for value in line.values)]


def _line(name: str, values: Sequence[float | None], colour: str, width: float, dash: str) -> _Line:
    return _Line(name, [_positive(value, name) for value in values], colour, width, dash)


def _positive(value: float | None, what: str) -> float | None:
    """Return value for a logarithmic axis, which cannot show zero."""
    return None if value is None or number(value, what) < _SMALLEST else number(value, what)


def _levels(summary: Summary) -> list[_Line]:
    wanted = (
        (said("target RMS"), summary.target_rms_um, "var(--accent)", "dash"),
        (said("target worst"), summary.target_worst_um, "var(--worst)", "dash"),
        (said("cannot be seen"), _unseen(summary), "var(--soft)", "dot"),
    )
    levels = [_line(name, [value], colour, 1.2, dash) for name, value, colour, dash in wanted]
    return [level for level in levels if level.values != [None]]


def _unseen(summary: Summary) -> float | None:
    """Return the level of what cannot be seen; a small one would squeeze the lines above it, and is left out."""
    return summary.unseen_rms_um if summary.unseen_rms_um >= _LOW_LEVEL * summary.history[-1].rms_um else None


def _accuracy_trace(line: _Line, steps: list[int]) -> Figure:
    style = {"line": {"color": line.colour, "width": line.width, "dash": line.dash}}
    marker = {"marker": {"color": line.colour, "size": 7}, "mode": "lines" if len(steps) > 1 else "markers"}
    return {"type": "scatter", "x": steps, "y": line.values, "name": line.name, **style, **marker}


def _log_range(values: Sequence[float | None]) -> list[float]:
    known = [math.log10(value) for value in values if value is not None] or [0.0]
    return numbers([min(known) - 0.12, max(known) + 0.08], "range")


def _shifts(lines: list[_Line], span: list[float]) -> list[float]:
    """Return by how many pixels the label of each line moves up so that no two overlap."""
    pixels = (_ACCURACY_HEIGHT - _ACCURACY_MARGIN["t"] - _ACCURACY_MARGIN["b"]) / (span[1] - span[0])
    heights = [math.log10(line.value) * pixels for line in lines]
    shifts, floor = [0.0] * len(lines), -math.inf
    for index in sorted(range(len(lines)), key=heights.__getitem__):
        floor = max(heights[index], floor + _LABEL_HEIGHT)
        shifts[index] = round(floor - heights[index], 1)
    return shifts


def _label(line: _Line, text: str, shift: float, at_end: bool) -> Figure:
    """Return a label to the right of a line's end, or standing on the left end of a level."""
    place = {"xref": "paper", "x": int(at_end), "xanchor": "left", "y": number(math.log10(line.value), line.name)}
    style = {
        "yanchor": "middle" if at_end else "bottom",
        "font": {"color": line.colour, "size": 12.5 if at_end else 11},
    }
    return {**place, **style, "text": text, "xshift": 6, "yshift": shift}


def innovations(summary: Summary) -> Figure | None:
    """Return standardised innovations against the reading; off-scale ones stand at the edge as triangles."""
    found = [(row, z) for row in summary.history if (z := standardised(row)) is not None]
    if not found:
        return None
    traces = [
        _innovation_trace([pair for pair in found if _class_of(*pair) == kind], colour, symbol)
        for kind, colour, symbol in (
            ("usual", "var(--accent)", "circle"),
            ("unusual", "var(--truth)", "circle"),
            ("rejected", "var(--alarm)", "x"),
        )
    ]
    reach = min(_LARGEST_Z, max(4.0, *(abs(z) * 1.1 for _, z in found)))
    band = {
        "type": "rect",
        "xref": "paper",
        "x0": 0,
        "x1": 1,
        "y0": -2,
        "y1": 2,
    }
    y = axis_style(said("surprise, standard deviations"), range=[-reach - 0.5, reach + 0.5], dtick=2)
    x = axis_style(said("reading"))
    drawn = layout(x, y, 260, shapes=[{**band, "fillcolor": "var(--whole)"}])
    return {"data": traces, "layout": drawn, "wide": True}


def _class_of(row: HistoryRow, z: float) -> str:
    return "rejected" if row.rejected else "unusual" if abs(z) > 3 else "usual"


def _innovation_trace(found: list[tuple[HistoryRow, float]], colour: str, symbol: str) -> Figure:
    off = [abs(z) > _LARGEST_Z for _, z in found]
    shown = [max(-_LARGEST_Z, min(_LARGEST_Z, z)) for _, z in found]
    symbols = [
        symbol if not out else "triangle-up" if z > 0 else "triangle-down" for out, z in zip(off, shown, strict=True)
    ]
    surprise = "surprise {size} standard deviations"
    text = [f"{_reading_text(row)}\n{said(surprise, size=figure(z))}" for row, z in found]
    marker = {"color": colour, "size": 8 if symbol == "x" else 6.5, "symbol": symbols}
    points = {"x": [row.reading for row, _ in found], "y": numbers(shown, "innovations"), "text": text}
    return {"type": "scatter", "mode": "markers", "marker": marker, "cliponaxis": False, **points}


def _reading_text(row: HistoryRow) -> str:
    value = f"\n{values_text(row.values, row.unit)}" if row.values else ""
    number = said("reading {number}", number=row.reading)
    return f"{number}, {row.setup or ''}\n{position_text(row.position)}{value}"


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
