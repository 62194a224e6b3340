"""`linuxcnc[:SEED|:FILE]`: a virtual machine that is moved by a real LinuxCNC.

LinuxCNC makes every move; where it sends the motors, the hidden errors of the virtual machine are added. Tables that
are loaded into it act as they would on the shop floor.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from axiscal.campaign.sources.source import Answer, Request, Skip, Source
from axiscal.exceptions import SourceError

if TYPE_CHECKING:
    from axiscal.lab.linuxcnc import Joint, Session
    from axiscal.lab.linuxcnc.configuration import Cross
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

    tables : loaded into LinuxCNC, or None for none; seen : the machine as its instruments see it
    Raises ControlError.
    """

    def __init__(self, truth: VirtualMachine, tables: Tables | None = None) -> None:
        from axiscal.compensation.commanded import CommandedMachine
        from axiscal.lab.linuxcnc import Session

        self._machine = truth.model.machine
        self._axes = sorted(range(len(self._machine.axes)), key=lambda k: _ORDER.index(_letter(self._machine.axes[k])))
        files = {} if tables is None else tables.files
        joints = [_joint(self._machine.axes[k], files) for k in self._axes]
        self._session: Session = Session(joints, cross=_cross(joints, files))
        self._last: tuple[Array, Array, Array] | None = None
        self.seen: VirtualMachine = CommandedMachine.behind(truth, self.sent)

    def sent(self, poses: Array, approaches: Array) -> Array:
        """Move to poses (m, q) and return where the motors were sent, (m, q), m or rad.

        Where it stands already LinuxCNC is not moved again.
        """
        import numpy as np

        last = self._last
        if last is not None and np.array_equal(poses, last[0]) and np.array_equal(approaches, last[1]):
            return last[2]
        codes = [code for pose, signs in zip(poses, approaches, strict=True) for code in self._codes(pose, signs)]
        steps = self._session.move(codes)[1::2]
        result = np.empty(poses.shape)
        for row, step in zip(result, steps, strict=True):
            for k, motor in zip(self._axes, step.motor, strict=True):
                row[k] = motor / _scale(self._machine.axes[k])
        self._last = poses.copy(), approaches.copy(), result
        return result

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

    def _codes(self, pose: Array, signs: Array) -> list[str]:
        """Return a move beside the pose and one to it; axes without a direction come upwards."""
        words: list[list[str]] = [[], []]
        for k in self._axes:
            axis = self._machine.axes[k]
            target = float(pose[k]) * _scale(axis)
            for line, at in zip(words, (target - (float(signs[k]) or 1.0) * _OVERRUN, target), strict=True):
                line.append(f"{_letter(axis)}{at:.6f}")
        return [f"G53 G0 {' '.join(line)}" for line in words]


class LinuxcncSource:
    """The machine as a source: LinuxCNC starts with the first reading.

    simulated : makes the source that reads a virtual machine
    """

    def __init__(
        self, truth: VirtualMachine, simulated: Callable[[VirtualMachine], Source], tables: Tables | None = None
    ) -> None:
        self._truth, self._simulated, self._tables = truth, simulated, tables
        self._running: tuple[LinuxcncMachine, Source] | None = None

    def read(self, request: Request) -> Answer | Skip:
        """Return the reading; raises ControlError."""
        if self._running is None:
            machine = LinuxcncMachine(self._truth, self._tables)
            self._running = machine, self._simulated(machine.seen)
        return self._running[1].read(request)

    def close(self) -> None:
        """Stop LinuxCNC; may be called twice."""
        if self._running is not None:
            self._running[0].close()


def _letter(axis: Axis) -> str:
    if axis.name not in _ORDER:
        raise SourceError(f"LinuxCNC has no axis {axis.name}", f"Its axes are {', '.join(_ORDER)}")
    return axis.name


def _scale(axis: Axis) -> float:
    from axiscal.units import to_unit

    return to_unit(1.0, axis.unit)


def _joint(axis: Axis, files: Mapping[str, str]) -> Joint:
    from axiscal.lab.linuxcnc import Joint

    low, high = (bound * _scale(axis) for bound in axis.travel)
    return Joint(axis.name, min(low, 0.0) - _ROOM, max(high, 0.0) + _ROOM, table=files.get(f"{axis.name}.comp"))


def _cross(joints: Sequence[Joint], files: Mapping[str, str]) -> Cross | None:
    from axiscal.lab.linuxcnc.configuration import Cross

    text = next((text for name, text in files.items() if name.endswith(".hal")), "")
    axes = tuple(joint.axis for joint in joints if f"axiscal-{joint.axis.lower()}-motor" in text)
    return Cross(axes, text) if axes else None
