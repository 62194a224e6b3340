"""A machine as it stands in a room: z up, and where each of its parts is at a pose.

A part is what one axis carries: it has the index of that axis, and the bed has `BED`. Parts begin at home, with linear
axes in the middle of their travels and rotary ones at 0. The chain moves them from there.

How large the parts of a drawn machine are follows from what its tool reaches, and is all a matter of taste.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from axiscal.numerics import Array
from axiscal.present.drawing.scene import EYE, Arrow, Part
from axiscal_core import rigid
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

BED = -1
"""The part that nothing moves."""
_LYING: Array = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Machine frame to room of a lathe: z to the right, x towards who stands there."""
_LEAST = 0.12
"""Share of its largest side that every side of the volume has at least in a drawing; a matter of taste."""


class StandingMachine:
    """A machine at a pose.  pose : (q,) m or rad

    lying : whether the spindle lies as that of a lathe does: X and Z are all linear axes, and rotary axes turn about Z
    upright : the rotation from the machine frame to the room, (3, 3); home : the pose at which parts are laid out
    work : the axes that carry the workpiece, from the workpiece to the bed; table : the part on which it lies
    tool : those that carry the tool, from the bed to the tool; spindle : the part that holds it
    origin, tip : of the workpiece frame and the tool point at home, tip_now : the latter at the pose, in the room, m
    reach : low and high corner of the tool's reach in the workpiece frame with rotary axes at 0, (3,) m each
    half : half the sides of the tool's reach along the room's directions, none of them 0, (3,) m
    """

    def __init__(self, machine: Machine, pose: Array) -> None:
        self.machine, self.pose, axes = machine, pose, machine.axes
        ways, turns = (
            {int(np.argmax(np.abs(axis.direction))) for axis in axes if axis.rotary is rotary}
            for rotary in (False, True)
        )
        # ISO 841 calls the direction of the main spindle Z; without a Y nothing reaches around a standing one.
        self.lying = ways == {0, 2} and turns <= {2}
        self.upright = _LYING if self.lying else np.eye(3)
        self.home = np.array([0.0 if axis.rotary else sum(axis.travel) / 2 for axis in axes])
        self.work, self.tool = (
            [k for k, axis in enumerate(axes) if axis.workpiece_side is carries] for carries in (True, False)
        )
        self.table, self.spindle = self.work[0] if self.work else BED, self.tool[-1] if self.tool else BED
        self.origin = self._in_room(_carried(axes, self.from_bed(self.table), self.home), np.zeros(3))
        self.tip = self._in_room(_carried(axes, self.tool, self.home), np.array([0.0, 0.0, -machine.tool_length]))
        self.tip_now: Array = self.on_table(machine.frames(pose[None]).tcp)[0]
        ends = [(0.0, 0.0) if axis.rotary else axis.travel for axis in axes]
        reached = machine.frames(np.array(np.meshgrid(*ends)).reshape(len(ends), -1).T).tcp
        self.reach = reached.min(axis=0), reached.max(axis=0)
        sides = np.abs(self.upright @ (self.reach[1] - self.reach[0])) / 2
        self.half = np.maximum(sides, _LEAST * max(float(sides.max()), 1e-3))

    def way(self, axis: int) -> int:
        """Return along which direction of the room an axis lies most: 0 to the right, 1 to the back, 2 up."""
        return int(np.argmax(np.abs(self.upright @ np.array(self.machine.axes[axis].direction))))

    def growing(self, axis: int) -> Array:
        """Return the direction in which the part itself moves, or about which it turns, as its coordinate grows, (3,).

        At home, in the room; the workpiece side goes against its axis.
        """
        own = self.machine.axes[axis]
        there: Array = own.sign * self.upright @ np.array(own.direction)
        return there

    def axis_point(self, axis: int) -> Array:
        """Return a point on the line of a rotary axis at home, in the room, (3,) m."""
        order = self.from_bed(axis)[:-1]
        return self._in_room(_carried(self.machine.axes, order, self.home), np.array(self.machine.axes[axis].origin))

    def part_motion(self, part: int) -> Array:
        """Return the motion of a part in the room from home to the pose, (4, 4)."""
        order = self.from_bed(part)
        now, then = (_carried(self.machine.axes, order, pose) for pose in (self.pose, self.home))
        turned = np.eye(4)
        turned[:3, :3] = self.upright
        return turned @ now @ np.linalg.inv(then) @ turned.T

    def on_table(self, points: Array, turned: bool = True) -> Array:
        """Return points of the workpiece frame, (n, 3) m, in the room.  turned : whether rotary axes stand as posed"""
        pose = self.pose if turned else np.where([axis.rotary for axis in self.machine.axes], 0.0, self.pose)
        held = _carried(self.machine.axes, self.from_bed(self.table), pose)
        return self._in_room(held, np.atleast_2d(points))

    def direction_on_table(self, direction: Iterable[float]) -> Array:
        """Return a direction of the workpiece frame in the room, (3,)."""
        ends = self.on_table(np.array([np.zeros(3), np.array(list(direction))]))
        there: Array = ends[1] - ends[0]
        return there

    def from_bed(self, part: int) -> list[int]:
        """Return the axes between the bed and a part, its own last."""
        if part == BED:
            return []
        order = self.work[::-1] if part in self.work else self.tool
        return order[: order.index(part) + 1]

    def _in_room(self, motion: Array, points: Array) -> Array:
        return (points @ motion[:3, :3].T + motion[:3, 3]) @ self.upright.T


