"""The error of the volume in three dimensions: arrows as found and as left, and how well they are known, side by side.

Each picture is drawn in Python as it is seen at first; the page's script turns all of them together.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.language.spoken import said
from axiscal.report.digits import numbers
from axiscal.report.drawing.colours import ColourScale, colour_of, map_image
from axiscal.report.drawing.strokes import short_number, text_safe, title, words
from axiscal.report.sentences import figure, quantity
from axiscal.report.volume_error import Triple, VolumeError

_WIDTH, _HEIGHT, _MARGIN = 300, 280, 26
"""Pixels; a matter of taste."""
_TURN, _TILT = -35.0, 24.0
"""Degrees about the vertical and down from the horizon, as the volume is seen at first; a matter of taste."""
_REACH = 0.16
"""Share of the volume's size that the longest arrow has; a matter of taste."""
_BEYOND = 1.09
"""Lengths of an edge at which its name stands; a matter of taste."""
_SIZES: ColourScale = ((0.0, "#2f6f9f"), (0.5, "#8a7f78"), (1.0, "#c2491d"))
"""From small to large; a matter of taste."""
_WIDER: ColourScale = ((0.0, "#4f8a5b"), (1.0, "#8a3d8f"))
"""From known to unknown; a matter of taste."""


@dataclass(frozen=True, slots=True)
class VolumePanel:
    """One picture: what it shows, in a few words, and the SVG."""

    name: str
    note: str
    svg: str


@dataclass(frozen=True, slots=True)
class _Look:
    """What the three pictures have in common.  scale : pixels for a millimetre; magnified : of arrows, mm for a um"""

    middle: Triple
    scale: float
    magnified: float
    largest: float


def volume_panels(volume: VolumeError) -> list[VolumePanel]:
    """Return the pictures: as found, as left where there are tables, and ±; arrows of one scale and colours."""
    look = _look(volume)
    panels = [VolumePanel(said("As found"), _largest_words(volume.found_um), _arrows(volume, volume.found_um, look))]
    if volume.left_um:
        left = said(
            "with the tables for {controller}, as estimated; {largest}",
            controller=volume.controller,
            largest=_largest_words(volume.left_um),
        )
        panels.append(VolumePanel(said("As left"), left, _arrows(volume, volume.left_um, look)))
    known = said("95 % along x, y and z; {largest}", largest=_largest_words(volume.half_um))
    return [*panels, VolumePanel(said("How well that is known"), known, _crosses(volume, look))]


def magnification(volume: VolumeError) -> float:
    """Return by how many times arrows are longer than what they show."""
    return _look(volume).magnified * 1e3


def _largest_words(vectors: Sequence[Triple]) -> str:
    return said("largest {size}", size=quantity(_size(vectors), "um"))


def _size(vectors: Sequence[Triple]) -> float:
    return max(math.hypot(*vector) for vector in vectors)


def _look(volume: VolumeError) -> _Look:
    sides = [(min(each), max(each)) for each in zip(*volume.tcp_mm, strict=True)]
    x, y, z = ((low + high) / 2 for low, high in sides)
    extent = math.hypot(*(high - low for low, high in sides)) or 1.0
    largest = max(_size(volume.found_um), _size(volume.half_um)) or 1.0
    power = _REACH * extent / largest
    corners = [(a - x, b - y, c - z) for a in sides[0] for b in sides[1] for c in sides[2]]
    seen = [_turned(corner) for corner in corners]
    across, up = (max(abs(each[k]) for each in seen) or 1.0 for k in (0, 1))
    scale = min((_WIDTH / 2 - _MARGIN) / across, (_HEIGHT / 2 - _MARGIN) / up)
    return _Look((x, y, z), scale, _round_down(power), max(_size(volume.found_um), 1e-9))


def _round_down(value: float) -> float:
    power = 10.0 ** math.floor(math.log10(value))
    return float(max(factor for factor in (1, 2, 5) if factor * power <= value)) * power


def _seen(point: Triple, look: _Look) -> tuple[float, float]:
    """Return where a place of the workpiece frame, mm, stands in the picture: turned, tilted, without perspective."""
    x, y, z = (each - centre for each, centre in zip(point, look.middle, strict=True))
    across, up = _turned((x, y, z))
    return _WIDTH / 2 + look.scale * across, _HEIGHT / 2 - look.scale * up


def _turned(place: Triple) -> tuple[float, float]:
    """Return what lies to the right and up of a place, turned about the vertical and tilted."""
    (x, y, z), turn, tilt = place, math.radians(_TURN), math.radians(_TILT)
    depth = x * math.sin(turn) + y * math.cos(turn)
    return x * math.cos(turn) - y * math.sin(turn), z * math.cos(tilt) + depth * math.sin(tilt)


def _arrows(volume: VolumeError, vectors: Sequence[Triple], look: _Look) -> str:
    """Return arrows from the places to where the tool is, magnified, dots at the places."""
    parts = []
    for place, vector in zip(volume.tcp_mm, vectors, strict=True):
        tip = _moved(place, vector, look.magnified)
        hue = colour_of(math.hypot(*vector), _SIZES, 0.0, look.largest)
        what = f"{_place_words(place)}: {_vector_words(vector)}"
        parts.append(f'<g stroke="{hue}" fill="{hue}">{title(what)}{_line(place, tip, look, 1.6)}{_dot(tip, look)}</g>')
    return _picture(volume, "".join(parts), look, _SIZES, look.largest, said("length of the arrows"))


