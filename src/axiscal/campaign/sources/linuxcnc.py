"""`linuxcnc[:SEED|:FILE]`: a virtual machine that is moved by a real LinuxCNC.

LinuxCNC makes every move; where it sends the motors, the hidden errors of the virtual machine are added. Tables that
are loaded into it act as they would on the shop floor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from axiscal.campaign.sources.source import Answer, Request
from axiscal.exceptions import SourceError
from axiscal.measurement.setup import Setup

if TYPE_CHECKING:
    import numpy as np

    from axiscal.compensation.controllers.linuxcnc.headless import Joint, Session
    from axiscal.compensation.controllers.linuxcnc.headless.configuration import Cross
    from axiscal.machine import Axis
    from axiscal.numerics import Array
    from axiscal.simulation import VirtualMachine

_ORDER = "XYZABCUVW"
_OVERRUN = 2.0
_ROOM = 10.0


@dataclass(frozen=True, slots=True)
class Tables:
    """Files as `axiscal export --to linuxcnc` writes them, by name."""

    files: Mapping[str, str]


class LinuxcncMachine:
    """A virtual machine behind a running LinuxCNC; a context manager.

    tables : loaded into LinuxCNC, or None for none
    Raises ControlError.
    """

    def __init__(self, truth: VirtualMachine, tables: Tables | None = None) -> None:
        from axiscal.compensation.controllers.linuxcnc.headless import Session

        machine = truth.model.machine
        self._machine, self._truth = machine, truth
        self._axes = sorted(range(len(machine.axes)), key=lambda k: _ORDER.index(_letter(machine.axes[k])))
        files = {} if tables is None else tables.files
        joints = [_joint(machine.axes[k], files) for k in self._axes]
        self._session: Session = Session(joints, cross=_cross(joints, files))

    def sent(self, poses: Sequence[Sequence[float]], approaches: Sequence[Sequence[int]]) -> Array:
        """Move to poses and return where the motors were sent, (m, q), m or rad."""
        import numpy as np

        codes = [code for pose, signs in zip(poses, approaches, strict=True) for code in self._codes(pose, signs)]
        steps = self._session.move(codes)[1::2]
        result = np.empty((len(steps), len(self._axes)))
        for row, step in zip(result, steps, strict=True):
            for k, motor in zip(self._axes, step.motor, strict=True):
                row[k] = motor / _scale(self._machine.axes[k])
        return result

    def deviation(self, poses: Array, approaches: Array) -> Array:
        """Return the true TCP deviation from what was commanded, (m, 3), m."""
        from axiscal.machine.kinematics import frames

        sent = self.sent(poses.tolist(), approaches.astype(int).tolist())
        shift: Array = frames(self._machine, sent).tcp - frames(self._machine, poses).tcp
        return shift + self._truth.deviation(sent, approaches)

    def read(self, setup: Setup, pose: tuple[float, ...], approach: tuple[int, ...], rng: np.random.Generator) -> float:
        """Return what the set-up would show at a pose."""
        from axiscal.measurement.instrument import INSTRUMENTS

        sent = self.sent([pose], [approach])
        shown = self._truth.read(setup, tuple(map(float, sent[0])), approach, rng)
        length = INSTRUMENTS[setup.instrument].reads == "length"
        return shown + (self._shift(pose, sent, setup) if length else self._turn(pose, sent, setup))

    @property
    def errors(self) -> tuple[str, ...]:
        """What LinuxCNC has told the operator."""
        return self._session.errors

    def close(self) -> None:
        """Stop LinuxCNC."""
        self._session.close()

    def __enter__(self) -> LinuxcncMachine:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _codes(self, pose: Sequence[float], signs: Sequence[int]) -> list[str]:
        """Return a move beside the pose and one to it; axes without a direction come upwards."""
        words: list[list[str]] = [[], []]
        for k in self._axes:
            axis = self._machine.axes[k]
            target = pose[k] * _scale(axis)
            for line, at in zip(words, (target - (signs[k] or 1) * _OVERRUN, target), strict=True):
                line.append(f"{_letter(axis)}{at:.6f}")
        return [f"G53 G0 {' '.join(line)}" for line in words]

    def _shift(self, pose: tuple[float, ...], sent: Array, setup: Setup) -> float:
        import numpy as np

        from axiscal.machine.kinematics import frames

        tips = [frames(self._machine, np.atleast_2d(at)).tcp[0] for at in (sent, np.array(pose))]
        return float((tips[0] - tips[1]) @ np.array(setup.direction))

    def _turn(self, pose: tuple[float, ...], sent: Array, setup: Setup) -> float:
        import numpy as np

        from axiscal.machine.kinematics import frames

        nominal = frames(self._machine, np.array([pose])).rotations
        turned = sum(
            (sent[0, k] - pose[k]) * (nominal[k, 0] @ np.array(axis.direction))
            for k, axis in enumerate(self._machine.axes)
            if axis.rotary
        )
        return float(np.dot(turned, setup.direction)) if np.ndim(turned) else 0.0


class LinuxcncSource:
    """The machine as a source: LinuxCNC starts with the first reading.

    The noise of a reading depends on its number only, so that a run that is resumed is the same run.
    """

    def __init__(self, truth: VirtualMachine, seed: int, tables: Tables | None = None) -> None:
        self._truth, self._seed, self._tables = truth, seed, tables
        self._running: LinuxcncMachine | None = None

    def read(self, request: Request) -> Answer:
        """Return the reading; raises ControlError."""
        import numpy as np

        if self._running is None:
            self._running = LinuxcncMachine(self._truth, self._tables)
        rng = np.random.default_rng((self._seed, request.reading))
        return Answer(self._running.read(request.setup, request.pose, request.approach, rng))

    def close(self) -> None:
        """Stop LinuxCNC; may be called twice."""
        if self._running is not None:
            self._running.close()


def _letter(axis: Axis) -> str:
    if axis.name not in _ORDER:
        raise SourceError(f"LinuxCNC has no axis {axis.name}", f"Its axes are {', '.join(_ORDER)}")
    return axis.name


def _scale(axis: Axis) -> float:
    from axiscal.units import to_unit

    return to_unit(1.0, "deg" if axis.rotary else "mm")


def _joint(axis: Axis, files: Mapping[str, str]) -> Joint:
    from axiscal.compensation.controllers.linuxcnc.headless import Joint

    low, high = (bound * _scale(axis) for bound in axis.travel)
    return Joint(axis.name, min(low, 0.0) - _ROOM, max(high, 0.0) + _ROOM, table=files.get(f"{axis.name}.comp"))


def _cross(joints: Sequence[Joint], files: Mapping[str, str]) -> Cross | None:
    from axiscal.compensation.controllers.linuxcnc.headless.configuration import Cross

    text = next((text for name, text in files.items() if name.endswith(".hal")), "")
    axes = tuple(joint.axis for joint in joints if f"axiscal-{joint.axis.lower()}-motor" in text)
    return Cross(axes, text) if axes else None
