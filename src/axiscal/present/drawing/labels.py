"""Words in a picture: how wide they are, and where they stand so that none lies over another."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from axiscal.present.drawing.strokes import Point, short_number, text_safe

FONT = 14.0
"""Pixels of all words in a picture of a machine."""
_WIDE, _NARROW, _USUAL = 0.92, 0.34, 0.58
"""Widths of letters as shares of their height, on the wide side for the fonts that screens have."""
_DEEP = 0.28
"""Share of the height of letters that goes below the line they stand on."""
_APART = 2.0
"""Pixels between two labels."""

Bounds = tuple[float, float, float, float]
"""Left, top, right, bottom, pixels."""


def text_width(text: str, size: float = FONT) -> float:
    """Return about how wide a text is, pixels."""
    widths = (
        _WIDE if each in "mwMWOQGD@%×" else _NARROW if each in "iljftI.,;:'|!()[] ·′" else _USUAL for each in text
    )
    return size * sum(widths)


def wrapped(text: str, width: float) -> list[str]:
    """Return a text as lines that fit into a width, pixels."""
    lines = [""]
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


def text(x: float, y: float, words: str, kind: str = "", anchor: str = "start", size: float = FONT) -> str:
    """Return a line of text.  y : of the line that it stands on; anchor : start, middle or end"""
    colour = "var(--soft)" if kind == "soft" else "var(--ink)"
    weight = ' font-weight="600"' if kind in ("axis", "title") else ""
    rim = ' stroke="var(--paper)" stroke-width="4" stroke-linejoin="round" paint-order="stroke"'
    return (
        f'<text x="{short_number(x)}" y="{short_number(y)}" font-size="{size:g}" fill="{colour}" '
        f'text-anchor="{anchor}"{weight}{rim}>{text_safe(words)}</text>'
    )


def placed(labels: Sequence[Label], frame: Bounds) -> list[Label]:
    """Return labels inside a frame, none over another."""
    taken, found = list[Bounds](), list[Label]()
    for label in labels:
        tried = [_within(replace(label, middle=middle), frame) for middle in _candidates(label)]
        best = min(tried, key=lambda each: _covered(each.bounds(), taken))
        clear = next((each for each in tried if not _covered(each.bounds(), taken)), best)
        taken.append(clear.bounds())
        found.append(clear)
    return found


def _candidates(label: Label) -> Iterator[Point]:
    """Yield where the middle of a label may stand, the best first: round what it names, ever farther."""
    if label.first is not None:
        yield label.first
    half, high = text_width(label.words, label.size) / 2, label.size
    (x, y) = label.at
    for ring, step in itertools.product(range(1, 7), range(8)):
        turn = math.radians(-90.0 + 45.0 * (step // 2 if step % 2 == 0 else -(step + 1) // 2))
        across, down = math.cos(turn) * (half + 5.0 * ring), math.sin(turn) * high * (0.6 + 0.5 * ring)
        yield x + across, y + down


def _within(label: Label, frame: Bounds) -> Label:
    left, top, right, bottom = label.bounds()
    x, y = label.middle or label.at
    across = max(frame[0] - left, 0.0) - max(right - frame[2], 0.0)
    down = max(frame[1] - top, 0.0) - max(bottom - frame[3], 0.0)
    return replace(label, middle=(x + across, y + down))


def _covered(bounds: Bounds, taken: Sequence[Bounds]) -> float:
    """Return how much of what is taken already these bounds cover, square pixels."""
    left, top, right, bottom = bounds
    covered = 0.0
    for other in taken:
        across = min(right, other[2]) - max(left, other[0]) + _APART
        down = min(bottom, other[3]) - max(top, other[1]) + _APART
        covered += max(across, 0.0) * max(down, 0.0)
    return covered
