"""A machine as it stands in a room: z up, and where each of its parts is at a pose.

A part is what one axis carries: it has the index of that axis, and the bed has `BED`. Parts begin at home, with linear
axes in the middle of their travels and rotary ones at 0. The chain moves them from there.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array, rigid

BED = -1
"""The part that nothing moves."""
_LYING: Array = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Machine frame to room of a lathe: z to the right, x towards who stands there."""
_LEAST = 0.12
"""Share of its largest side that every side of the volume has at least in a drawing; a matter of taste."""


@dataclass(frozen=True, eq=False)
class StandingMachine:
    """A machine at a pose.  pose : (q,) m or rad"""

    machine: Machine
    pose: Array

    @cached_property
    def lying(self) -> bool:
        """Whether the spindle lies as that of a lathe does: X and Z are all linear axes, and rotary axes turn about Z.

        ISO 841 calls the direction of the main spindle Z; without a Y nothing reaches around a standing one.
        """
        ways = {int(np.argmax(np.abs(axis.direction))) for axis in self.machine.axes if not axis.rotary}
        turns = {int(np.argmax(np.abs(axis.direction))) for axis in self.machine.axes if axis.rotary}
        return ways == {0, 2} and turns <= {2}

    @cached_property
    def upright(self) -> Array:
        """The rotation from the machine frame to the room, (3, 3)."""
        return _LYING if self.lying else np.eye(3)

    @cached_property
    def home(self) -> Array:
        """The pose at which parts are laid out, (q,)."""
        return np.array([0.0 if axis.rotary else sum(axis.travel) / 2 for axis in self.machine.axes])

    @cached_property
    def work(self) -> list[int]:
        """The axes that carry the workpiece, from the workpiece to the bed."""
        return [k for k, axis in enumerate(self.machine.axes) if axis.workpiece_side]

    @cached_property
    def tool(self) -> list[int]:
        """The axes that carry the tool, from the bed to the tool."""
        return [k for k, axis in enumerate(self.machine.axes) if not axis.workpiece_side]

    @property
    def table(self) -> int:
        """The part on which the workpiece lies."""
        return self.work[0] if self.work else BED

    @property
    def spindle(self) -> int:
        """The part that holds the tool."""
        return self.tool[-1] if self.tool else BED

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

    def line(self, axis: int) -> Array:
        """Return a point on the line of a rotary axis at home, in the room, (3,) m."""
        order = self._from_bed(axis)[:-1]
        return self._in_room(_carried(self.machine.axes, order, self.home), np.array(self.machine.axes[axis].origin))

    def moved(self, part: int) -> Array:
        """Return the motion of a part in the room from home to the pose, (4, 4)."""
        order = self._from_bed(part)
        now, then = (_carried(self.machine.axes, order, pose) for pose in (self.pose, self.home))
        turned = np.eye(4)
        turned[:3, :3] = self.upright
        motion: Array = turned @ now @ np.linalg.inv(then) @ turned.T
        return motion

    def on_table(self, points: Array, turned: bool = True) -> Array:
        """Return points of the workpiece frame, (n, 3) m, in the room.  turned : whether rotary axes stand as posed"""
        pose = self.pose if turned else np.where([axis.rotary for axis in self.machine.axes], 0.0, self.pose)
        held = _carried(self.machine.axes, self._from_bed(self.table), pose)
        return self._in_room(held, np.atleast_2d(points))

    def direction_on_table(self, direction: Iterable[float]) -> Array:
        """Return a direction of the workpiece frame in the room, (3,)."""
        ends = self.on_table(np.array([np.zeros(3), np.array(list(direction))]))
        there: Array = ends[1] - ends[0]
        return there

    @cached_property
    def origin(self) -> Array:
        """The origin of the workpiece frame at home, in the room, (3,) m."""
        return self._in_room(_carried(self.machine.axes, self._from_bed(self.table), self.home), np.zeros(3))

    @cached_property
    def tip(self) -> Array:
        """The tool point at home, in the room, (3,) m."""
        held = _carried(self.machine.axes, self.tool, self.home)
        return self._in_room(held, np.array([0.0, 0.0, -self.machine.tool]))

    @cached_property
    def tip_now(self) -> Array:
        """The tool point at the pose, in the room, (3,) m."""
        tcp = frames(self.machine, self.pose[None]).tcp
        here: Array = self.on_table(tcp)[0]
        return here

    @cached_property
    def reach(self) -> tuple[Array, Array]:
        """Low and high corner of the tool's reach in the workpiece frame with rotary axes at 0, (3,) m each."""
        ends = [(0.0, 0.0) if axis.rotary else axis.travel for axis in self.machine.axes]
        poses = np.array(np.meshgrid(*ends)).reshape(len(ends), -1).T
        tcp = frames(self.machine, poses).tcp
        return tcp.min(axis=0), tcp.max(axis=0)

    @cached_property
    def half(self) -> Array:
        """Half the sides of the tool's reach along the room's directions, none of them 0, (3,) m."""
        low, high = self.reach
        sides = np.abs(self.upright @ (high - low)) / 2
        return np.maximum(sides, _LEAST * max(float(sides.max()), 1e-3))

    @property
    def size(self) -> float:
        """The largest side of what the tool reaches, m."""
        return 2 * float(self.half.max())

    def _from_bed(self, part: int) -> list[int]:
        """Return the axes between the bed and a part, its own last."""
        if part == BED:
            return []
        order = self.work[::-1] if part in self.work else self.tool
        return order[: order.index(part) + 1]

    def _in_room(self, motion: Array, points: Array) -> Array:
        there: Array = (points @ motion[:3, :3].T + motion[:3, 3]) @ self.upright.T
        return there


def _carried(axes: Sequence[Axis], order: Sequence[int], pose: Array) -> Array:
    """Return the motion of what the axes carry against the bed, (4, 4).  order : from the bed"""
    motion = np.eye(4)
    for k in order:
        step = _step(axes[k], float(pose[k]))
        motion = motion @ (np.linalg.inv(step) if axes[k].workpiece_side else step)
    return motion


def _step(axis: Axis, coordinate: float) -> Array:
    """Return the motion of one axis, (4, 4), in the machine frame at 0."""
    step, direction = np.eye(4), np.array(axis.direction)
    if axis.rotary:
        step[:3, :3] = rigid.turned_about(direction, np.array([coordinate]))[0]
        step[:3, 3] = np.array(axis.origin) - step[:3, :3] @ np.array(axis.origin)
    else:
        step[:3, 3] = coordinate * direction
    return step
