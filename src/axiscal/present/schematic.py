"""The schematic of a set-up: axes, table, tool, instrument and what it reads along, and where readings are taken.

Every machine is drawn from its chain and every instrument from its set-up, somebody's own as ours. The room has z up.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from axiscal.description.campaign import CampaignDescription
from axiscal.language.spoken import counted, listed, put, said
from axiscal.machine.kinematics import bed_in_workpiece
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.present.drawing.scene import (
    EYE,
    LINE,
    RIGHT,
    Arrow,
    Drawing,
    Part,
    RoundMark,
    Stroke,
    drawn,
    text,
    wrapped,
)
from axiscal_core.machine import Machine

_SIDE = 10.0
"""Pixels between the picture and its edge."""
_LYING: Array = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Machine frame to room of a lathe: z to the right, x towards who stands there."""
_WIDE, _COLUMNS = 1110.0, 3
"""Pixels of a plan, and set-ups beside each other; a matter of taste."""
_LEAST = 1e-2
"""m, that a picture is wide at least; a matter of taste."""
_PAD, _ASIDE, _STEP, _TOOL, _ROUND, _WAY, _NEAR = 0.07, 0.28, 0.17, 0.3, 0.13, 0.2, 3.0
"""Shares of the size: beyond the reach go the table and the axes, so long are arrows and the tool, so wide the arcs
of axes that turn the tool, so far goes the arrow of what is read, and so near stands a
station that is shown; a matter of taste.
"""


def upright(machine: Machine) -> Array:
    """Return the rotation from the machine frame to the room, (3, 3).

    ISO 841 calls the direction of the main spindle Z; without a Y nothing reaches around a standing one.
    """
    ways, turns = (
        {int(np.argmax(np.abs(axis.direction))) for axis in machine.axes if axis.rotary is rotary}
        for rotary in (False, True)
    )
    return _LYING if ways == {0, 2} and turns <= {2} else np.eye(3)


class DrawnMachine:
    """A machine at a pose.  pose : (q,) m or rad, None for home: linear axes amid their travels, rotary ones at 0

    upright : the rotation from the machine frame to the room, (3, 3)
    reach : low and high corner of the tool's reach in the workpiece frame with rotary axes at 0, (3,) m each
    level : the pose with rotary axes at 0, (q,); size : its largest side, or the tool, m
    tip, stem : the tool point, and the unit vector from it into the tool, in the room
    """

    def __init__(self, machine: Machine, pose: ArrayLike | None = None) -> None:
        self.machine, self.upright, axes = machine, upright(machine), machine.axes
        ends = [(0.0, 0.0) if axis.rotary else axis.travel for axis in axes]
        self.home = np.mean(ends, axis=1)
        self.pose = self.home if pose is None else np.asarray(pose, dtype=float)
        self.level = np.where([axis.rotary for axis in axes], 0.0, self.pose)
        reached = machine.frames(np.array(np.meshgrid(*ends)).reshape(len(ends), -1).T).tcp
        self.reach = reached.min(axis=0), reached.max(axis=0)
        self.size = max(*(self.reach[1] - self.reach[0]).tolist(), machine.tool_length, _LEAST)
        at = machine.frames(self.pose[None])
        foot, end = self.placed(np.vstack([at.tcp, at.tcp + at.stem]))
        self.tip, self.stem = foot, end - foot

    def placed(self, points: ArrayLike, pose: Array | None = None) -> Array:
        """Return points of the workpiece frame, (n, 3) m, in the room.  pose : (q,) m or rad, None for its own"""
        pose, axes = self.pose if pose is None else pose, self.machine.axes
        bedded = np.where([axis.workpiece_side for axis in axes], pose, 0.0)[None]  # the tool is where it is in the bed
        (turn,) = bed_in_workpiece(self.machine, bedded)
        bed = self.machine.frames(bedded).tcp[0] - turn @ np.array(self.machine.tool)
        there: Array = (np.atleast_2d(points) - bed) @ turn @ self.upright.T
        return there

    def growing(self, axis: int) -> Array:
        """Return how the part itself moves, or about which it turns, as a coordinate grows, in the room at home, (3,).

        The workpiece side goes against its axis.
        """
        own = self.machine.axes[axis]
        there: Array = own.sign * self.upright @ np.array(own.direction)
        return there

    @property
    def table(self) -> Array:
        """The corners of the table in the workpiece frame, below what the tool reaches, (5, 3) m."""
        low, high = self.reach
        middle, pad = (low + high) / 2, _PAD * self.size
        half = np.maximum((high - low) / 2, pad) + pad
        ends = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * half[:2]
        return np.column_stack([middle[:2] + ends, np.full(5, low[2] - pad / 2)])


