"""Small line pictures as SVG: axes with round ticks, lines, a band, points; to a tenth of a pixel."""

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

Numbers = Sequence[float]

_WIDTH, _HEIGHT = 640, 300
_LEFT, _RIGHT, _TOP, _BOTTOM = 62, 14, 30, 44
_COLOURS = ("#0b5c8a", "#c2491d", "#5a656d")
_TEXT = 'font-family="system-ui, sans-serif" font-size="12" fill="#5a656d"'


def svg(picture: Mapping[str, Any]) -> str:
    """Return a picture as SVG.

    picture : "x", "y" titles; "lines", "points" by name, each (x, y); "band" (x, low, high); "log" for the ordinate
    """
    drawing = _Drawing(picture)
    return "\n".join([_HEAD, *drawing.axes(), *drawing.band(), *drawing.lines(), *drawing.points(), "</svg>", ""])


def ticks(low: float, high: float, most: int = 8) -> list[float]:
    """Return round numbers in a range, at most so many."""
    raw = (high - low) / most
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(power * k for k in (1, 2, 5, 10) if power * k >= raw * (1 - 1e-9))
    first = math.ceil(low / step - 1e-9)
    return [step * k for k in range(first, math.floor(high / step + 1e-9) + 1)]


_HEAD = (
    f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}">\n'
    f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="#ffffff"/>'
)


class _Drawing:
    """One picture with its scales."""

    def __init__(self, picture: Mapping[str, Any]) -> None:
        self.picture, self.log = picture, bool(picture.get("log"))
        series = [*picture.get("lines", {}).values(), *picture.get("points", {}).values()]
        band = picture.get("band")
        xs = [float(v) for x, _ in series for v in x]
        ys = [self._level(float(v)) for _, y in series for v in y]
        ys += [float(v) for edge in (band[1:] if band else ()) for v in edge]
        self.x = min(xs), max(xs)
        margin = 0.06 * (max(ys) - min(ys))
        self.y = min(ys) - margin, max(ys) + margin

    def _level(self, value: float) -> float:
        return math.log10(value) if self.log else value

    def across(self, value: float) -> float:
        """Return the pixel of an abscissa."""
        return _LEFT + (value - self.x[0]) / (self.x[1] - self.x[0]) * (_WIDTH - _LEFT - _RIGHT)

    def up(self, level: float) -> float:
        """Return the pixel of an ordinate, of its logarithm on a logarithmic one."""
        return _HEIGHT - _BOTTOM - (level - self.y[0]) / (self.y[1] - self.y[0]) * (_HEIGHT - _TOP - _BOTTOM)

    def axes(self) -> Iterable[str]:
        """Yield grid, ticks and titles."""
        foot = _HEIGHT - _BOTTOM
        for value in ticks(*self.x):
            at = f"{self.across(value):.1f}"
            yield f'<path d="M{at} {_TOP}V{foot}" stroke="#ecebe6"/>'
            yield f'<text x="{at}" y="{foot + 17}" text-anchor="middle" {_TEXT}>{value:.6g}</text>'
        for level, text in self._marks():
            at = f"{self.up(level):.1f}"
            yield f'<path d="M{_LEFT} {at}H{_WIDTH - _RIGHT}" stroke="#ecebe6"/>'
            yield f'<text x="{_LEFT - 6}" y="{float(at) + 4:.1f}" text-anchor="end" {_TEXT}>{text}</text>'
        yield f'<path d="M{_LEFT} {_TOP}V{foot}H{_WIDTH - _RIGHT}" stroke="#b9b6ad" fill="none"/>'
        middle = (_LEFT + _WIDTH - _RIGHT) / 2
        yield f'<text x="{middle}" y="{_HEIGHT - 8}" text-anchor="middle" {_TEXT}>{escape(self.picture["x"])}</text>'
        turned = f'transform="translate(14 {(_TOP + foot) / 2}) rotate(-90)"'
        yield f'<text {turned} text-anchor="middle" {_TEXT}>{escape(self.picture["y"])}</text>'

    def _marks(self) -> list[tuple[float, str]]:
        if not self.log:
            return [(value, f"{value:.6g}") for value in ticks(*self.y, most=6)]
        decades = range(math.floor(self.y[0]), math.ceil(self.y[1]) + 1)
        values = [k * 10.0**d for d in decades for k in (1, 2, 5)]
        return [(math.log10(v), f"{v:.6g}") for v in values if self.y[0] <= math.log10(v) <= self.y[1]]

    def band(self) -> Iterable[str]:
        """Yield the band, if there is one."""
        if "band" in self.picture:
            x, low, high = self.picture["band"]
            outline = [*zip(x, high, strict=True), *reversed(list(zip(x, low, strict=True)))]
            yield f'<polygon points="{self._pixels(outline)}" fill="#0b5c8a" fill-opacity="0.17"/>'

    def lines(self) -> Iterable[str]:
        """Yield the lines with their names above the picture."""
        place = float(_LEFT)
        for colour, (name, (x, y)) in zip(_COLOURS, self.picture.get("lines", {}).items(), strict=False):
            levels = [self._level(float(v)) for v in y]
            pixels = self._pixels(zip(x, levels, strict=True))
            yield f'<polyline points="{pixels}" fill="none" stroke="{colour}" stroke-width="1.8"/>'
            yield f'<path d="M{place:.0f} 15h18" stroke="{colour}" stroke-width="2"/>'
            yield f'<text x="{place + 24:.0f}" y="19" {_TEXT}>{escape(name)}</text>'
            place += 50 + 6.6 * len(name)
        self.place = place

    def points(self) -> Iterable[str]:
        """Yield the points, named after the lines."""
        for name, (x, y) in self.picture.get("points", {}).items():
            for a, b in zip(x, y, strict=True):
                at = f'cx="{self.across(float(a)):.1f}" cy="{self.up(self._level(float(b))):.1f}"'
                yield f'<circle {at} r="3" fill="#1b2328"/>'
            yield f'<circle cx="{self.place + 6:.0f}" cy="15" r="3" fill="#1b2328"/>'
            yield f'<text x="{self.place + 16:.0f}" y="19" {_TEXT}>{escape(name)}</text>'

    def _pixels(self, points: Iterable[tuple[float, float]]) -> str:
        return " ".join(f"{self.across(float(x)):.1f},{self.up(float(y)):.1f}" for x, y in points)
