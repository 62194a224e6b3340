"""The picture that a report begins with: the machine's errors as bent axes, found beside left, enlarged on one scale.

    picture = found_and_left_drawing(result.volume, machine, 1110)

Thin lines hold 95 % between them: without them what is left would look like a perfect box.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from axiscal.language.spoken import said
from axiscal.numerics import Array
from axiscal.present.drawing.scene import (
    EYE,
    LINE,
    Arrow,
    Drawing,
    Part,
    Stroke,
    drawn,
    fitted,
    text,
    wrapped,
)
from axiscal.present.result import VolumeFigures
from axiscal.present.schematic import upright
from axiscal_core.machine import Machine

_STEPS = [leading * 10.0**power for power in range(-6, 10) for leading in (1, 2, 5)]
"""Round sizes."""
_FLAT = 0.05
"""Of the longest side: a shorter one is the height of something flat."""
_SHARE = 0.1
"""Of the shortest side, that the largest deviation has."""
_SIDE = 12.0
"""Pixels between the picture and its edge."""
_BESIDE = 700.0
"""Pixels from which on both are beside each other, and below which one is under the other."""
_BAR = 60.0
"""Pixels of the bar that shows the scale, at most."""


def found_and_left_drawing(volume: VolumeFigures, machine: Machine, width: float) -> Drawing:
    """Return the picture for a width, pixels."""
    nominal, half, *deviations = _grids(volume, machine)
    times, beside = magnification(volume), width >= _BESIDE
    titles = [said("found"), said("left with the tables for {controller}", controller=volume.controller)]
    across = width / len(deviations) if beside else width
    high = round(across * (0.72 if len(deviations) > 1 or not beside else 0.5))
    triad = list(_triad(volume, machine))
    shown = (nominal + times * (each + side * half) for each in deviations for side in (-1, 0, 1))
    around = np.vstack([*(each.reshape(-1, 3) for each in shown), *(arrow.points for arrow in triad)])  # one scale
    heads = [wrapped(title, across - 2 * _SIDE, "title") for title in titles[: len(deviations)]]
    body, head = "", LINE * max(map(len, heads)) + 10
    for n, (deviation, colour) in enumerate(zip(deviations, ("beam", "read"), strict=False)):
        x, y = (n * across, 0.0) if beside else (0.0, n * (high + head))
        body += text(x + _SIDE, y + 18, heads[n], "title")
        frame = (x + _SIDE, y + head, across - 2 * _SIDE, high)
        body += drawn([*_bent(nominal, times * deviation, times * half, colour), *triad], frame, around)
    scale, top = fitted(around, (0, 0, across - 2 * _SIDE, high))[0], (high + head) * (1 if beside else len(deviations))
    size = f"{times:,.0f}".replace(",", "\u202f") if times >= 1 else f"{times:g}"
    parts = [said("errors × {times}", times=size), said("dashed: without errors"), said("between thin lines: 95 %")]
    lines = wrapped(" · ".join(parts), width - 2 * _SIDE)
    body += _scale_bar(1e-3 * scale * times, top + 8) + text(_SIDE, top + 37, lines, "soft")
    return Drawing(width, top + 32 + LINE * len(lines), body)


def _grids(volume: VolumeFigures, machine: Machine) -> Iterator[Array]:
    """Yield the volume in the room, (a, b, c, 3) mm each: nominal places, ± of deviations outwards, and deviations."""
    shape, tcp = (*volume.counts, *(1,) * (3 - len(volume.counts)), 3), np.array(volume.tcp_mm)
    away = tcp - (tcp.min(axis=0) + tcp.max(axis=0)) / 2
    outwards = np.where(np.ptp(tcp, axis=0) > 0, np.sign(away), 1.0)
    each = [1e3 * tcp, outwards * volume.half_um, volume.found_um, volume.left_um]
    yield from ((1e-3 * np.array(some) @ upright(machine).T).reshape(shape) for some in each if len(some))


def magnification(volume: VolumeFigures) -> float:
    """Return by how many times deviations are enlarged: the nearest 1, 2 or 5 times a power of ten.

    The largest of all that are drawn is then about a tenth of the shortest side; of a bed its height is none.
    """
    half = np.linalg.norm(volume.half_um, axis=1)
    ends = [np.linalg.norm(each, axis=1) + half for each in (volume.found_um, volume.left_um) if len(each)]
    largest, sides = 1e-3 * max(float(each.max()) for each in ends), np.ptp(np.array(volume.tcp_mm), axis=0)
    shortest = min((side for side in sides.tolist() if side > _FLAT * max(sides)), default=1.0)
    wanted = _SHARE * shortest / max(largest, 1e-9)
    return min(_STEPS, key=lambda step: abs(math.log10(step / wanted)))


def _bent(nominal: Array, away: Array, half: Array, colour: str) -> Iterator[Part]:
    """Yield the volume as drawn, between which it is, and the bent one over them.  away, half : as enlarged, mm"""
    yield from (Stroke(each, "soft", 1.0, "4 4", 0.9) for each in _lines(nominal, nominal, edges=True))
    for side in (-1, 1):
        between = nominal + away + side * half
        yield from (Stroke(each, colour, 1.0, opacity=0.5) for each in _lines(nominal, between, edges=True))
    yield from (Stroke(each, colour, 0.8, opacity=0.8) for each in _lines(nominal, nominal + away, edges=False))
    yield from (Stroke(each, colour, 1.9) for each in _lines(nominal, nominal + away, edges=True))


def _lines(nominal: Array, grid: Array, edges: bool) -> Iterator[Array]:
    """Yield the lines of a grid, (a, b, c, 3) mm: its edges, or those between them on the faces that are seen into.

    nominal : the grid before it is bent, which says what lies behind
    """
    for along in range(3):
        counts = np.delete(grid.shape[:3], along)
        behind = [_behind(nominal, way) for way in range(3) if way != along]
        for at in np.ndindex(*counts) if grid.shape[along] > 1 else ():
            outer, far = np.isin(at, [0]) | (at == counts - 1), np.equal(at, behind)
            if outer.all() if edges else far.any() and not outer.all():
                yield np.moveaxis(grid, along, 2)[at]


def _behind(grid: Array, way: int) -> int:
    """Return the index of the end of a grid along one of its directions that lies away from who looks."""
    near, far = (grid.take(end, axis=way).reshape(-1, 3).mean(axis=0) @ EYE for end in (0, -1))
    return 0 if near <= far else grid.shape[way] - 1


def _triad(volume: VolumeFigures, machine: Machine) -> Iterator[Arrow]:
    """Yield x, y and z of the workpiece beside the front corner on the left."""
    low, sides = np.min(volume.tcp_mm, axis=0), np.ptp(np.array(volume.tcp_mm), axis=0)
    size = float(sides.max()) or 1.0
    foot, *ends = np.array([low, *(low + 0.12 * size * np.eye(3))]) @ upright(machine).T
    away = size * np.array([-0.24, -0.06, 0.0])
    for name, end in zip("xyz", ends, strict=True):
        yield Arrow(np.array([foot, end]) + away, name)


def _scale_bar(per_um: float, y: float) -> str:
    """Return a bar of a round length with that length.  per_um : pixels for a micrometre of deviation"""
    size = max((step for step in _STEPS if step * per_um <= _BAR), default=_STEPS[0])
    pixels = size * per_um
    d = f"M{_SIDE:.1f} {y:.1f}v8h{pixels:.1f}v-8"
    bar = f'<path d="{d}" fill="none" stroke="var(--ink)" stroke-width="1.6"/>'
    return bar + text(_SIDE + pixels + 8, y + 9, f"{size:g} µm")