def _machine(room: DrawnMachine, moves: Sequence[int], *, lengths: bool = False) -> Iterator[Part]:
    """Yield the table, the edges of what the tool reaches, the axes, and the tool.

    moves : axes that are not faint; lengths : whether linear axes say how far they travel, in mm
    """
    yield Stroke(room.placed(room.table), "edge", 1.2, filled="table")
    (low, high), size, alike = room.reach, room.size, list[int]()
    box = room.placed(low + _BITS * (high - low), room.level)
    yield from _edges(box)
    corner, aside = box.min(axis=0), size * np.array([1.0, 1.0, 0.0])
    for k, axis in enumerate(room.machine.axes):
        way, name = room.growing(k), axis.name + "′" * axis.workpiece_side
        if axis.rotary:
            yield from _turning(room, k, name, box)
            continue
        if lengths:
            name += f" {1e3 * axis.length:.0f}" + (f" (⌀ {2e3 * axis.length:.0f})" if axis.diameters else "")
        alike.append(int(np.argmax(np.abs(way))))
        start = corner - (_ASIDE + 0.1 * (alike.count(alike[-1]) - 1)) * aside
        yield Arrow(start + _STEP * size * np.outer([0.5, 1.5], way), name, "ink" if k in moves else "soft")
    yield Stroke(np.array([room.tip, room.tip + _TOOL * size * room.stem]), "stone", 5.0)


def _turning(room: DrawnMachine, axis: int, name: str, box: Array) -> Iterator[Part]:
    """Yield the line of a rotary axis and the arc in which its part turns as its coordinate grows, at home."""
    way, works = room.growing(axis), room.machine.axes[axis].workpiece_side
    (point,) = room.placed(room.machine.frames(room.home[None]).origins[axis], room.home)
    table, nose = room.placed(room.table, room.level).mean(axis=0), room.tip + _TOOL * room.size * room.stem
    beside = table if works else nose
    centre = point + way * ((beside - point) @ way)
    radius = max(0.4 * float(np.median(np.ptp(box, axis=0))), _ROUND * room.size) if works else _ROUND * room.size
    u = EYE - (EYE @ way) * way
    u /= np.linalg.norm(u)
    turns = np.radians(np.linspace(-70.0, 70.0, 30))
    yield Stroke(centre + 1.2 * radius * np.outer([-1.0, 1.0], way), "gold", 1.2, "8 3 2 3")
    arc = centre + radius * (np.outer(np.cos(turns), u) + np.outer(np.sin(turns), np.cross(way, u)))
    yield Arrow(arc, name, "gold")


_BITS: Array = np.array(list(itertools.product((0, 1), repeat=3)))[:, ::-1]
"""At which end of x, y and z each corner of a box lies, (8, 3)."""


def _edges(corners: Array) -> Iterator[Part]:
    """Yield the edges of a box, those of its farthest corner fainter.  corners : (8, 3) m, as of `_BITS`"""
    back = int(np.argmin(corners @ EYE))
    for i, bit in itertools.product(range(8), (1, 2, 4)):
        if not i & bit and np.any(corners[i] != corners[i | bit]):
            yield Stroke(corners[[i, i | bit]], "part", 1.2, "5 4", 0.4 if back in (i, i | bit) else 0.95)


def _instrument(room: DrawnMachine, setup: Setup) -> Iterator[Part]:
    """Yield balls and stations on their posts, the ways from stations to the tool, and along what is read."""
    foot, size = float(room.table[0, 2]), room.size
    balls = (
        {ball.name: at for ball, at in zip(setup.artefact.balls, setup.artefact.points, strict=True)}
        if setup.artefact
        else {}
    )
    stations, (tip,) = np.array(setup.standing).reshape(-1, 3), room.machine.frames(room.pose[None]).tcp
    near = np.linalg.norm(stations - tip, axis=1) <= _NEAR * size
    for at in (*balls.values(), *stations[near]):
        yield Stroke(room.placed([[*at[:2], foot], at]), "stone", 3.5)
    for name, at in balls.items():
        yield RoundMark(room.placed(at)[0], "gold", 5.0, name)
    for at, stands in zip(stations, near.tolist(), strict=True):
        way = at - tip if stands else _WAY * size * (at - tip) / np.linalg.norm(at - tip)
        yield Stroke(room.placed([tip, tip + way]), "beam", 2.2)
        if stands:
            yield RoundMark(room.placed(at)[0], "gold", 5.0)
    if setup.directed:
        yield Arrow(room.placed(tip + _WAY * size * np.outer([-0.7, 1.0], setup.direction)), "+", "beam")
    yield RoundMark(room.tip, "beam", 4.0, said(setup.title))


