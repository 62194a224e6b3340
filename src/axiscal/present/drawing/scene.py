"""Scenes of lines, arrows and words in metres, drawn as SVG from the front, the right and above.

Words know how wide they are, and stand so that none lies over another.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from importlib import resources
from typing import NamedTuple

import numpy as np

from axiscal.numerics import Array

_TURN, _LIFT = np.radians(33.0), np.radians(27.0)
"""How far who looks stands to the right of the front, and above the floor, rad; a matter of taste."""
RIGHT: Array = np.array([np.cos(_TURN), np.sin(_TURN), 0.0])
"""Unit vector of the scene that runs to the right in the picture."""
UP: Array = np.array([-np.sin(_TURN) * np.sin(_LIFT), np.cos(_TURN) * np.sin(_LIFT), np.cos(_LIFT)])
"""Unit vector of the scene that runs up in the picture."""
EYE: Array = np.cross(RIGHT, UP)
"""Unit vector towards who looks."""
_HEAD, _HALF_HEAD, _MARGIN = 11.0, 4.5, 14.0
"""Pixels of the head of an arrow, and around what is drawn, for the names of arrows; a matter of taste."""
_FONT, LINE = 14.0, 20.0
"""Pixels of letters, and from one line of words to the next."""
_WIDE, _NARROW, _USUAL, _BOLD = 0.92, 0.34, 0.6, 1.1
"""Widths of letters as shares of their height, on the wide side for the fonts that screens have; of bold ones of plain.
"""
_HALF_LINE, _DEEP, _APART = 0.62, 0.28, 2.0
"""Shares of the height of letters: half of what a line covers, and what goes below it; pixels between two labels."""
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Signs that no XML document may hold (XML 1.0, 2.2)."""
_VARIABLE = re.compile(r'(?<==")var\(--([a-z-]+)\)(?=")')
"""As the value of an attribute; quotes in words are escaped, so that none of them is one."""
_ON_SCREEN = "system-ui,-apple-system,'Segoe UI',Roboto,'Noto Sans','Liberation Sans','DejaVu Sans',sans-serif"
_ON_PAPER = "Libertinus Serif"
"""One of the letters that the typesetter brings along."""


class Drawing(NamedTuple):
    """A picture.  width, height : pixels; body : SVG elements"""

    width: float
    height: float
    body: str

    def on_paper(self) -> str:
        """Return the text of an SVG file in the colours of paper."""
        body = _VARIABLE.sub(lambda found: _colours()["light"][found[1]], self.body)
        return f'<svg xmlns="http://www.w3.org/2000/svg" font-family="{_ON_PAPER}" {self._size}>{body}</svg>'

    def on_screen(self, label: str) -> str:
        """Return the text of an SVG file, in the colours of a light or a dark screen.  label : for who hears it"""
        light, dark = (
            "".join(f"--{name}:{value};" for name, value in values.items()) for values in _colours().values()
        )
        style = f":root{{{light}font-family:{_ON_SCREEN};max-width:100%;height:auto}}"
        style += f"@media(prefers-color-scheme:dark){{:root{{{dark}}}}}"
        name = _safe(label)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" {self._size} role="img" aria-label="{name}"><title>{name}</title>'
            f'<style>{style}</style><rect width="100%" height="100%" fill="var(--paper)"/>{self.body}</svg>\n'
        )

    @property
    def _size(self) -> str:
        width, height = f"{self.width:g}", f"{self.height:g}"
        return f'viewBox="0 0 {width} {height}" width="{width}" height="{height}"'


@cache
def _colours() -> Mapping[str, Mapping[str, str]]:
    """Return the colours by name, "light" as on paper, then "dark"."""
    return tomllib.loads(resources.files(__package__).joinpath("colours.toml").read_text(encoding="utf-8"))


def _safe(words: str) -> str:
    """Return text for the inside of an element or an attribute; what XML cannot hold becomes a question mark."""
    return escape(_NO_XML.sub("?", words), quote=True)


def _width(words: str, size: float = _FONT) -> float:
    """Return about how wide a text is, pixels."""
    widths = (
        _WIDE if each in "mwMWOQGD@%×" else _NARROW if each in "iljftI.,;:'|!()[] ·′" else _USUAL for each in words
    )
    return size * sum(widths)


