"""A machine as a scene: its chain by rules, and what its tool reaches.

What carries the tool: spindle and swivelling head, ram, carriages, and the wall, portal or frame that holds them.
"""

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

_SEEN_THROUGH = 0.55
"""Opacity of a leg or post between the work and who looks; a matter of taste."""


def tool_side(sizes: Measures) -> Iterator[Laid]:
    """Yield the bed and the parts between it and the tool."""
    room = sizes.room
    linear = [k for k in room.tool if not room.machine.axes[k].rotary]
    nose = float(room.tip[2]) + room.machine.tool_length
    if room.machine.tool_length > 0:
        yield room.spindle, cylinder(room.tip, room.tip * [1, 1, 0] + up(nose), 0.012 * sizes.spindle, "stone")
    top, parts = head(sizes, nose)
    yield from parts
    level = [k for k in linear if room.way(k) < 2]
    if sizes.framed:
        yield from frame(sizes, level, top)
    elif not room.work and len(level) > 1 and linear[:2] == level[:2] and room.way(level[0]) != room.way(level[1]):
        yield from portal(sizes, linear, top)
    else:
        yield from _before_a_wall(sizes, linear, top)


def _before_a_wall(sizes: Measures, linear: list[int], top: float) -> Iterator[Laid]:
    """Yield carriages between a wall behind the work and the spindle.

    The first one rides on top of the wall, or up and down its front; the others hang before it, one after another.
    linear : from the bed to the tool; top : height at which the spindle is held
    """
    room, s, t = sizes.room, sizes.whole, sizes.spindle
    x, y, _ = room.tip.tolist()
    behind = any(room.way(k) == 1 and not room.machine.axes[k].rotary for k in room.work)
    front = y + float(room.half[1]) * (2 if behind else 1) + sizes.pad + 0.08 * s
    wide = float(room.half[0]) + sizes.pad
    sideways = any(room.way(k) == 0 for k in linear)
    rises = bool(linear) and room.way(linear[0]) == 2
    ram = len(linear) > 1 and room.way(linear[-1]) == 2
    beam = max(float(room.tip[2] + room.half[2]) + 0.1 * t, top - 0.15 * t) if ram else top + 0.04 * t
    high = beam + 0.2 * t + 0.04 * s
    carriages = linear[:-1] if ram else linear
    before = front
    for n, axis in enumerate(carriages):
        near = y + sizes.ram + sizes.plate * (len(carriages) - n - 1)
        last = n == len(carriages) - 1 and not ram
        over = any(room.way(k) == 0 for k in linear[n + 1 :])
        half = wide if over else 0.15 * s if n or not last else 0.1 * t
        far = before if n or rises else front + 0.24 * s
        y0 = y - sizes.ram if last and not rises else near
        yield axis, box([x - half, y0, beam], [x + half, far, high], "head" if n == 0 else "table")
        level = (beam + high) / 2
        starts = ([x + half + 0.04 * s, near, level], [x + half, (near + far) / 2, level], [x - half, near, level])
        if room.way(axis) < 2 or len(linear) > 1:
            yield straight(sizes, axis, np.array(starts[room.way(axis)]))
        before = near
    yield from _spindle_box(sizes, linear, top, high + (float(room.half[2]) if ram else 0.0))
    if not linear:
        yield BED, box([x - 0.1 * t, y + sizes.ram, beam], [x + 0.1 * t, front, high], "head")
    half = wide if sideways else 0.2 * s
    ceiling = high + float(room.half[2]) + 0.05 * s if rises or not linear else beam
    yield BED, box([x - half, front, sizes.floor], [x + half, front + 0.28 * s, ceiling], "head")
    width = max(wide, half)
    yield BED, box([x - width, y - float(room.half[1]) - 1.6 * sizes.pad, sizes.floor - 0.16 * s],
                   [x + width, front + 0.3 * s, sizes.floor], "bed")  # fmt: skip


def _spindle_box(sizes: Measures, linear: list[int], top: float, high: float) -> Iterator[Laid]:
    """Yield what holds the spindle; with the arrow of an upright axis that carries it."""
    room, a = sizes.room, sizes.ram
    x, y, _ = room.tip.tolist()
    part = linear[-1] if linear else BED
    upright = bool(linear) and room.way(linear[-1]) == 2
    if upright or not linear or room.way(linear[0]) == 2:
        yield part, box([x - a, y - a, top], [x + a, y + a, max(high, top + 0.3 * sizes.spindle)], "table")
    if upright:
        yield straight(sizes, part, np.array([x + a, y - a, top + 0.14 * sizes.spindle]))


