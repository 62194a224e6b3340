"""A figure as SVG: axes with ticks, lines, bands, marks with whiskers, maps, labels.

A figure is a plain dict: `data`, a list of traces, and `layout`. The names in both are those of plotly's schema; the
code below reads a part of it. Colours are CSS variables, which the page or `on_paper` resolves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

from axiscal.answers.answer import rounded
from axiscal.language.spoken import decimals
from axiscal.present.drawing.strokes import (
    SLACK,
    Point,
    dots,
    line,
    map_image,
    mark,
    on_paper,
    page_colours,
    rounded_up,
    short_number,
    text_safe,
    variables,
    way,
    window,
    words,
)

Figure = dict[str, Any]

_POINTED_AT = 60
"""Up to so many marks of a trace say what they are to a pointer; more would make the page heavy."""
_TICK_SIZE, _TITLE_SIZE = 10.5, 11.5
"""Pixels; a matter of taste."""
_BAR = 9.0
"""Pixels; a matter of taste."""
_APART = {"x": 46.0, "y": 26.0}
"""Pixels between two ticks at least: a number has to fit between them."""


def axis_style(title: str, **more: Any) -> Figure:
    """Return the common style of a plot axis."""
    return {"gridcolor": "var(--grid)", "linecolor": "var(--rule)", "title": {"text": title}, **more}


def layout(x: Figure, y: Figure, height: int, **more: Any) -> Figure:
    """Return the common layout of a plot; height in pixels."""
    return {"height": height, "margin": {"l": 46, "r": 10, "t": 8, "b": 42}, "xaxis": x, "yaxis": y, **more}


def line_trace(x: Sequence[float], y: Sequence[float], colour: str, width: float, dash: str = "solid") -> Figure:
    """Return a line through points.  width : pixels"""
    return {"type": "scatter", "mode": "lines", "x": x, "y": y, "line": {"color": colour, "width": width, "dash": dash}}


def band(position: list[float], middle: list[float], half: list[float], fill: str) -> Figure:
    """Return a filled band middle ± half as one closed outline."""
    upper = [m + h for m, h in zip(middle, half, strict=True)]
    lower = [m - h for m, h in zip(middle, half, strict=True)]
    outline = {"x": position + position[::-1], "y": rounded(upper + lower[::-1], "a band")}
    style = {"fill": "toself", "fillcolor": fill, "mode": "lines"}
    return {"type": "scatter", **outline, **style}


def finite_range(values: Sequence[float]) -> list[float]:
    """Return an axis range with a margin around values, at least as wide as a picture needs."""
    low, high = min(values, default=-1.0), max(values, default=1.0)
    margin = max(0.08 * (high - low), 1e-3 * max(abs(low), abs(high)), 1e-9)
    return rounded([low - margin, high + margin], "range") if math.isfinite(margin) else [-1.0, 1.0]


@dataclass(frozen=True, slots=True)
class Frame:
    """Where the axes of a picture run."""

    x: PixelScale
    y: PixelScale

    def point(self, x: float, y: float) -> Point:
        """Return a point of the picture."""
        return self.x.pixel(x), self.y.pixel(y)


def picture(figure: Figure, width: int, label: str = "") -> str:
    """Return a figure as an SVG element of a width in pixels, which its page may stretch."""
    layout, height = figure["layout"], figure["layout"]["height"]
    margin, bar = layout["margin"], 44 if any("colorbar" in trace for trace in figure["data"]) else 0
    frame = Frame(
        _scale(figure, "x", float(margin["l"]), float(width - margin["r"] - bar)),
        _scale(figure, "y", float(height - margin["b"]), float(margin["t"])),
    )
    left, top = frame.x.start, frame.y.end
    within, beyond = (
        "".join(part for each in figure["data"] if each.get("cliponaxis", True) is cut for part in _trace(each, frame))
        for cut in (True, False)
    )
    parts = [
        f'<svg class="picture" viewBox="0 0 {width} {height}" width="{width}" height="{height}" role="img" ',
        f'aria-label="{text_safe(label)}">',
        *_axes(layout, frame),
        window(left, top, frame.x.end - left, frame.y.start - top, f'<g class="data">{within}</g>'),
        beyond,
        *(part for trace in figure["data"] if "colorbar" in trace for part in _colour_bar(trace, frame)),
        "</svg>",
    ]
    return "".join(parts)


def _scale(figure: Figure, name: str, start: float, end: float) -> PixelScale:
    axis = figure["layout"][f"{name}axis"]
    if "range" in axis:
        return PixelScale(axis["range"][0], axis["range"][1], start, end)
    values = [value for trace in figure["data"] for value in trace[name]]
    low, high = min(values, default=0.0), max(values, default=1.0)
    margin = 0.05 * (high - low) or max(abs(high), 1.0) * 0.05
    low = min(0.0, low) if axis.get("rangemode") == "tozero" else low - margin
    return PixelScale(low, high + margin, start, end)


def _axes(layout: Figure, frame: Frame) -> Iterator[str]:
    yield from _upright(layout["yaxis"], frame.x, frame.y)
    x, foot = layout["xaxis"], frame.y.start
    for at, text in frame.x.ticks(_room(frame.x, "x", x), x.get("dtick")):
        if x.get("showgrid", True):
            yield line(way([(at, frame.y.end), (at, foot)]), x["gridcolor"], 1)
        yield words(text, (at, foot + 14), _TICK_SIZE, "var(--soft)", "middle")
    yield line(way([(frame.x.start, foot), (frame.x.end, foot)]), x["linecolor"], 1)
    middle = (frame.x.start + frame.x.end) / 2
    yield words(x["title"]["text"], (middle, foot + 32), _TITLE_SIZE, "var(--soft)", "middle")


def _upright(y: Figure, across: PixelScale, scale: PixelScale) -> Iterator[str]:
    left, right = across.start, across.end
    for at, text in scale.ticks(_room(scale, "y", y), y.get("dtick")):
        if y.get("showgrid", True):
            yield line(way([(left, at), (right, at)]), y["gridcolor"], 1)
        yield words(text, (left - 6, at + 3.5), _TICK_SIZE, "var(--soft)", "end")
    if y.get("zeroline") and scale.low < 0 < scale.high:
        yield line(way([(left, scale.pixel(0.0)), (right, scale.pixel(0.0))]), y["zerolinecolor"], 1.2)
    yield line(way([(left, scale.start), (left, scale.end)]), y["linecolor"], 1)
    middle = (scale.start + scale.end) / 2
    turned = f' transform="rotate(-90 12 {short_number(middle)})"'
    yield words(y["title"]["text"], (12, middle), _TITLE_SIZE, "var(--soft)", "middle", turned)


def _room(scale: PixelScale, name: str, axis: Figure) -> int:
    wanted: int = axis.get("nticks", 10)
    return min(wanted, max(1, int(abs(scale.end - scale.start) / _APART[name])))


def _trace(trace: Figure, frame: Frame) -> Iterator[str]:
    if trace["type"] == "heatmap":
        (left, *_, right), (low, *_, high) = trace["x"], trace["y"]
        corners = *frame.point(left, high), *frame.point(right, low)
        yield map_image(trace["z"], trace["colorscale"], trace["zmin"], trace["zmax"], corners)
        return
    points = [frame.point(x, y) for x, y in zip(trace["x"], trace["y"], strict=True)]
    mode = trace["mode"]
    if trace.get("fill"):
        yield f'<path d="{way(points, closed=True)}" fill="{trace["fillcolor"]}"/>'
        return
    if "lines" in mode:
        look = trace["line"]
        yield line(way(points), look["color"], look.get("width", 1.5), look.get("dash", ""))
    if "error_y" in trace:
        bars, d = trace["error_y"], dict[str, None]()
        for point, y, half in zip(points, trace["y"], bars["array"], strict=True):
            low, high = (short_number(frame.y.pixel(y + sign * half)) for sign in (-1, 1))
            d[f"M{short_number(point[0])} {low}V{high}"] = None
        yield line("".join(d), bars["color"], 1)
    if "markers" in mode:
        yield from _marks(trace, points)


def _marks(trace: Figure, points: Sequence[Point]) -> Iterator[str]:
    marker, texts = trace["marker"], trace.get("text", [])
    colour, size, edge = marker["color"], marker["size"], marker.get("line", {})
    if marker.get("round"):
        yield dots(points, edge["color"], size + 2 * edge["width"])
        yield dots(points, colour, size)
        if marker.get("hollow"):
            yield dots(points, edge["color"], size - 3)
        if len(points) <= _POINTED_AT:
            for text, point in zip(texts, points, strict=True):  # a pointer over it shows the title
                yield f"<g><title>{text_safe(text)}</title>{mark(point, max(size, 10.0), 'transparent')}</g>"
    else:
        yield from (mark(point, size, colour, edge.get("color", colour), edge.get("width", 0)) for point in points)


def _colour_bar(trace: Figure, frame: Frame) -> Iterator[str]:
    low, high, left = trace["zmin"], trace["zmax"], frame.x.end + 10
    scale = PixelScale(low, high, frame.y.start, frame.y.end)
    steps = [[low + (high - low) * k / 16] * 2 for k in range(17)]
    yield map_image(steps, trace["colorscale"], low, high, (left, frame.y.end, left + _BAR, frame.y.start))
    for at, text in scale.ticks(6):
        yield words(text, (left + _BAR + 4, at + 3.5), _TICK_SIZE - 1, "var(--soft)")


@dataclass(frozen=True, slots=True)
class PixelScale:
    """low, high : range; start, end : pixels"""

    low: float
    high: float
    start: float
    end: float

    def pixel(self, value: float) -> float:
        """Return where a value stands."""
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self, count: int, step: float | None = None) -> list[tuple[float, str]]:
        """Return about so many ticks as (pixel, text).  step : between two of them, where it is given"""
        size = step or rounded_up((self.high - self.low) / max(count, 1))
        found = self._multiples(size)
        while len(found) < _FEWEST and step is None and self.high > self.low:
            size = rounded_up(size / 3)  # 5, 2, 1: the next round step down
            found = self._multiples(size)
        texts = (decimals(f"{value + 0.0:.6g}").replace("-", "−") for value in found)
        return [(self.pixel(value), text) for value, text in zip(found, texts, strict=True)]

    def _multiples(self, size: float) -> list[float]:
        first, last = math.ceil(self.low / size - SLACK), math.floor(self.high / size + SLACK)
        return [float(f"{number * size:.9g}") for number in range(first, last + 1)]


_FEWEST = 2
"""Ticks without which a picture has no scale."""


SCREENS = (1400.0, 768.0, 390.0)
"""Pixels of a computer, a tablet and a telephone."""
_GROUND = '<rect width="100%" height="100%" fill="var(--paper)"/>'
_FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Noto Sans','Liberation Sans','DejaVu Sans',sans-serif"

FONT = "Libertinus Serif"
"""One of the letters that the typesetter brings along."""


_LOWER = 0.75
"""Share of the height on a screen that a picture has on paper; a matter of taste."""


def paper_svg(figure: Figure, width: int) -> str:
    """Return a figure as the text of an SVG file."""
    lower = {**figure["layout"], "height": _LOWER * figure["layout"]["height"]}
    return alone(picture({**figure, "layout": lower}, width))


def alone(svg: str) -> str:
    """Return an SVG element of a page as the text of a file."""
    return on_paper(svg).replace("<svg ", f'<svg xmlns="http://www.w3.org/2000/svg" font-family="{FONT}" ', 1)


class Drawing(NamedTuple):
    """What a file shows at one width.  width, height : pixels; body : SVG elements"""

    width: float
    height: float
    body: str

    def on_paper(self) -> str:
        """Return the text of an SVG file for paper."""
        size = f'viewBox="0 0 {self.width:g} {self.height:g}" width="{self.width:g}" height="{self.height:g}"'
        return alone(f"<svg {size}>{self.body}</svg>")


def picture_file(drawings: Sequence[Drawing], label: str) -> str:
    """Return the text of an SVG file that shows the largest drawing for which there is room.

    drawings : from the widest to the narrowest; label : what they show, for people who hear it
    """
    widest = drawings[0]
    shown = (
        f'<svg class="w{each.width:g}" width="100%" height="100%" viewBox="0 0 {each.width:g} {each.height:g}">'
        f"{each.body}</svg>"
        for each in drawings
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{widest.width:g}" height="{widest.height:g}" role="img" '
        f'aria-label="{text_safe(label)}"><title>{text_safe(label)}</title><style>{_style(drawings)}</style>'
        f"{_GROUND}{''.join(shown)}</svg>\n"
    )


def _style(drawings: Sequence[Drawing]) -> str:
    """Return colours for both kinds of light, and which drawing is shown at which width."""
    svg = "".join(each.body for each in drawings) + _GROUND
    light, dark = (variables(svg, values) for values in page_colours())
    rules = [f":root{{{light}font-family:{_FONT}}}", f"@media(prefers-color-scheme:dark){{:root{{{dark}}}}}"]
    rules += [f".w{each.width:g}{{display:none}}" for each in drawings[1:]]
    for wider, each in pairwise(drawings):
        size = f":root{{width:{each.width:g}px;height:{each.height:g}px}}"
        shown = f".w{wider.width:g}{{display:none}}.w{each.width:g}{{display:inline}}{size}"
        rules.append(f"@media(max-width:{wider.width - 1:g}px){{{shown}}}")
    return "".join(rules)