def wrapped(words: str, width: float, kind: str = "") -> list[str]:
    """Return a text as lines that fit into a width, pixels; none for "".  kind : of its letters, as of `text`"""
    lines, width = list[str](), width / (_BOLD if kind == "title" else 1.0)
    for word in words.split():
        longer = f"{lines[-1]} {word}" if lines else word
        lines = [*lines[:-1], longer] if _width(longer) <= width or not lines else [*lines, word]
    return lines


def text(x: float, y: float, shown: str | Sequence[str], kind: str = "", anchor: str = "start") -> str:
    """Return words, or lines below each other, with a rim in the colour of the ground.

    y : of the line that the first stands on; anchor : start, middle or end
    kind : "soft", "axis" for the name of an arrow, "title" or "" for plain
    """
    size, weight = _size_of(kind), ' font-weight="600"' if kind in ("axis", "title") else ""
    ink = f'font-size="{size:g}" fill="var(--{"soft" if kind == "soft" else "ink"})"{weight}'
    rim = ' stroke="var(--paper)" stroke-width="4" stroke-linejoin="round" paint-order="stroke"'
    return "".join(
        f'<text x="{x:.1f}" y="{y + LINE * n:.1f}" text-anchor="{anchor}" {ink}{rim}>{_safe(line)}</text>'
        for n, line in enumerate([shown] if isinstance(shown, str) else shown)
    )


def _size_of(kind: str) -> float:
    return _FONT + 2 if kind == "axis" else _FONT


@dataclass(frozen=True, eq=False, slots=True)
class Stroke:
    """A line.  points : (n, 3) m; width : pixels; filled : colour of what it encloses, "" for none"""

    points: Array
    colour: str
    width: float = 1.5
    dash: str = "none"
    opacity: float = 1.0
    filled: str = ""
    words = ""

    def svg(self, at: Array) -> str:
        """Return it as SVG.  at : where its points stand, (n, 2) pixels"""
        inside = f'"var(--{self.filled})" fill-opacity=".35"' if self.filled else '"none"'
        return (
            f'<path d="{_way(at)}" fill={inside} stroke="var(--{self.colour})" stroke-width="{self.width:g}" '
            f'stroke-dasharray="{self.dash}" stroke-opacity="{self.opacity:g}" stroke-linejoin="round" '
            'stroke-linecap="round"/>'
        )


@dataclass(frozen=True, eq=False, slots=True)
class RoundMark:
    """A ball or a dot, with words beside it.  points : its centre, (3,) m; reach : its radius, pixels"""

    points: Array
    colour: str
    reach: float
    words: str = ""

    def svg(self, at: Array) -> str:
        """Return it as SVG without its words, as `Stroke.svg`."""
        place = f'cx="{at[0, 0]:.1f}" cy="{at[0, 1]:.1f}" r="{self.reach:g}"'
        return f'<circle {place} fill="var(--{self.colour})" stroke="var(--paper)" stroke-width="1"/>'


@dataclass(frozen=True, eq=False, slots=True)
class Arrow:
    """A way with a head at its end and a name there.  points : (n, 3) m, straight where there are two"""

    points: Array
    words: str
    colour: str = "ink"
    reach = _HALF_HEAD

    def svg(self, at: Array) -> str:
        """Return it as SVG without its name, as `Stroke.svg`."""
        tip, along = at[-1], _last_way(at)
        across, neck = np.array([-along[1], along[0]]), tip - _HEAD * along
        shaft = np.vstack([at[:-1][np.hypot(*(at[:-1] - tip).T) > _HEAD], neck])
        head = _way([tip, neck + _HALF_HEAD * across, neck - _HALF_HEAD * across]) + "z"
        colour = f'"var(--{self.colour})"'
        return (
            f'<path d="{_way(shaft)}" fill="none" stroke={colour} stroke-width="2.4"/><path d="{head}" fill={colour}/>'
        )


Part = Stroke | RoundMark | Arrow


Frame = tuple[float, float, float, float]
"""Left, top, width and height, pixels."""


