"""Elements of SVG as text: lines through points with as few of them as the eye needs, marks, words, colours, maps.

Labels know how wide they are, and stand so that none lies over another.
"""

from __future__ import annotations

import base64
import itertools
import math
import re
import struct
import tomllib
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from html import escape
from importlib import resources

import numpy as np

from axiscal.numerics import Array

Point = tuple[float, float]

_STRAIGHT = 0.12
"""Pixels by which a point that is left out may lie off the line: nobody sees it."""
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Signs that no XML document may hold (XML 1.0, 2.2)."""
DASHES = {"dot": "1.5,3", "dash": "6,4", "solid": ""}


def text_safe(text: str) -> str:
    """Return text for the inside of an element or an attribute; what XML cannot hold becomes a question mark."""
    return escape(_NO_XML.sub("?", text), quote=True)


SLACK = 1e-9
"""Share of a step by which rounding may be off."""


def rounded_up(size: float) -> float:
    """Return the smallest of 1, 2, 5 times a power of ten that is not below size."""
    power = 10.0 ** math.floor(math.log10(size))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= size * (1 - SLACK))


def rounded_down(size: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above size: whose inverse is another of them."""
    return 1 / rounded_up(1 / size)


def short_number(value: float) -> str:
    """Return a number of pixels to a tenth."""
    text = f"{value:.1f}"
    return ("0" if text == "-0.0" else text).removesuffix(".0")


def way(points: Sequence[Point], closed: bool = False) -> str:
    """Return the `d` of a line through points, in steps from one to the next."""
    kept = simplified(points)
    if not kept:
        return ""
    at = (round(kept[0][0], 1), round(kept[0][1], 1))
    parts = [f"M{short_number(at[0])} {short_number(at[1])}"]
    for x, y in kept[1:]:
        to = (round(x, 1), round(y, 1))
        across, down = short_number(to[0] - at[0]), short_number(to[1] - at[1])
        parts.append(f"l{across}{down if down.startswith('-') else ' ' + down}")
        at = to
    return "".join(parts) + ("z" if closed else "")


def simplified(points: Sequence[Point]) -> list[Point]:
    """Return points without those that lie on the line between the ones that are kept (Douglas and Peucker)."""
    if len(points) < 3:
        return list(points)
    keep, open_spans = {0, len(points) - 1}, [(0, len(points) - 1)]
    while open_spans:
        first, last = open_spans.pop()
        off = _distances(points[first + 1 : last], points[first], points[last])
        farthest = max(off, default=0.0)
        if farthest > _STRAIGHT:
            far = last - 1 - off[::-1].index(farthest)
            keep.add(far)
            open_spans += [(first, far), (far, last)]
    return [points[index] for index in sorted(keep)]


def _distances(points: Sequence[Point], start: Point, end: Point) -> list[float]:
    """Return how far points lie from the line from a start to an end, pixels; from both where these are one."""
    x, y = start
    across, down = end[0] - x, end[1] - y
    length = math.hypot(across, down)
    if length == 0:
        return [math.hypot(each[0] - x, each[1] - y) for each in points]
    return [abs(across * (each[1] - y) - down * (each[0] - x)) / length for each in points]


def line(d: str, colour: str, width: float, dash: str = "") -> str:
    """Return a line that keeps its width whatever its group is stretched by."""
    dashed = DASHES.get(dash, dash.replace("px", ""))
    more = f' stroke-dasharray="{dashed}"' if dashed else ""
    return f'<path d="{d}" fill="none" stroke="{colour}" stroke-width="{width:g}"{more}/>' if d else ""


def dots(points: Sequence[Point], colour: str, size: float) -> str:
    """Return round dots as one line of no length with round ends: they stay round when their group is stretched."""
    d = "".join(dict.fromkeys(f"M{short_number(x)} {short_number(y)}h0" for x, y in points))
    return f'<path d="{d}" fill="none" stroke="{colour}" stroke-width="{size:g}" stroke-linecap="round"/>' if d else ""


def mark(at: Point, size: float, colour: str, edge: str = "", width: float = 0) -> str:
    """Return one round mark.  size : its diameter; edge, width : of its outline"""
    outline = f' stroke="{edge}" stroke-width="{width:g}"' if width else ""
    x, y, half = map(short_number, (*at, size / 2))
    return f'<circle cx="{x}" cy="{y}" r="{half}" fill="{colour}"{outline}/>'


