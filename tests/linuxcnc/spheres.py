"""A machine with a hidden truth that touches spheres through a running LinuxCNC, as a probing cycle would.

The tip is at p(m) + δp(m) when the motors are at m. Before each touch the simulated sphere is put where the motors will
meet it, so that every side is met with the errors of its own place and with the reversals of the way it is come from.
What is read is where the sphere stands less where the control says that it found it: y = b − p, which is δp there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.machine.description import Machine
from axiscal.machine.kinematics import Deviation, drawn_back, frames, tip_at
from axiscal.measurement.setup import Setup
from axiscal.measurement.simulation import VirtualMachine
from axiscal.measurement.touched import Sphere
from axiscal.numerics import Array
from axiscal.units import from_unit, to_unit
from tests.linuxcnc.lab import Session
from tests.linuxcnc.probing import Probe, Touch, cycle, placed, touched

_TOUCHES = 2
"""Touches of which a coordinate of the centre is the mean: two sides, or the pole twice."""
_ASIDE = 1e-9
"""m: rounding of an axis that stands while a side is touched."""

_Name = tuple[str, int]
"""What a sphere is called: what it stands on, and its number there."""


class TouchedSpheres:
    """The spheres of set-ups on a swivelling table whose tool point LinuxCNC holds in TCP mode.

    session : with kinematics that are switched by M68 E3, identity first, and with the HAL text of `probing.ball`
    order : of the machine's axes as LinuxCNC's joints; overrun : m or rad, from where a rotary axis is come to
    """

    def __init__(
        self, session: Session, truth: VirtualMachine, order: Sequence[int], overrun: Array, probe: Probe
    ) -> None:
        self._session, self._truth, self._order, self._overrun, self._probe = session, truth, order, overrun, probe
        self._last: tuple[Setup, Array] | None = None
        self._known: dict[_Name, Array] = {}
        self.found: list[Sphere] = []

    @property
    def _machine(self) -> Machine:
        return self._truth.model.machine

    def read(
        self, setup: Setup, pose: tuple[float, ...], approach: tuple[int, ...], rng: np.random.Generator
    ) -> tuple[float, ...]:
        """Go to the sphere that a pose is at, touch it, return its three values, m; raises ControlError.

        A sphere that was never touched is found roughly first, so that its sides are met where they are.
        """
        at = np.array(pose)
        motors = self._gone(setup, at, np.array(approach, dtype=float))
        standing = frames(self._machine, at[None])
        sideways = np.stack([_unit(self._way(at, axis), standing.stem[0]) for axis in "XY"])

        def before(touch: Touch) -> list[str]:
            scatter = setup.scatter * np.sqrt(_TOUCHES) * rng.standard_normal()
            return placed(self._met(setup, at, motors, touch, scatter))

        stated, which = self._stated(setup, standing.tcp)
        looks = [self._known[which]] if which in self._known else [np.zeros(3), None]
        for look in looks:
            off = self._known[which] if look is None else look
            touches = cycle(to_unit(stated + off, "mm"), standing.stem[0], sideways, self._probe)
            found = touched(self._session, touches, before, self._probe, to_unit(self._machine.tool, "mm"))
            self._known[which] = from_unit(np.array(found.centre), "mm") - stated
        self.found.append(found)
        return tuple((-self._known[which]).tolist())

    @staticmethod
    def _stated(setup: Setup, tips: Array) -> tuple[Array, _Name]:
        """Return where the sphere that the tip is at is said to stand, (3,) m, and what it is called."""
        if setup.artefact is None:
            return tips[0], (setup.name, 0)
        ball = int(setup.artefact.nearest(tips, setup.balls)[0])
        return setup.artefact.points[ball], (setup.artefact.standing, ball)

    def _way(self, pose: Array, axis: str) -> Array:
        """Return the direction (3,) on the workpiece in which a linear axis carries the tip."""
        moved = pose.copy()
        moved[self._machine.index(axis)] += 1.0
        tips = frames(self._machine, np.stack([pose, moved])).tcp
        way: Array = tips[1] - tips[0]
        return way

    def _met(self, setup: Setup, pose: Array, motors: Array, touch: Touch, scatter: float) -> list[float]:
        """Return where the motors of X, Y, Z have the tip at the middle of the sphere while a side is touched, mm."""
        machine, there = self._machine, from_unit(touch.place, "mm")
        beside = there + touch.side * from_unit(self._probe.clear, "mm")
        away, at = tip_at(machine, np.tile(motors, (2, 1)), np.stack([beside, there]))
        come = np.where(np.abs(at - away) > _ASIDE, np.sign(at - away), 0.0)[None]
        actual = Deviation(self._truth.deviation(at[None], come), self._truth.rotation(at[None], come))
        off = np.array(self._truth.exactly(setup, pose[None], actual))
        middle = self._stated(setup, frames(machine, pose[None]).tcp)[0] - off + scatter * touch.side
        met = tip_at(machine, motors[None], middle[None])[0]
        return [float(to_unit(met[machine.index(axis)], "mm")) for axis in "XYZ"]

    def _gone(self, setup: Setup, pose: Array, approach: Array) -> Array:
        """Draw the tool back from the last sphere and go to the next one; returns where the motors are, (q,)."""
        machine, codes = self._machine, list[str]()
        if self._last is not None:
            far = to_unit(self._last[0].retract, "mm")
            last = frames(machine, self._last[1][None])
            codes.append("G0 " + self._words("XYZ", 1e3 * last.tcp[0] + far * last.stem[0]))
        drawn = drawn_back(machine, pose[None], setup.retract)[0]
        turning = [k for k, axis in enumerate(machine.axes) if axis.rotary]
        beside = drawn.copy()
        beside[turning] -= approach[turning] * self._overrun[turning]
        level = [axis.name for axis in machine.axes if axis.name != "Z"]
        codes += ["M68 E3 Q0", "M66 E0 L0", "G49"]
        codes.append(f"G53 G0 Z{to_unit(machine.axis('Z').travel[1], 'mm'):.7f}")
        codes += [f"G53 G0 {self._shown(level, each)}" for each in (beside, drawn)]
        codes.append(f"G53 G0 {self._shown(['Z'], drawn)}")
        codes += [f"G43.1 Z{to_unit(machine.tool, 'mm'):.7f}", "M68 E3 Q1", "M66 E0 L0"]
        steps = self._session.move(codes)
        self._last = setup, pose
        motors = np.empty(len(machine.axes))
        for k, motor in zip(self._order, steps[-1].motor, strict=True):
            motors[k] = from_unit(motor, machine.axes[k].unit)
        return motors

    def _shown(self, names: Sequence[str], pose: Array) -> str:
        axes = [self._machine.axis(name) for name in names]
        return self._words(names, [to_unit(pose[self._machine.index(axis.name)], axis.unit) for axis in axes])

    @staticmethod
    def _words(names: Sequence[str], values: Sequence[float] | Array) -> str:
        return " ".join(f"{name}{float(value) + 0.0:.7f}" for name, value in zip(names, values, strict=True))


def _unit(way: Array, stem: Array) -> Array:
    """Return the unit vector along a way across the stem."""
    across = way - (way @ stem) * stem
    return across / np.linalg.norm(across)