def flat(points: Array) -> Array:
    """Return points of a scene as seen, (n, 2) m, right and down.  points : (n, 3) m"""
    return np.stack([points @ RIGHT, -(points @ UP)], axis=1)


def fitted(points: Array, frame: Frame) -> tuple[float, Array]:
    """Return scale and shift (2,) by which points, (n, 3) m, are as large as a frame allows: scale · seen + shift."""
    seen = flat(points)
    low, high = seen.min(axis=0), seen.max(axis=0)
    corner, size = np.array(frame[:2]), np.array(frame[2:])
    scale = float(((size - 2 * _MARGIN) / np.maximum(high - low, 1e-12)).min())
    return scale, corner + size / 2 - scale * (low + high) / 2


def drawn(parts: Sequence[Part], frame: Frame, within: Array | None = None) -> str:
    """Return a scene as SVG elements, as large as its frame allows; what lies outside of the frame is cut off.

    within : points that fill the frame, (n, 3) m, in place of those of the parts; several scenes get one scale by it
    """
    scale, shift = fitted(np.vstack([part.points for part in parts]) if within is None else within, frame)
    placed = [(part, flat(np.atleast_2d(part.points)) * scale + shift) for part in parts]
    inside, place = "".join(part.svg(at) for part, at in placed), "{:.1f} {:.1f} {:.1f} {:.1f}".format(*frame)
    x, y, wide, high = place.split()
    cut = f'<svg x="{x}" y="{y}" width="{wide}" height="{high}" viewBox="{place}">{inside}</svg>'
    return cut + "".join(_names(placed, frame))


def _names(placed: Iterable[tuple[Part, Array]], frame: Frame) -> Iterator[str]:
    """Yield the words of parts inside of a frame, none over another, over a ball or over a head.

    placed : parts, and where their points stand, pixels
    """
    marks = [(part, at) for part, at in placed if not isinstance(part, Stroke)]
    taken = [np.concatenate([at[-2:].min(axis=0) - part.reach, at[-2:].max(axis=0) + part.reach]) for part, at in marks]
    corner = np.array(frame[:2])
    for part, at in (each for each in marks if each[0].words):
        kind = "axis" if isinstance(part, Arrow) else "soft"
        size = _size_of(kind)
        half = np.array([_width(part.words, size) / 2, _HALF_LINE * size])
        tried = at[-1] + _around(half[0], size)
        if isinstance(part, Arrow):  # first of all ahead of it
            along = _last_way(at)
            tried = np.vstack([at[-1] + (6.0 + np.abs(along) @ [half[0], _FONT / 2]) * along, tried])
        tried = np.minimum(np.maximum(tried, corner + half), corner + np.array(frame[2:]) - half)
        boxes, others = np.hstack([tried - half, tried + half])[:, None], np.array(taken)
        over = np.minimum(boxes, others)[..., 2:] - np.maximum(boxes, others)[..., :2] + _APART
        best = int(np.argmin(np.maximum(over, 0.0).prod(axis=2).sum(axis=1)))  # the first that covers nothing
        taken.append(boxes[best, 0])
        x, y = tried[best]
        yield text(x, y + size * (0.5 - _DEEP / 2), part.words, kind, "middle")


def _around(half: float, size: float) -> Array:
    """Return where the middle of words may stand beside what they name, the best first: above, and ever farther.

    half : of their width, pixels; the result (n, 2)
    """
    turns = np.radians([-90.0, -135.0, -45.0, -180.0, 0.0, -225.0, 45.0, -270.0])
    rings = np.arange(1, 13)[:, None]
    across, down = np.cos(turns) * (half + 5.0 * rings), np.sin(turns) * size * (0.6 + 0.5 * rings)
    return np.stack([across.ravel(), down.ravel()], axis=1)


def _last_way(at: Array) -> Array:
    """Return the direction in which an arrow ends, a unit vector, (2,)."""
    along = at[-1] - at[-2]
    direction: Array = along / max(float(np.hypot(*along)), 1e-9)
    return direction


def _way(corners: Iterable[Sequence[float] | Array]) -> str:
    """Return the `d` of a line through all corners, each (x, y)."""
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in corners)
