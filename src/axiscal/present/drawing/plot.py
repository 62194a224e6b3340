"""A plot as SVG: a line over two axes with ticks, its band or its marks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.language.spoken import decimals
from axiscal.present.drawing.strokes import SLACK, corners_way, rounded_up, short_number, text_safe, window, words
from axiscal.present.drawing.svg_picture import alone

_HEIGHT, _LEFT, _RIGHT, _TOP, _FOOT = 260, 46.0, 10.0, 8.0, 42.0
"""Pixels of a plot, and around its axes; a matter of taste."""
_TICK_SIZE, _TITLE_SIZE, _MARK = 10.5, 11.5, 3.0
"""Pixels; a matter of taste."""
_APART = 46.0, 26.0
"""Pixels between two ticks at least, across and up: a number has to fit between them."""
_MOST, _FEWEST = 10, 2
"""Ticks at most, a matter of taste; and those without which a picture has no scale."""
_LINE, _FILL = "#1f5fa8", "rgba(31, 95, 168, 0.18)"


@dataclass(frozen=True, slots=True)
class Plot:
    """A line through points (x, y).

    across, up : what the axes show; half : half of the width of a band about the line at each point, () for none
    level : that the line cannot go below, drawn dotted, and nought is shown; None for none; marked : at each point
    """

    name: str
    across: str
    up: str
    x: Sequence[float]
    y: Sequence[float]
    half: Sequence[float] = ()
    level: float | None = None
    marked: bool = False

    def svg(self, width: int) -> str:
        """Return the text of an SVG file."""
        x, y, half = [*self.x], [*self.y], [*self.half] or [0.0]
        edges = [[v + side * h for v, h in zip(y, half * (len(y) // len(half)), strict=True)] for side in (1, -1)]
        across = PixelScale.over(x, _LEFT, width - _RIGHT)
        up = PixelScale.over([*edges[0], *edges[1], *([0.0] if self.marked else [])], _HEIGHT - _FOOT, _TOP)
        points = [(across.pixel(a), up.pixel(b)) for a, b in zip(x, y, strict=True)]
        inside = _path(points, _LINE, 1.5)
        if self.half:
            outline = [
                (across.pixel(a), up.pixel(b)) for a, b in zip(x + x[::-1], edges[0] + edges[1][::-1], strict=True)
            ]
            inside = f'<path d="{corners_way(outline)}z" fill="{_FILL}"/>{inside}'
        if self.level is not None:
            at = up.pixel(self.level)
            inside += _path([(across.start, at), (across.end, at)], _LINE, 1.5, ' stroke-dasharray="1.5,3"')
        if self.marked:
            places = ((short_number(a), short_number(b)) for a, b in points)
            inside += "".join(f'<circle cx="{a}" cy="{b}" r="{_MARK:g}" fill="{_LINE}"/>' for a, b in places)
        size = f'viewBox="0 0 {width} {_HEIGHT}" width="{width}" height="{_HEIGHT}"'
        body = self._axes(across, up) + window(_LEFT, _TOP, width - _LEFT - _RIGHT, _HEIGHT - _TOP - _FOOT, inside)
        return alone(f'<svg {size} role="img" aria-label="{text_safe(self.name)}">{body}</svg>')

    def _axes(self, across: PixelScale, up: PixelScale) -> str:
        foot, middle = up.start, ((across.start + across.end) / 2, (up.start + up.end) / 2)
        parts = []
        for at, text in across.ticks(_APART[0]):
            parts.append(_path([(at, up.end), (at, foot)], "var(--grid)", 1))
            parts.append(words(text, (at, foot + 14), _TICK_SIZE, "var(--soft)", "middle"))
        for at, text in up.ticks(_APART[1]):
            parts.append(_path([(across.start, at), (across.end, at)], "var(--grid)", 1))
            parts.append(words(text, (across.start - 6, at + 3.5), _TICK_SIZE, "var(--soft)", "end"))
        corner = [(across.start, up.end), (across.start, foot), (across.end, foot)]
        turned = f' transform="rotate(-90 12 {short_number(middle[1])})"'
        parts.append(_path(corner, "var(--rule)", 1))
        parts.append(words(self.across, (middle[0], foot + 32), _TITLE_SIZE, "var(--soft)", "middle"))
        parts.append(words(self.up, (12, middle[1]), _TITLE_SIZE, "var(--soft)", "middle", turned))
        return "".join(parts)


def _path(points: Sequence[tuple[float, float]], colour: str, width: float, more: str = "") -> str:
    return f'<path d="{corners_way(points)}" fill="none" stroke="{colour}" stroke-width="{width:g}"{more}/>'


@dataclass(frozen=True, slots=True)
class PixelScale:
    """low, high : range; start, end : pixels"""

    low: float
    high: float
    start: float
    end: float

    @classmethod
    def over(cls, values: Sequence[float], start: float, end: float) -> PixelScale:
        """Return a scale that shows all values, with some room around them."""
        low, high = min(values), max(values)
        margin = 0.05 * (high - low) or max(abs(high), 1.0) * 0.05
        return cls(low - margin, high + margin, start, end)

    def pixel(self, value: float) -> float:
        """Return where a value stands."""
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self, apart: float) -> list[tuple[float, str]]:
        """Return ticks as (pixel, text).  apart : pixels between two of them at least"""
        size = rounded_up((self.high - self.low) / min(_MOST, max(1, int(abs(self.end - self.start) / apart))))
        found = self._multiples(size)
        while len(found) < _FEWEST:
            size = rounded_up(size / 3)  # 5, 2, 1: the next round step down
            found = self._multiples(size)
        texts = (decimals(f"{value + 0.0:.6g}").replace("-", "−") for value in found)
        return [(self.pixel(value), text) for value, text in zip(found, texts, strict=True)]

    def _multiples(self, size: float) -> list[float]:
        first, last = math.ceil(self.low / size - SLACK), math.floor(self.high / size + SLACK)
        return [float(f"{number * size:.9g}") for number in range(first, last + 1)]