@dataclass(frozen=True, eq=False, slots=True)
class Schematic:
    """A set-up on its machine, ready to be drawn at any width.  parts : of the scene; title, legend : in words"""

    parts: Sequence[Part]
    title: str
    legend: str

    def svg(self, width: float, height: float, left: float = 0.0, top: float = 0.0, titled: bool = True) -> str:
        """Return the picture as SVG elements within a frame, pixels."""
        across = width - 2 * _SIDE
        heads, lines = wrapped(self.title if titled else "", across, "title"), wrapped(self.legend, across)
        over, beneath = LINE * len(heads) + 4, LINE * len(lines) + 6
        scene = drawn(self.parts, (left + _SIDE, top + over, across, height - over - beneath))
        words = text(left + _SIDE, top + 16, heads, "title")
        return scene + words + text(left + _SIDE, top + height - beneath + 18, lines, "soft")


_DOTS = 300  # readings of a set-up that are drawn: more lie on each other


def setup_schematic(
    campaign: CampaignDescription, setup: Setup, places: Sequence[Place], at: Place | None = None
) -> Schematic:
    """Return a set-up with the places where it is read.

    places : of any set-up, read or to come
    at : where the machine stands, None for one of the places
    """
    own = [place for place in places if place.setup == setup.name]
    dots = own[:: 1 + len(own) // _DOTS]
    shown = at or max(dots, key=partial(_seen_well, campaign.machine), default=None)
    room = DrawnMachine(campaign.machine, shown.pose if shown else setup.park)
    poses, size = np.array([place.pose for place in dots]).reshape(-1, len(room.pose)), 3.0 if len(own) < 10 else 2.2
    read = [RoundMark(each, "read", size) for each in room.placed(room.machine.frames(poses).tcp)]
    parts = [*_machine(room, setup.moves), *_instrument(room, setup), *read]
    count = put("● {read}", read=counted("{count} reading", "{count} readings", len(own))) if own else ""
    return Schematic(parts, setup.name, listed(" · ", [each for each in (count, _reach_note(room)) if each]))


def _seen_well(machine: Machine, place: Place) -> tuple[float, float]:
    """Return how well a place shows all: rotary axes near 0, then the tool to the right."""
    off = sum(abs(np.sin(at / 2)) for at, axis in zip(place.pose, machine.axes, strict=True) if axis.rotary)
    return round(-float(off), 3), float(machine.frames(np.array([place.pose])).tcp[0] @ upright(machine).T @ RIGHT)


def machine_schematic(machine: Machine, *, lengths: bool = True) -> Schematic:
    """Return a machine at home.  lengths : whether its axes say how far they travel, in mm"""
    room = DrawnMachine(machine)
    parts = [*_machine(room, range(len(machine.axes)), lengths=lengths)]
    return Schematic(parts, machine.name, _reach_note(room) if lengths else "")


def _reach_note(room: DrawnMachine) -> str:
    spans = " × ".join(f"{1e3 * span:.0f}" for span in room.reach[1] - room.reach[0] if span > 1e-9)
    return said("dashed: where the tool reaches, {size} mm", size=spans) if spans else ""


def setup_picture(shown: Schematic, width: float) -> str:
    """Return the text of an SVG file with one set-up, without its title, for a width in pixels."""
    height = round((0.66 if width > 500 else 0.95) * width)
    return Drawing(width, height, shown.svg(width, height, titled=False)).on_screen(shown.title)


def read_schematics(campaign: CampaignDescription, places: Sequence[Place]) -> list[Schematic]:
    """Return each set-up that is read, in the order of the places."""
    used = dict.fromkeys(place.setup for place in places)
    return [setup_schematic(campaign, campaign.setup(name), places) for name in used]


def plan_picture(title: str, campaign: CampaignDescription, places: Sequence[Place]) -> str:
    """Return the text of an SVG file: each set-up that is read, on the machine.  places : in any order"""
    shown = read_schematics(campaign, places)
    columns = max(1, min(len(shown), _COLUMNS))
    across = _WIDE / columns
    high, top = round(across * (0.65 if columns == 1 else 0.9)), 2 * LINE
    body = text(_SIDE, LINE, title, "title")
    for n, each in enumerate(shown):
        body += each.svg(across, high, across * (n % columns), top + high * (n // columns))
    return Drawing(_WIDE, top + high * -(-len(shown) // columns), body).on_screen(title)