def _crosses(volume: VolumeError, look: _Look) -> str:
    """Return a cross at each place, its arms ± along x, y and z, as magnified as the arrows."""
    largest, parts = _size(volume.half_um) or 1.0, []
    for place, half in zip(volume.tcp_mm, volume.half_um, strict=True):
        hue = colour_of(math.hypot(*half), _WIDER, 0.0, largest)
        arms = []
        for k in range(3):
            arm = [half[k] if j == k else 0.0 for j in range(3)]
            low, high = (_moved(place, (arm[0], arm[1], arm[2]), sign * look.magnified) for sign in (-1, 1))
            arms.append(_line(low, high, look, 1.4))
        parts.append(f'<g stroke="{hue}">{title(f"{_place_words(place)}: ± {_vector_words(half)}")}{"".join(arms)}</g>')
    return _picture(volume, "".join(parts), look, _WIDER, largest, said("± in space"))


def _moved(place: Triple, vector: Triple, magnified: float) -> Triple:
    x, y, z = (at + magnified * by for at, by in zip(place, vector, strict=True))
    return x, y, z


def _line(start: Triple, end: Triple, look: _Look, width: float) -> str:
    (x0, y0), (x1, y1) = _seen(start, look), _seen(end, look)
    d = f"M{short_number(x0)} {short_number(y0)}L{short_number(x1)} {short_number(y1)}"
    return f'<path d="{d}" stroke-width="{width:g}" data-ends="{_six(start, end)}"/>'


def _dot(at: Triple, look: _Look) -> str:
    x, y = _seen(at, look)
    return f'<circle cx="{short_number(x)}" cy="{short_number(y)}" r="2" stroke="none" data-at="{_six(at)}"/>'


def _six(*places: Triple) -> str:
    return " ".join(f"{each:g}" for place in places for each in numbers(place, "a place of the volume"))


def _picture(volume: VolumeError, inside: str, look: _Look, scale: ColourScale, largest: float, what: str) -> str:
    view = json.dumps([*numbers([*look.middle, look.scale], "view"), _WIDTH / 2, _HEIGHT / 2, _TURN, _TILT])
    return (
        f'<svg class="picture space" viewBox="0 0 {_WIDTH} {_HEIGHT + 40}" width="{_WIDTH}" height="{_HEIGHT + 40}" '
        f'role="img" aria-label="{text_safe(said("Error of the volume"))}" data-view3="{text_safe(view)}">'
        f'<g fill="none">{_box(volume, look)}{inside}</g>{_bar(scale, largest, what)}</svg>'
    )


def _box(volume: VolumeError, look: _Look) -> str:
    """Return the edges of the box around all places, and the names of its directions."""
    sides = [(min(each), max(each)) for each in zip(*volume.tcp_mm, strict=True)]
    corners = [(x, y, z) for x in sides[0] for y in sides[1] for z in sides[2]]
    edges = [
        (a, b)
        for i, a in enumerate(corners)
        for b in corners[i + 1 :]
        if sum(p != q for p, q in zip(a, b, strict=True)) == 1
    ]
    lines = "".join(_line(a, b, look, 1) for a, b in edges)
    first = corners[0]
    names = []
    for k, (low, high) in enumerate(sides):
        if high > low:
            x, y, z = (first[j] + (_BEYOND * (high - low) if j == k else 0.0) for j in range(3))
            at, place = _seen((x, y, z), look), f' data-at="{_six((x, y, z))}" data-down="4"'
            names.append(words("xyz"[k], (at[0], at[1] + 4), 12, "var(--soft)", "middle", place))
    return f'<g stroke="var(--rule)">{lines}</g>{"".join(names)}'


def _bar(scale: ColourScale, largest: float, what: str) -> str:
    """Return the bar of colours under a picture, from nought to the largest."""
    left, width, top = 50, _WIDTH - 100, _HEIGHT + 8
    steps = [[largest * k / 16 for k in range(17)]] * 2
    image = map_image(steps, scale, 0.0, largest)
    place = f'x="{left}" y="{top}" width="{width}" height="7" preserveAspectRatio="none"'
    return (
        f'<image {place} href="{image}"/>'
        + words("0", (left, top + 21), 11.5, "var(--soft)", "middle")
        + words(quantity(largest, "um"), (left + width, top + 21), 11.5, "var(--soft)", "middle")
        + words(what, (_WIDTH / 2, top + 21), 11.5, "var(--soft)", "middle")
    )


def _place_words(place: Triple) -> str:
    return _components(place) + " mm"


def _vector_words(vector: Triple) -> str:
    return _components(vector) + " µm"


def _components(vector: Triple) -> str:
    return said("x {x}, y {y}, z {z}", **{name: figure(value) for name, value in zip("xyz", vector, strict=True)})