def corners_way(corners: Iterable[Sequence[float]]) -> str:
    """Return the `d` of a line through all corners, each (x, y)."""
    return "M" + "L".join(f"{short_number(x)} {short_number(y)}" for x, y in corners)


def window(left: float, top: float, width: float, height: float, inside: str) -> str:
    """Return elements as far as they lie in a frame, pixels."""
    x, y, across, high = map(short_number, (left, top, width, height))
    return f'<svg x="{x}" y="{y}" width="{across}" height="{high}" viewBox="{x} {y} {across} {high}">{inside}</svg>'


def words(text: str, at: Point, size: float, colour: str, anchor: str = "start", more: str = "") -> str:
    """Return a line of text.  anchor : start, middle or end"""
    place = f'x="{short_number(at[0])}" y="{short_number(at[1])}"'
    where = "" if anchor == "start" else f' text-anchor="{anchor}"'
    return f'<text {place} font-size="{size:g}" fill="{colour}"{where}{more}>{text_safe(text)}</text>'


FONT = 14.0
"""Pixels of all words in a picture of a machine."""
_WIDE, _NARROW, _USUAL = 0.92, 0.34, 0.6
"""Widths of letters as shares of their height, on the wide side for the fonts that screens have."""
_DEEP = 0.28
"""Share of the height of letters that goes below the line they stand on."""
_APART = 2.0
"""Pixels between two labels."""

Bounds = tuple[float, float, float, float]
"""Left, top, right, bottom, pixels."""


_BOLD = 1.1
"""Times as wide as plain letters."""


def text_width(text: str, size: float = FONT) -> float:
    """Return about how wide a text is, pixels."""
    widths = (
        _WIDE if each in "mwMWOQGD@%×" else _NARROW if each in "iljftI.,;:'|!()[] ·′" else _USUAL for each in text
    )
    return size * sum(widths)


def wrapped(text: str, width: float, kind: str = "") -> list[str]:
    """Return a text as lines that fit into a width, pixels.  kind : of its letters, as of a label"""
    lines, width = [""], width / (_BOLD if kind == "title" else 1.0)
    for word in text.split(" "):
        longer = f"{lines[-1]} {word}".strip()
        lines = [*lines[:-1], longer] if text_width(longer) <= width or not lines[-1] else [*lines, word]
    return lines


@dataclass(frozen=True, slots=True)
class Label:
    """Words at a place.

    at : what they name; kind : "soft", "axis", "title" or "" for plain; size : of the letters
    first : where their middle would stand best, None for anywhere near; middle : where it stands
    """

    words: str
    at: Point
    kind: str = ""
    size: float = FONT
    first: Point | None = None
    middle: Point | None = None

    def bounds(self) -> Bounds:
        """Return what the words cover."""
        x, y = self.middle or self.at
        half = text_width(self.words, self.size) / 2
        return x - half, y - self.size * 0.62, x + half, y + self.size * 0.62

    def svg(self) -> str:
        """Return the words as SVG, with a rim in the colour of the ground."""
        x, y = self.middle or self.at
        return text(x, y + self.size * (0.5 - _DEEP / 2), self.words, self.kind, "middle", self.size)


def text(x: float, y: float, shown: str, kind: str = "", anchor: str = "start", size: float = FONT) -> str:
    """Return a line of text.  y : of the line that it stands on; anchor : start, middle or end"""
    colour = "var(--soft)" if kind == "soft" else "var(--ink)"
    weight = ' font-weight="600"' if kind in ("axis", "title") else ""
    rim = ' stroke="var(--paper)" stroke-width="4" stroke-linejoin="round" paint-order="stroke"'
    return words(shown, (x, y), size, colour, anchor, f"{weight}{rim}")


def placed(labels: Sequence[Label], frame: Bounds, over: Sequence[Bounds] = ()) -> list[Label]:
    """Return labels inside a frame, none over another.  over : what they leave free, too"""
    taken, found = list(over), list[Label]()
    for label in labels:
        tried = [_within(replace(label, middle=middle), frame) for middle in _candidates(label)]
        best = min(tried, key=lambda each: covered(each.bounds(), taken))
        clear = next((each for each in tried if not covered(each.bounds(), taken)), best)
        taken.append(clear.bounds())
        found.append(clear)
    return found


