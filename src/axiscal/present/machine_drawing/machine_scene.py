"""A machine as a scene: its chain by rules, and what its tool reaches."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from axiscal.numerics import Array
from axiscal.present.drawing.scene import EYE, Part, Stroke, box, cylinder
from axiscal.present.machine_drawing.standing_machine import (
    BED,
    Laid,
    Measures,
    StandingMachine,
    across,
    straight,
    turning,
    under,
    up,
)
from axiscal.present.machine_drawing.tool_side import tool_side

LEDGE = 0.34
"""How far the first carriage goes to the left of the tool, as a share of the largest side: a level fits on it."""


def machine_parts(room: StandingMachine) -> list[Part]:
    """Return the machine as it stands at the pose of its room."""
    sizes = Measures(room)
    laid = lathe(sizes) if room.lying else (*work_side(sizes), *tool_side(sizes))
    motions: dict[int, Array] = {}
    return [part.moved(motions.setdefault(index, room.moved(index))) for index, part in laid]


def reached(room: StandingMachine) -> Iterator[Part]:
    """Yield the edges of the tool's reach with rotary axes at 0."""
    yield from edges(room.on_table(box_corners(*room.reach), turned=False), "part", "5 4")


def box_corners(low: Array, high: Array) -> Array:
    """Return the corners of a box, (8, 3) m: the bits of their indices say at which end of x, y and z each lies."""
    ends = np.array([[k & 1, (k >> 1) & 1, (k >> 2) & 1] for k in range(8)])
    corners: Array = low + ends * (high - low)
    return corners


def edges(corners: Array, colour: str, dash: str) -> Iterator[Part]:
    """Yield the edges of a box, those of its farthest corner fainter.  corners : (8, 3) m, as of `box_corners`"""
    back = int(np.argmin(corners @ EYE))
    for i in range(8):
        for j in (i | bit for bit in (1, 2, 4) if not i & bit):
            if np.any(corners[i] != corners[j]):
                yield Stroke(corners[[i, j]], colour, 1.2, dash, 0.4 if back in (i, j) else 0.95)


def lathe(sizes: Measures) -> Iterator[Laid]:
    """Yield all parts; the tool comes from the front, where X grows to."""
    room, s = sizes.room, sizes.whole
    x, y, z = room.tip.tolist()
    left, right = x - float(room.half[0]), x + float(room.half[0])
    radius, floor = 0.05 * s, z - 0.3 * s
    spindle = next((k for k in room.work if room.machine.axes[k].rotary), BED)
    _, centre, level = (room.origin if spindle == BED else room.line(spindle)).tolist()
    base = under(room, spindle) if spindle != BED else BED
    yield (
        BED,
        box(
            [left - 0.4 * s, y - float(room.half[1]) - 0.4 * s, floor - 0.14 * s],
            [right + 0.2 * s, centre + 0.2 * s, floor],
            "bed",
        ),
    )
    yield (
        base,
        box([left - 0.36 * s, centre - 0.16 * s, floor], [left - 0.13 * s, centre + 0.16 * s, level + 0.2 * s], "head"),
    )
    yield spindle, cylinder([left - 0.13 * s, centre, level], [left - 0.05 * s, centre, level], 0.12 * s, "table")
    yield spindle, cylinder([left - 0.05 * s, centre, level], [right - 0.04 * s, centre, level], radius, "head")
    if spindle != BED:
        yield turning(sizes, spindle, np.array([left - 0.05 * s, centre, level]), 0.15 * s, 130.0)
    yield from _slides(sizes, floor)


def _slides(sizes: Measures, floor: float) -> Iterator[Laid]:
    """Yield the slides from the bed up, and the post that holds the tool."""
    room, s = sizes.room, sizes.whole
    x, y, z = room.tip.tolist()
    level, depth = floor, float(room.half[1])
    linear = [k for k in (*room.tool, *room.work) if not room.machine.axes[k].rotary]
    for n, axis in enumerate(linear):
        wide, back = (0.14 - 0.04 * n) * s, y + (0.1 - 0.1 * n) * s
        front = y - depth - (0.34 - 0.06 * n) * s
        left = x - (wide if n else LEDGE * s)
        yield axis, box([left, front, level], [x + wide, back, level + 0.06 * s], "table" if n % 2 == 0 else "head")
        starts = ([x + wide + 0.03 * s, front, level + 0.03 * s], [x + 0.5 * wide, front, level + 0.03 * s])
        yield straight(sizes, axis, np.array(starts[room.way(axis) if room.way(axis) < 2 else 0]))
        level += 0.06 * s
    last = room.spindle
    yield last, box([x - 0.05 * s, y - 0.24 * s, level], [x + 0.05 * s, y - 0.12 * s, z + 0.04 * s], "table")
    yield last, box([x - 0.008 * s, y - 0.12 * s, z - 0.012 * s], [x + 0.012 * s, y, z + 0.006 * s], "stone")