def portal(sizes: Measures, linear: list[int], top: float) -> Iterator[Laid]:
    """Yield a portal on two legs whose beam lies away from who looks, the carriages before it.

    linear : axes from the bed to the tool; top : height at which the spindle is held
    """
    room, s, t = sizes.room, sizes.whole, sizes.spindle
    first, second, *rest = linear
    along, beam_way = np.eye(3)[room.way(first)], np.eye(3)[room.way(second)]
    away = -along if room.way(first) == 0 else along  # from who looks
    flat, a = room.tip * [1, 1, 0], sizes.ram
    low = max(float(room.tip[2] + room.half[2]) + 0.06 * t, top - 0.1 * t) if rest else top
    high = low + 0.16 * t + 0.05 * s
    thick, reach = 0.06 * s + 0.04 * t, float(room.half @ beam_way) + 2.2 * sizes.pad
    middle = flat + away * (a + sizes.plate + thick)
    legs = 0.7 * thick * beam_way + thick * along
    for side, end in across(reach * beam_way):
        near = side < 0 if room.way(second) == 1 else side > 0
        foot, top_of = middle + end - legs + up(sizes.floor), middle + end + legs + up(low)
        yield first, box(foot, top_of, "head", _SEEN_THROUGH if near else 1.0)
    beam = (reach + 0.7 * thick) * beam_way + thick * along
    yield first, box(middle - beam + up(low), middle + beam + up(high), "head")
    carriage = 0.13 * t * beam_way
    face = flat + away * a
    saddle = box(face - carriage + up(low - 0.04 * t), face + away * sizes.plate + carriage + up(high), "table")
    yield second, saddle
    shown = middle - away * thick - (reach - 0.6 * sizes.pad) * beam_way * (1 if room.way(second) == 1 else -1)
    yield straight(sizes, first, shown + up((sizes.floor + low) / 2))
    yield straight(sizes, second, face + away * sizes.plate + (carriage + 0.09 * s * beam_way) + up((low + high) / 2))
    for axis in rest:
        square = a * (along + beam_way)
        yield axis, box(flat - square + up(top), flat + square + up(high + float(room.half[2])), "table")
        yield straight(sizes, axis, flat + a * np.array([1, -1, 0]) + up(top + 0.14 * t))
    foot = (float(room.half @ along) + sizes.pad) * along + (reach + 1.5 * thick) * beam_way
    back = away * (a + sizes.plate + 2.5 * thick)
    corners = np.array([flat - foot, flat + foot, flat - foot + back, flat + foot + back])
    ends = corners.min(axis=0) + up(sizes.floor - 0.12 * s), corners.max(axis=0) + up(sizes.floor)
    yield BED, box(*ends, "bed")


def frame(sizes: Measures, level: list[int], top: float) -> Iterator[Laid]:
    """Yield four posts with two rails, a beam on them, and the carriage on the beam.

    level : the axes of the gantry, the one on the rails first; top : height at which the nozzle is held
    """
    room, s = sizes.room, sizes.whole
    first, second = level[:2]
    along, beam_way = np.eye(3)[room.way(first)], np.eye(3)[room.way(second)]
    flat, rail = room.tip * [1, 1, 0], 0.04 * s
    ends = (room.half + 2 * sizes.pad) * [1, 1, 0]
    foot = sizes.table - float(room.half[2]) - 0.17 * s
    high = top + 0.02 * s
    yield BED, box(flat - ends + up(foot - 0.05 * s), flat + ends + up(foot), "bed")
    for x, y in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        corner = flat + ends * [x, y, 0]
        inside = corner - rail * np.array([x, y, 0])
        through = _SEEN_THROUGH if y < 0 else 1.0
        yield BED, box(corner + up(foot), inside + up(high), "bed", through)
    for side, end in across(ends * beam_way):
        outer = flat + end
        inner = outer - side * rail * beam_way
        run = ends * along
        yield BED, box(outer - run + up(high), inner + run + up(high + rail), "bed")
    behind = along if room.way(first) == 1 else -along
    near = flat + behind * 0.03 * s
    cross = ends * beam_way
    bridge = box(near - cross + up(high + rail), near + behind * 0.05 * s + cross + up(high + 2.2 * rail), "head")
    yield first, bridge
    half = 0.05 * s * (along + beam_way)
    low = float(room.tip[2]) + room.machine.tool_length
    yield second, box(flat - half + up(low), flat + half - behind * 0.02 * s + up(high + 2.6 * rail), "table")
    yield straight(sizes, first, near + cross + behind * 0.12 * s + up(high + rail))
    yield straight(sizes, second, near + 0.22 * s * beam_way + up(high + 1.6 * rail))