def _candidates(label: Label) -> Iterator[Point]:
    """Yield where the middle of a label may stand, the best first: round what it names, ever farther."""
    if label.first is not None:
        yield label.first
    half, high = text_width(label.words, label.size) / 2, label.size
    (x, y) = label.at
    for ring, step in itertools.product(range(1, 13), range(8)):
        turn = math.radians(-90.0 + 45.0 * (step // 2 if step % 2 == 0 else -(step + 1) // 2))
        across, down = math.cos(turn) * (half + 5.0 * ring), math.sin(turn) * high * (0.6 + 0.5 * ring)
        yield x + across, y + down


def _within(label: Label, frame: Bounds) -> Label:
    left, top, right, bottom = label.bounds()
    x, y = label.middle or label.at
    across = max(frame[0] - left, 0.0) - max(right - frame[2], 0.0)
    down = max(frame[1] - top, 0.0) - max(bottom - frame[3], 0.0)
    return replace(label, middle=(x + across, y + down))


def covered(bounds: Bounds, taken: Sequence[Bounds]) -> float:
    """Return how much of what is taken already these bounds cover, square pixels."""
    left, top, right, bottom = bounds
    covered = 0.0
    for other in taken:
        across = min(right, other[2]) - max(left, other[0]) + _APART
        down = min(bottom, other[3]) - max(top, other[1]) + _APART
        covered += max(across, 0.0) * max(down, 0.0)
    return covered


ColourScale = Sequence[tuple[float, str]]
"""(share from 0 to 1, "#rrggbb"), rising."""

_FINER = 4
"""Pixels of a map for each of its values along each side: the browser smooths the rest."""
_VARIABLE = re.compile(r'(?<==")var\(--([a-z-]+)\)(?=")')
"""As the value of an attribute; quotes in words are escaped, so that none of them is one."""


@cache
def page_colours() -> tuple[Mapping[str, str], Mapping[str, str]]:
    """Return the colours of pictures by name, as they are on paper, and on a dark screen."""
    text = resources.files("axiscal.present.drawing").joinpath("colours.toml").read_text(encoding="utf-8")
    colours = tomllib.loads(text)
    return colours["light"], colours["dark"]


def variables(svg: str, values: Mapping[str, str]) -> str:
    """Return values of the variables that a picture names, as CSS."""
    return "".join(f"--{name}:{value};" for name, value in values.items() if f"var(--{name})" in svg)


def on_paper(svg: str) -> str:
    """Return a picture with the colours of paper instead of the page's variables."""
    paper, _ = page_colours()
    return _VARIABLE.sub(lambda found: paper[found[1]], svg)


def map_image(rows: Sequence[Sequence[float]], scale: ColourScale, low: float, high: float, frame: Bounds) -> str:
    """Return a map as an image in a frame, a PNG (ISO/IEC 15948), its first row below.  rows : (m, n)"""
    finer = _stretched(_stretched(np.array(rows, dtype=float), 0), 1)[::-1]
    shares = [share for share, _ in scale]
    stops = np.array([[int(text[i : i + 2], 16) for i in (1, 3, 5)] for _, text in scale], dtype=float)
    at = np.clip((finer - low) / ((high - low) or 1.0), 0.0, 1.0)
    colours = np.stack([np.interp(at, shares, stops[:, k]) for k in range(3)], axis=-1)
    lines = b"".join(b"\x00" + row.tobytes() for row in np.rint(colours).astype(np.uint8))
    head = struct.pack(">IIBBBBB", colours.shape[1], colours.shape[0], 8, 2, 0, 0, 0)
    chunks = b"IHDR" + head, b"IDAT" + zlib.compress(lines, 9), b"IEND"
    framed = (struct.pack(">I", len(each) - 4) + each + struct.pack(">I", zlib.crc32(each)) for each in chunks)
    image = b"\x89PNG\r\n\x1a\n" + b"".join(framed)
    left, top, right, bottom = frame
    x, y, width, height = map(short_number, (left, top, right - left, bottom - top))
    address = f"data:image/png;base64,{base64.b64encode(image).decode('ascii')}"
    size = f'width="{width}" height="{height}" preserveAspectRatio="none"'
    return f'<image x="{x}" y="{y}" {size} href="{address}"/>'


def _stretched(values: Array, axis: int) -> Array:
    """Return values with lines between them along an axis."""
    count = values.shape[axis]
    at = np.linspace(0, count - 1, (count - 1) * _FINER + 1)
    lower = np.minimum(at.astype(int), max(count - 2, 0))
    share = np.expand_dims(at - lower, 1 - axis)
    upper = np.minimum(lower + 1, count - 1)
    mixed: Array = (1 - share) * np.take(values, lower, axis) + share * np.take(values, upper, axis)
    return mixed
