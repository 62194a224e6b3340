"""Elements of SVG as text: lines, words, colours.

Labels know how wide they are, and stand so that none lies over another.
"""

from __future__ import annotations

import itertools
import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from html import escape
from importlib import resources

Point = tuple[float, float]

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Signs that no XML document may hold (XML 1.0, 2.2)."""


def text_safe(text: str) -> str:
    """Return text for the inside of an element or an attribute; what XML cannot hold becomes a question mark."""
    return escape(_NO_XML.sub("?", text), quote=True)


_SLACK = 1e-9
"""Share of a step by which rounding may be off."""


def rounded_up(size: float) -> float:
    """Return the smallest of 1, 2, 5 times a power of ten that is not below size."""
    power = 10.0 ** math.floor(math.log10(size))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= size * (1 - _SLACK))


def rounded_down(size: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above size: whose inverse is another of them."""
    return 1 / rounded_up(1 / size)


def short_number(value: float) -> str:
    """Return a number of pixels to a tenth."""
    text = f"{value:.1f}"
    return ("0" if text == "-0.0" else text).removesuffix(".0")


def corners_way(corners: Iterable[Sequence[float]]) -> str:
    """Return the `d` of a line through all corners, each (x, y)."""
    return "M" + "L".join(f"{short_number(x)} {short_number(y)}" for x, y in corners)


def window(left: float, top: float, width: float, height: float, inside: str) -> str:
    """Return elements as far as they lie in a frame, pixels."""
    x, y, across, high = map(short_number, (left, top, width, height))
    return f'<svg x="{x}" y="{y}" width="{across}" height="{high}" viewBox="{x} {y} {across} {high}">{inside}</svg>'


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
    place = f'x="{short_number(x)}" y="{short_number(y)}"' + ("" if anchor == "start" else f' text-anchor="{anchor}"')
    ink = f'font-size="{size:g}" fill="var(--{"soft" if kind == "soft" else "ink"})"'
    weight = ' font-weight="600"' if kind in ("axis", "title") else ""
    rim = ' stroke="var(--paper)" stroke-width="4" stroke-linejoin="round" paint-order="stroke"'
    return f"<text {place} {ink}{weight}{rim}>{text_safe(shown)}</text>"


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