def work_side(sizes: Measures) -> Iterator[Laid]:
    """Yield the parts between the bed and the workpiece; the bed itself belongs to the side of the tool."""
    room = sizes.room
    if not room.work:
        low, high = _around(sizes, 1.0, sizes.pad)
        yield BED, box([*low, sizes.floor], [*high, sizes.table], "table")
    for axis in room.work:
        rotary, upright = room.machine.axes[axis].rotary, room.way(axis) == 2
        if rotary:
            yield from _round_table(sizes, axis) if upright else _cradle(sizes, axis)
        else:
            yield from _lift(sizes, axis) if upright else _slide(sizes, axis)


def _around(sizes: Measures, share: float, more: float) -> tuple[Array, Array]:
    """Return the low and high corner, x and y, of a share of what is reached, and more around it."""
    middle, half = sizes.room.tip[:2], share * sizes.room.half[:2] + more
    return middle - half, middle + half


def _slide(sizes: Measures, axis: int) -> Iterator[Laid]:
    """Yield a table or saddle, as long as it travels."""
    room, s, way = sizes.room, sizes.whole, sizes.room.way(axis)
    top = sizes.tops[axis]
    half = (1.0 if axis == room.work[0] else 0.8) * room.half[:2] + sizes.pad
    half[way] = room.half[way] + sizes.pad
    low, high = room.tip[:2] - half, room.tip[:2] + half
    yield axis, box([*low, top - 0.06 * s], [*high, top], "table")
    front = top - 0.03 * s
    starts = ([room.tip[0] - 0.3 * half[0], low[1], front], [high[0], room.tip[1] - 0.2 * half[1], front])
    yield straight(sizes, axis, np.array(starts[way]))


def _lift(sizes: Measures, axis: int) -> Iterator[Laid]:
    """Yield a bed between screws, or a knee in front of a column."""
    room, s, top = sizes.room, sizes.whole, sizes.tops[axis]
    low, high = _around(sizes, 1.0, sizes.pad)
    yield axis, box([*low, top - 0.03 * s], [*high, top], "table")
    if sizes.framed:
        for _, off in across(np.array([0.7 * (room.half[0] + sizes.pad), 0.0, 0.0])):
            foot = np.array([room.tip[0], high[1] + 0.03 * s, 0.0]) + off
            ends = (top - room.half[2] - 0.2 * s, float(room.tip[2]) + 0.04 * s)
            yield under(room, axis), cylinder(foot + up(ends[0]), foot + up(ends[1]), 0.014 * s, "bed")
    else:
        wide = 0.5 * (room.half[0] + sizes.pad)
        yield axis, box([room.tip[0] - wide, low[1] + sizes.pad, top - 0.28 * s],
                        [room.tip[0] + wide, high[1], top - 0.03 * s], "head")  # fmt: skip
    yield straight(sizes, axis, np.array([low[0] + 0.25 * (high[0] - low[0]), low[1], top - 0.13 * s]))


def _round_table(sizes: Measures, axis: int) -> Iterator[Laid]:
    room, s, top = sizes.room, sizes.whole, sizes.tops[axis]
    centre = room.line(axis) * [1, 1, 0] + up(top)
    radius = 0.92 * float(room.half[:2].min())
    yield axis, cylinder(centre - up(0.09 * s), centre, radius, "table")
    for slot in (0, 1):  # that show how it is turned
        along = 0.9 * radius * np.eye(3)[slot]
        side = 0.012 * s * np.eye(3)[1 - slot]
        yield axis, box(centre - along - side, centre + along + side + up(1e-3 * s), "bed")
    yield turning(sizes, axis, centre - up(0.045 * s), 1.12 * radius)


def _cradle(sizes: Measures, axis: int) -> Iterator[Laid]:
    """Yield a platform between two bearings, on the line of its axis."""
    room, s, way = sizes.room, sizes.whole, sizes.room.way(axis)
    along, base, line = np.eye(3)[way], under(room, axis), room.line(axis)
    top = sizes.tops[axis]
    wide = 0.92 * room.half * (1 - along) * [1, 1, 0]
    middle = line * (1 - along) * [1, 1, 0] + room.tip * along
    reach = float(room.half[way]) * 1.1
    low, high = middle - along * reach - wide, middle + along * reach + wide
    yield axis, box(low + up(top - 0.06 * s), high + up(top), "table")
    thick, half = 0.05 * s, 0.13 * s * (1 - along) * [1, 1, 0]
    for side, end in across(along * reach):
        inner, outer = middle + end, middle + end + side * thick * along
        level = float(line[2])
        cheek = [top - 0.06 * s, max(level + 0.07 * s, top)]
        yield axis, box(inner - half + up(min(cheek[0], level - 0.07 * s)), outer + half + up(cheek[1]), "head")
        bearing = outer + side * 0.1 * s * along
        foot = top - 0.17 * s
        yield base, box(outer - 1.2 * half + up(foot), bearing + 1.2 * half + up(level + 0.1 * s), "bed")
        seen = (way == 0) == (side > 0)
        if seen:
            face = bearing + along * side * 0.004 * s + up(level)
            yield turning(sizes, axis, face, 0.085 * s, 250.0)