def _carried(axes: Sequence[Axis], order: Sequence[int], pose: Array) -> Array:
    """Return the motion of what the axes carry against the bed, (4, 4).  order : from the bed"""
    motion = np.eye(4)
    for k in order:
        step, direction, origin = np.eye(4), np.array(axes[k].direction), np.array(axes[k].origin)
        if axes[k].rotary:
            step[:3, :3] = rigid.turned_about(direction, pose[[k]])[0]
            step[:3, 3] = origin - step[:3, :3] @ origin
        else:
            step[:3, 3] = float(pose[k]) * direction
        motion = motion @ (np.linalg.inv(step) if axes[k].workpiece_side else step)
    return motion


Laid = tuple[int, Part]
"""A shape with the part of the machine that it belongs to."""


class Measures:
    """Measures that the rules share, m in the room at home.

    whole : the largest side of what the tool reaches; step : length of an arrow
    spindle : what spindle and ram are measured by: six lengths of the tool, within reason
    pad : by how much tables and beds are larger than what is reached
    ram : half the thickness of a ram; plate : depth of a carriage
    table, floor : height of the top of the table, and of the bed
    tops : height of the top of every part that carries the workpiece, by its axis
    framed : whether a gantry runs in a frame of four posts over a table that goes up and down
    """

    def __init__(self, room: StandingMachine) -> None:
        self.room, self.whole = room, 2 * float(room.half.max())
        self.spindle = float(np.clip(6 * room.machine.tool_length, 0.4 * self.whole, self.whole))
        self.pad, self.step = 0.07 * self.whole, 0.13 * self.whole
        self.ram, self.plate = 0.08 * self.spindle, 0.09 * self.whole
        self.table = float(room.tip[2] - room.half[2]) - 0.03 * self.whole
        self.tops, self.floor = dict[int, float](), self.table
        rotary, ways = [axis.rotary for axis in room.machine.axes], [room.way(k) for k in range(len(room.home))]
        for axis in room.work:
            self.tops[axis] = self.floor
            flat, upright = (0.17, 0.09) if rotary[axis] else (0.06, 0.3)
            self.floor -= (upright if ways[axis] == 2 else flat) * self.whole
        if not room.work:
            self.floor -= 0.07 * self.whole
        level = [k for k in room.tool if not rotary[k] and ways[k] < 2]
        self.framed = len(level) > 1 and any(not rotary[k] and ways[k] == 2 for k in room.work)


def up(height: float) -> Array:
    """Return a way up, (3,) m."""
    return np.array([0.0, 0.0, height])


def name_of(room: StandingMachine, axis: int) -> str:
    """Return the name of an axis as it is drawn, primed where it carries the workpiece."""
    own = room.machine.axes[axis]
    return own.name + ("′" if own.workpiece_side else "")


def under(room: StandingMachine, axis: int) -> int:
    """Return the part that carries the one of an axis."""
    return [BED, *room.from_bed(axis)][-2]


def straight(sizes: Measures, axis: int, start: Array) -> Laid:
    """Return the arrow of a linear axis: how the part itself moves as its coordinate grows.  start : (3,) m"""
    along = sizes.step * sizes.room.growing(axis)
    return axis, Arrow(np.array([start - 0.6 * along, start + along]), name_of(sizes.room, axis))


def turning(sizes: Measures, axis: int, centre: Array, radius: float, span: float = 110.0) -> Laid:
    """Return the arc of a rotary axis, on the side that is seen: how the part itself turns as its coordinate grows.

    centre : (3,) m; radius : m; span : deg
    """
    along = sizes.room.growing(axis)
    u = EYE - (EYE @ along) * along
    u /= np.linalg.norm(u)
    turns = np.radians(np.linspace(-span / 2, span / 2, 30))
    arc = centre + radius * (np.outer(np.cos(turns), u) + np.outer(np.sin(turns), np.cross(along, u)))
    return under(sizes.room, axis), Arrow(arc, name_of(sizes.room, axis), "gold")


def across(ends: Array) -> Iterator[tuple[int, Array]]:
    """Yield −1 and +1 with the vector to that end, of something that is as long as twice a vector, (3,) m."""
    for side in (-1, 1):
        yield side, side * ends