def head(sizes: Measures, nose: float) -> tuple[float, list[Laid]]:
    """Return the height at which spindle or head are held, m, and their parts.  nose : height of the spindle's end"""
    room, t = sizes.room, sizes.spindle
    rotary = [k for k in room.tool if room.machine.axes[k].rotary]
    foot = room.tip * [1, 1, 0] + up(nose)
    level = nose + 0.09 * t
    parts: list[Laid] = [(room.spindle, cylinder(foot, foot + up(0.09 * t), 0.045 * t, "head"))]
    for axis in reversed(rotary):
        if room.way(axis) == 2:
            foot = room.tip * [1, 1, 0] + up(level)
            parts.append((axis, cylinder(foot, foot + up(0.1 * t), 0.11 * t, "table")))
            parts.append(turning(sizes, axis, _on_line(sizes, axis, foot + up(0.05 * t)), 0.16 * t))
            level += 0.1 * t
        else:  # a fork whose top is above the line that it swivels about, and above the spindle
            top = max(float(room.axis_point(axis)[2]), level) + 0.22 * t
            parts += _cheeks(sizes, axis, level, top)
            level = top
    return level, parts


def _cheeks(sizes: Measures, axis: int, level: float, top: float) -> Iterator[Laid]:
    """Yield a fork that holds the spindle on both sides."""
    room, t, base = sizes.room, sizes.spindle, under(sizes.room, axis)
    along, line = np.eye(3)[room.way(axis)], room.axis_point(axis)
    middle = room.tip * [1, 1, 0]
    across_it = (1 - along) * [1, 1, 0]
    wide = 0.07 * t * np.array([1.0, 1.0, 0.0])
    yield axis, box(middle - wide + up(level), middle + wide + up(top - 0.09 * t), "table")
    for side, end in across(0.075 * t * along):
        inner, outer = middle + end - 0.065 * t * across_it, middle + end + side * 0.05 * t * along
        low = min(float(line[2]), level) - 0.05 * t
        yield base, box(inner + up(low), outer + 0.065 * t * across_it + up(top - 0.06 * t), "head")
        if (room.way(axis) == 0) == (side > 0):
            yield turning(sizes, axis, _on_line(sizes, axis, outer + side * 0.01 * t * along), 0.09 * t, 220.0)
    cap = 0.125 * t * along + 0.065 * t * across_it
    yield base, box(middle - cap + up(top - 0.06 * t), middle + cap + up(top), "head")


def _on_line(sizes: Measures, axis: int, beside: Array) -> Array:
    """Return the point on the line of an axis that lies beside another point, (3,) m."""
    along = np.eye(3)[sizes.room.way(axis)]
    point: Array = sizes.room.axis_point(axis) * (1 - along) + beside * along
    return point


LEDGE = 0.34
"""How far the first carriage goes to the left of the tool, as a share of the largest side: a level fits on it."""


def machine_parts(room: StandingMachine) -> list[Part]:
    """Return the machine as it stands at the pose of its room."""
    sizes = Measures(room)
    laid = lathe(sizes) if room.lying else (*work_side(sizes), *tool_side(sizes))
    motions: dict[int, Array] = {}
    return [part.moved(motions.setdefault(index, room.part_motion(index))) for index, part in laid]


def reach_edges(room: StandingMachine) -> Iterator[Part]:
    """Yield the edges of the tool's reach with rotary axes at 0."""
    yield from edges(room.on_table(box_corners(*room.reach), turned=False), "part", "5 4")


def box_corners(low: Array, high: Array) -> Array:
    """Return the corners of a box, (8, 3) m: the bits of their indices say at which end of x, y and z each lies."""
    ends = np.array([[k & 1, (k >> 1) & 1, (k >> 2) & 1] for k in range(8)])
    return low + ends * (high - low)


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
    _, centre, level = (room.origin if spindle == BED else room.axis_point(spindle)).tolist()
    base = under(room, spindle) if spindle != BED else BED
    front = y - float(room.half[1]) - 0.4 * s
    yield BED, box([left - 0.4 * s, front, floor - 0.14 * s], [right + 0.2 * s, centre + 0.2 * s, floor], "bed")
    low, high = [left - 0.36 * s, centre - 0.16 * s, floor], [left - 0.13 * s, centre + 0.16 * s, level + 0.2 * s]
    yield base, box(low, high, "head")
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
    centre = room.axis_point(axis) * [1, 1, 0] + up(top)
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
    along, base, line = np.eye(3)[way], under(room, axis), room.axis_point(axis)
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
        if (way == 0) == (side > 0):  # it is seen
            face = bearing + along * side * 0.004 * s + up(level)
            yield turning(sizes, axis, face, 0.085 * s, 250.0)
