"""Instruments as they stand on a machine: what holds them, what they read, and what is seen between them and the tool.

Each is drawn by what its set-up says: along which direction, about which, from which station, at which balls.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from axiscal.language.spoken import said
from axiscal.machine.kinematics import frames
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.present.drawing.scene import Caption, Part, RoundMark, Stroke, box, cylinder
from axiscal.present.machine_drawing.standing_machine import Measures, up

_TURN: Array = np.linspace(0, 2 * np.pi, 49)
"""Mathematics: a circle."""


class MountedSetup:
    """A set-up on a machine at a pose, everything in the room.

    places : (n, 3) m, where it is read; together : the other set-ups that read the same artefact
    tip : where the tool point is; direction : along which, or about which, the set-up reads
    table : height of the top of the table as it stands, m
    """

    def __init__(self, sizes: Measures, setup: Setup, places: Array, together: Sequence[Setup]) -> None:
        self.sizes, self.setup, self.places, self.together = sizes, setup, places, together
        self.room, self.tip = sizes.room, sizes.room.tip_now
        self.direction = self.room.direction_on_table(setup.direction)
        foot = self.room.tip * [1, 1, 0] + up(sizes.table)
        self.table = float((self.room.part_motion(self.room.table) @ np.append(foot, 1.0))[2])

    def post(self, at: Array) -> Stroke:
        """Return a post from the table up to a place, (3,) m."""
        return Stroke(np.array([at * [1, 1, 0] + up(self.table), at]), "stone", 3.5)


def _interferometer(stand: MountedSetup) -> Iterator[Part]:
    """Yield head, optics on the table and the reflector in the spindle; a beam that goes up is turned by the optics."""
    s, along, tip = stand.sizes.whole, _from_us(stand.direction), stand.tip
    if abs(along[2]) > 0.7:
        optics = tip * [1, 1, 0] + up(stand.table + 0.03 * s)
        head = optics - [float(stand.room.half[0]) + 0.45 * s, 0, 0]
        yield Stroke(np.array([head, optics, tip]), "beam", 2.2)
    else:
        first = min((point @ along for point in [tip, *stand.places]), default=0.0)
        optics = tip + along * (first - tip @ along - 0.07 * s)
        head = optics - along * 0.3 * s
        yield Stroke(np.array([head, tip]), "beam", 2.2)
    way = optics - head
    yield from _head_on_tripod(stand, head, way / np.linalg.norm(way))
    yield stand.post(optics)
    yield _square(optics, 0.028 * s, way)
    yield RoundMark(tip, 0.018 * s, "beam", 4.0)


def _from_us(direction: Array) -> Array:
    """Return a direction with the sign that leads from the left, the front or below into the picture."""
    sign = direction[int(np.argmax(np.abs(direction)))]
    return direction if sign > 0 else -direction


def _head_on_tripod(stand: MountedSetup, head: Array, way: Array) -> Iterator[Part]:
    s, foot = stand.sizes.whole, stand.sizes.floor - 0.1 * stand.sizes.whole
    side = 0.045 * s * np.cross([0.0, 0.0, 1.0], way)
    rise = np.array([0.0, 0.0, 0.04 * s])
    yield box(head - 0.2 * s * way - side - rise, head + side + rise, "stone")
    knee = head - 0.1 * s * way - rise
    for leg in (0.1 * s * way, -0.1 * s * way + 2 * side, -0.1 * s * way - 2 * side):
        yield Stroke(np.array([knee, (knee + leg) * [1, 1, 0] + up(foot)]), "stone", 2.2)
    yield Caption(knee + 3 * rise, said(stand.setup.title))


def _square(middle: Array, half: float, way: Array) -> Stroke:
    """Return a pane across a way."""
    u = np.cross(way, [0.0, 0.0, 1.0])
    u = u / np.linalg.norm(u) if np.linalg.norm(u) > 0 else np.array([1.0, 0.0, 0.0])
    v = np.cross(u, way / np.linalg.norm(way))
    corners = [middle + half * (a * u + b * v) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))]
    return Stroke(np.array(corners), "ink", 1.4, filled="gold")


def _autocollimator(stand: MountedSetup) -> Iterator[Part]:
    s, tip = stand.sizes.whole, stand.tip
    along = _from_us(stand.room.direction_on_table(stand.room.machine.axes[stand.setup.moves[0]].direction))
    along = along if abs(along[2]) < 0.7 else np.array([1.0, 0.0, 0.0])
    first = min((point @ along for point in [tip, *stand.places]), default=0.0)
    head = tip + along * (first - tip @ along - 0.3 * s)
    yield Stroke(np.array([head, tip]), "beam", 2.2)
    yield from _head_on_tripod(stand, head, along)
    yield _square(tip, 0.035 * s, along)


def _dial(stand: MountedSetup, touched: Array) -> Iterator[Part]:
    """Yield a dial gauge in the spindle whose stem touches a place, (3,) m."""
    s, tip = stand.sizes.whole, stand.tip
    off = _from_us(stand.direction)
    face = touched - 0.11 * s * off + up(0.085 * s) if abs(off[2]) < 0.7 else touched + up(0.11 * s)
    u, v = np.array([np.cos(0.57), np.sin(0.57), 0.0]), np.array([0.0, 0.0, 1.0])
    yield Stroke(np.array([tip + up(stand.room.machine.tool * 0.3), face]), "stone", 2.4)
    yield Stroke(np.array([face, touched]), "ink", 2.0)
    yield Stroke(
        face + 0.045 * s * (np.outer(np.cos(_TURN), u) + np.outer(np.sin(_TURN), v)), "ink", 1.8, filled="gold"
    )
    yield Stroke(np.array([face, face + 0.034 * s * (0.5 * u + 0.86 * v)]), "beam", 2.0)
    yield RoundMark(touched, 0.008 * s, "beam")


def _indicator(stand: MountedSetup) -> Iterator[Part]:
    """Yield a dial gauge against a block on the table."""
    yield from _block(stand)
    yield from _dial(stand, stand.tip)
    yield Caption(stand.tip + 0.05 * stand.sizes.whole * _from_us(stand.direction), said(stand.setup.title))


def _block(stand: MountedSetup) -> Iterator[Part]:
    """Yield a block on the table that is touched where the tool point is, if there is room for one."""
    s, along = stand.sizes.whole, _from_us(stand.direction)
    side = 0.05 * s * (1 - np.abs(along))
    low, high = stand.tip - side, stand.tip + side + 0.06 * s * along
    low[2], high[2] = stand.table, stand.tip[2] + (0.0 if abs(along[2]) > 0.7 else 0.03 * s)
    if high[2] > low[2] + 1e-6:
        yield box(low, high, "stone")


def _straightedge(stand: MountedSetup) -> Iterator[Part]:
    """Yield the bar that is read, as long as it is read, the other legs of a square, and a dial gauge against it."""
    ends = _read_along(stand, stand.setup)
    yield from _bar(stand, stand.setup, ends)
    for each in stand.together:
        others = _read_along(stand, each)
        yield from _bar(stand, each, others - others[0] + ends[0])
    yield from _dial(stand, stand.tip)
    name = owner_of(stand.setup) or said(stand.setup.title)
    yield Caption(ends[0] + 0.06 * stand.sizes.whole * _from_us(stand.direction), name)


def owner_of(setup: Setup) -> str:
    """Return the name of the artefact on the table, "" if it has no name."""
    return next((unknown.owner for unknown in setup.unknowns if unknown.owner), "")


def _read_along(stand: MountedSetup, setup: Setup) -> Array:
    """Return both ends of where a set-up of one linear axis is read, (2, 3) m, in the room, as high as the tip."""
    machine, axis = stand.room.machine, setup.moves[0]
    poses = np.array([setup.park, setup.park], dtype=float)
    poses[:, axis] = setup.span(machine.axes[axis], axis)
    if setup is stand.setup:
        poses[:, [k for k in range(len(machine.axes)) if k != axis]] = np.delete(stand.room.pose, axis)
    return stand.room.on_table(frames(machine, poses).tcp)


def _bar(stand: MountedSetup, setup: Setup, ends: Array) -> Iterator[Part]:
    """Yield a bar between two places, (2, 3) m, on feet where it stands above the table."""
    s, thick = stand.sizes.whole, 0.045 * stand.sizes.whole
    off = _from_us(stand.room.direction_on_table(setup.direction))
    along = ends[1] - ends[0]
    along = along / max(float(np.linalg.norm(along)), 1e-9)
    if abs(off[2]) > 0.7:  # read from above
        side, rise = np.cross(off, along) * thick / 2, np.zeros(3)
        low, high = ends[0] - 0.02 * s * along - side, ends[1] + 0.02 * s * along + side
    else:
        low, high = ends[0] - 0.02 * s * along, ends[1] + 0.02 * s * along + thick * off
        rise = np.array([0.0, 0.0, 0.012 * s])
    top = float(stand.tip[2]) + float(rise[2])
    foot = max(stand.table, top - 0.06 * s)
    low[2], high[2] = foot, top
    if top > foot + 1e-9:
        yield box(low, high, "stone")
    middle = (low + high) / 2
    for end in (0.35, -0.35) if foot > stand.table + 1e-9 else ():
        base = middle + end * (ends[1] - ends[0])
        half = 0.018 * s * np.array([1.0, 1.0, 0.0])
        yield box((base - half) * [1, 1, 0] + up(stand.table), (base + half) * [1, 1, 0] + up(foot), "bed")


def _level(stand: MountedSetup) -> Iterator[Part]:
    """Yield a level: on the table, or on what the axis moves where that does not carry the workpiece."""
    s, room, axis = stand.sizes.whole, stand.room, stand.setup.moves[0]
    rests = stand.tip if stand.setup.base is not None else room.on_table(np.mean(room.reach, axis=0))[0]
    foot = rests * [1, 1, 0] + up(stand.table)
    if axis in room.tool and stand.setup.base is None:
        beside = np.array([-stand.sizes.ram - 0.09 * s, 0.0, room.machine.tool + 0.12 * stand.sizes.spindle])
        ledge = room.tip + (np.array([-0.24, -0.2, -0.24]) * s if room.lying else beside)  # on the carriage of a lathe
        foot = (room.part_motion(axis) @ np.append(ledge, 1.0))[:3]
    about = np.abs(stand.direction)
    half = np.array([0.03, 0.09, 0.0]) * s if about[0] > 0.7 else np.array([0.09, 0.03, 0.0]) * s
    yield box(foot - half, foot + half + up(0.055 * s), "gold")
    top = foot + up(0.055 * s)
    yield Stroke(np.array([top - 0.4 * half, top + 0.4 * half]), "paper", 5.0)
    yield RoundMark(top, 0.006 * s, "read", 3.0)
    yield Caption(top, said(stand.setup.title))


def _ballbar(stand: MountedSetup) -> Iterator[Part]:
    s, tip = stand.sizes.whole, stand.tip
    for station in stand.setup.standing:
        centre = stand.room.on_table(np.array(station))[0]
        yield stand.post(centre)
        yield Stroke(np.array([centre, tip]), "gold", 5.0)
        yield RoundMark(centre, 0.022 * s, "beam", 4.0)
        yield Caption((centre + tip) / 2, said(stand.setup.title))
    yield from _balls(stand)
    yield RoundMark(tip, 0.018 * s, "beam", 4.0)


def _balls(stand: MountedSetup) -> Iterator[Part]:
    """Yield the balls of an artefact on their posts."""
    artefact = stand.setup.artefact
    if artefact is None:
        return
    radius = 0.5 * (artefact.diameter or 0.05 * stand.sizes.whole)
    for ball, at in zip(artefact.balls, stand.room.on_table(artefact.points), strict=True):
        yield stand.post(at)
        yield RoundMark(at, radius, "gold", 5.0)
        yield Caption(at + up(1.2 * radius), ball.name)


def _sphere(stand: MountedSetup) -> Iterator[Part]:
    yield from _balls(stand)
    yield RoundMark(stand.tip, 0.01 * stand.sizes.whole, "beam")


def _nest(stand: MountedSetup) -> Iterator[Part]:
    """Yield a nest of sensors on the table round the ball in the spindle."""
    s, tip = stand.sizes.whole, stand.tip
    base = tip - up(0.1 * s)
    yield stand.post(base)
    yield Stroke(base + 0.08 * s * np.stack([np.cos(_TURN), np.sin(_TURN), 0 * _TURN], 1), "ink", 2.0, filled="stone")
    for turn in np.radians([200.0, 320.0, 80.0]):
        foot = base + 0.08 * s * np.array([np.cos(turn), np.sin(turn), 0])
        yield Stroke(np.array([foot, tip + 0.02 * s * np.array([np.cos(turn), np.sin(turn), 0])]), "gold", 4.0)
    yield RoundMark(tip, 0.022 * s, "beam", 4.0)
    yield Caption(base, said(stand.setup.title))


def _tracker(stand: MountedSetup) -> Iterator[Part]:
    """Yield trackers or tracers at their stations, or beside the machine where nobody says, with their beams."""
    s, tip, floor = stand.sizes.whole, stand.tip, stand.sizes.floor - 0.1 * stand.sizes.whole
    beside = stand.room.tip - [float(stand.room.half[0]) + 0.5 * s, float(stand.room.half[1]), 0.1 * s]
    stations = [stand.room.on_table(np.array(at))[0] for at in stand.setup.standing] or [beside]
    for number, at in enumerate(stations):
        if stand.setup.standing and at[2] > stand.table + 1e-6:
            yield stand.post(at)
        else:
            foot = at * [1, 1, 0] + up(min(floor, at[2] - 0.1 * s))
            yield cylinder(foot, at - up(0.03 * s), 0.03 * s, "stone")
        yield Stroke(np.array([at, tip]), "beam", 1.8)
        yield RoundMark(at, 0.035 * s, "gold", 6.0)
        name = said(stand.setup.title)
        yield Caption(at + up(0.04 * s), f"{name} {number + 1}" if len(stations) > 1 else name)
    yield RoundMark(tip, 0.018 * s, "beam", 4.0)


def _probe(stand: MountedSetup) -> Iterator[Part]:
    """Yield a probe in the spindle, and the way down to what it touches."""
    s, tip, along = stand.sizes.whole, stand.tip, _from_us(stand.direction)
    if abs(along[2]) > 0.7 and tip[2] > stand.table:
        yield Stroke(np.array([tip, tip * [1, 1, 0] + up(stand.table)]), "beam", 1.6, "2 3")
    elif abs(along[2]) <= 0.7:
        yield from _block(stand)
    yield RoundMark(tip, 0.01 * s, "beam", 3.0)
    yield Caption(tip, said(stand.setup.title))


def own_drawing(stand: MountedSetup) -> Iterator[Part]:
    """Yield what is known of an instrument that somebody wrote: it is at the tool point."""
    yield RoundMark(stand.tip, 0.022 * stand.sizes.whole, "beam", 4.0)
    yield Caption(stand.tip, said(stand.setup.title))


DRAWN: Mapping[str, Callable[[MountedSetup], Iterator[Part]]] = {
    "interferometer": _interferometer,
    "indicator": _indicator,
    "probe": _probe,
    "gauge": _indicator,
    "straightedge": _straightedge,
    "level": _level,
    "autocollimator": _autocollimator,
    "ballbar": _ballbar,
    "rtest": _nest,
    "sphere": _sphere,
    "tracker": _tracker,
    "tracer": _tracker,
}
"""What draws an instrument of ours as its set-up stands, by its name; a test holds that it has all of them."""


def reading_parts(stand: MountedSetup, tips: Array, approaches: Array, colour: str, size: float) -> Iterator[Part]:
    """Yield a dot where each reading is taken, with a tail to the side its one linear axis comes from.

    tips : (n, 3) m, in the room; approaches : (n, q) +1, −1, or 0 where the side does not count
    size : radius of a dot, pixels
    """
    axes, moves = stand.room.machine.axes, stand.setup.moves
    for at, sides in zip(tips, approaches, strict=True):
        if len(moves) == 1 and not axes[moves[0]].rotary and sides[moves[0]]:
            along = stand.room.direction_on_table(axes[moves[0]].direction) * float(sides[moves[0]])
            yield Stroke(np.array([at - 0.045 * stand.sizes.whole * along, at]), colour, 2.4)
        yield RoundMark(at, 0.0, colour, size)
