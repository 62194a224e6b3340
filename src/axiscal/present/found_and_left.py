"""The picture that a report begins with: the machine's errors as bent axes, found beside left, enlarged on one scale.

    picture = found_and_left_drawing(volume, 1110)

Thin lines are machines that the readings still allow: without them what is left would look like a perfect box.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from axiscal.language.spoken import said
from axiscal.numerics import Array
from axiscal.present.drawing.scene import EYE, Arrow, Fit, Part, Stroke, Viewport, drawn, points_of
from axiscal.present.drawing.strokes import rounded_down, rounded_up, short_number, text, wrapped
from axiscal.present.drawing.svg_picture import Drawing
from axiscal.present.schematic import DrawnMachine
from axiscal.present.volume_error import MACHINES, BentVolume, sides_of

_FLAT = 0.05
"""Of the longest side: a shorter one is the height of something flat."""
_SHARE = 0.1
"""Of the shortest side, that the largest deviation has."""
_LINE, _SIDE = 20.0, 12.0
"""Pixels of a line of words, and between the picture and its edge."""
_BESIDE = 700.0
"""Pixels from which on both are beside each other, and below which one is under the other."""
_BAR = 60.0
"""Pixels of the bar that shows the scale, at most."""


def found_and_left_drawing(volume: BentVolume, width: float) -> Drawing:
    """Return the picture for a width, pixels."""
    home = np.array([0.0 if axis.rotary else sum(axis.travel) / 2 for axis in volume.machine.axes])
    times, room = magnification(volume), DrawnMachine(volume.machine, home)
    panels = [(said("found"), volume.found, "beam")]
    if volume.left is not None:
        title = said("left with the tables for {controller}", controller=volume.controller)
        panels.append((title, volume.left, "read"))
    beside = width >= _BESIDE
    across = width / len(panels) if beside else width
    high = round(across * (0.72 if len(panels) > 1 or not beside else 0.5))
    moved = [volume.tcp + times * (each + one) for each in _of_all(volume) for one in (*volume.allowed, 0.0)]
    arrows = points_of(list(_triad(volume, room)))
    around = np.vstack([*(_in_room(room, each).reshape(-1, 3) for each in moved), arrows])  # of both: one scale
    heads = [wrapped(title, across - 2 * _SIDE, "title") for title, _, _ in panels]
    panel = Viewport(0, 0, across - 2 * _SIDE, high)
    body, head = "", _LINE * max(map(len, heads)) + 10
    for n, (_, values, colour) in enumerate(panels):
        x, y = (n * across, 0.0) if beside else (0.0, n * (high + head))
        for line, each in enumerate(heads[n]):
            body += text(x + _SIDE, y + 18 + _LINE * line, each, "title")
        frame = replace(panel, left=x + _SIDE, top=y + head)
        shown = [*_bent(volume, room, values, times, colour), *_triad(volume, room)]
        body += drawn(shown, frame, around)
    scale, top = Fit.into(around, panel).scale, (high + head) * (1 if beside else len(panels))
    parts = [said("errors × {times}", times=f"{times:,.0f}".replace(",", "\u202f") if times >= 1 else f"{times:g}")]
    if volume.aligned:
        parts.append(said("part aligned"))
    parts += [said("dashed: without errors"), said("thin: {count} machines that fit", count=MACHINES)]
    lines = wrapped(" · ".join(parts), width - 2 * _SIDE)
    body += _scale_bar(scale * times, top + 8)
    body += "".join(text(_SIDE, top + 37 + _LINE * n, each, "soft") for n, each in enumerate(lines))
    return Drawing(width, top + 32 + _LINE * len(lines), body)


def magnification(volume: BentVolume) -> float:
    """Return by how many times deviations are enlarged: the nearest 1, 2 or 5 times a power of ten.

    The largest of all that are drawn is then about a tenth of the shortest side; of a bed its height is none.
    """
    drawn_ones = [each + one for each in _of_all(volume) for one in (*volume.allowed, 0.0)]
    largest = max(float(np.linalg.norm(each, axis=-1).max()) for each in drawn_ones)
    sides = sides_of(volume.tcp)
    shortest = min((side for side in sides if side > _FLAT * max(sides)), default=1.0)
    wanted = _SHARE * shortest / max(largest, 1e-12)
    return min(rounded_down(wanted), rounded_up(wanted), key=lambda step: abs(math.log10(step / wanted)))


def _of_all(volume: BentVolume) -> list[Array]:
    return [volume.found] if volume.left is None else [volume.found, volume.left]


def _in_room(room: DrawnMachine, grid: Array) -> Array:
    return room.on_table(grid.reshape(-1, 3), turned=False).reshape(grid.shape)


def _bent(volume: BentVolume, room: DrawnMachine, values: Array, times: float, colour: str) -> Iterator[Part]:
    """Yield the volume as drawn, machines that the readings allow, and the bent one over them."""
    nominal = _in_room(room, volume.tcp)
    yield from (Stroke(each, "soft", 1.0, "4 4", 0.9) for each in _lines(nominal, nominal, edges=True))
    for one in volume.allowed:
        bent = _in_room(room, volume.tcp + times * (values + one))
        yield from (Stroke(each, colour, 1.0, opacity=0.5) for each in _lines(nominal, bent, edges=True))
    bent = _in_room(room, volume.tcp + times * values)
    yield from (Stroke(each, colour, 0.8, opacity=0.8) for each in _lines(nominal, bent, edges=False))
    yield from (Stroke(each, colour, 1.9) for each in _lines(nominal, bent, edges=True))


def _lines(nominal: Array, grid: Array, edges: bool) -> Iterator[Array]:
    """Yield the lines of a grid, (a, b, c, 3) m: its edges, or those between them on the faces that are seen into.

    nominal : the grid before it is bent, which says what lies behind
    """
    counts, behind = grid.shape[:3], [_behind(nominal, way) for way in range(3)]
    for along in range(3):
        if counts[along] < 2:
            continue
        u, v = (k for k in range(3) if k != along)
        for i, j in itertools.product(range(counts[u]), range(counts[v])):
            outer = [i in (0, counts[u] - 1), j in (0, counts[v] - 1)]
            far = [i == behind[u], j == behind[v]]
            if all(outer) if edges else any(far) and not all(outer):
                at: list[int | slice] = [slice(None)] * 3
                at[u], at[v] = i, j
                yield grid[tuple(at)]


def _behind(grid: Array, way: int) -> int:
    """Return the index of the end of a grid along one of its directions that lies away from who looks."""
    near, far = (grid.take(end, axis=way).reshape(-1, 3).mean(axis=0) @ EYE for end in (0, -1))
    return 0 if near <= far else grid.shape[way] - 1


def _triad(volume: BentVolume, room: DrawnMachine) -> Iterator[Arrow]:
    """Yield x, y and z of the workpiece beside the front corner on the left."""
    size = max(sides_of(volume.tcp), default=1.0)
    low = volume.tcp.reshape(-1, 3).min(axis=0)
    ends = _in_room(room, np.array([low, *(low + 0.12 * size * np.eye(3))]))
    away = size * np.array([-0.24, -0.06, 0.0])
    for name, end in zip("xyz", ends[1:], strict=True):
        yield Arrow(np.array([ends[0], end]) + away, name)


def _scale_bar(per_metre: float, y: float) -> str:
    """Return a bar of a round length with that length.  per_metre : pixels for a metre of deviation"""
    size = rounded_down(_BAR / per_metre * 1e6)
    pixels = size * 1e-6 * per_metre
    d = f"M{short_number(_SIDE)} {short_number(y)}v8h{short_number(pixels)}v-8"
    bar = f'<path d="{d}" fill="none" stroke="var(--ink)" stroke-width="1.6"/>'
    return bar + text(_SIDE + pixels + 8, y + 9, f"{size:g} µm")
