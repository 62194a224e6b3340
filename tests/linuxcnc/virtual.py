"""A virtual machine that is moved by a real LinuxCNC.

LinuxCNC makes every move; where it sends the motors, the hidden errors of the virtual machine are added. Tables that
are loaded into it act as they would on the shop floor.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Self

import numpy as np

from axiscal.exceptions import SourceError
from axiscal.machine import Axis
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal.tables.surface import CommandedMachine
from axiscal.units import to_unit
from tests.linuxcnc.lab import Joint, Session, Settings
from tests.linuxcnc.running import ControlError

_ORDER = "XYZABCUVW"
_OVERRUN = 2.0
"""mm or deg before a target from which it is approached: more than the backlash of any simulated joint."""
_GAIN = "axiscal-gain"
_WHOLE = "axiscal-vcomp"
_COMING = 20.0
"""s that a correction may take to come, which is a second or two."""
_ROOM = 10.0
"""mm or deg beyond the travel that the simulated joints are given, for overrun and compensation."""


class LinuxcncMachine:
    """A virtual machine behind a running LinuxCNC with a joint for each axis, in mm and deg; a context manager.

    tables : files of `axiscal export --to linuxcnc` or `--to linuxcnc-volumetric` that it loads, by name
    seen : the machine as its instruments see it
    Raises ControlError.
    """

    def __init__(self, truth: VirtualMachine, tables: Mapping[str, str] | None = None) -> None:
        self._machine = truth.model.machine
        self._axes = sorted(range(len(self._machine.axes)), key=lambda k: _ORDER.index(_letter(self._machine.axes[k])))
        settings = self._settings(tables or {})
        self._session: Session = Session(self._joints(tables or {}), settings)
        self._make_ready(settings.hal)
        self._last: tuple[Array, Array, Array] | None = None
        self.seen: VirtualMachine = CommandedMachine.behind(truth, self.sent)

    def sent(self, poses: Array, approaches: Array) -> Array:
        """Move to poses (m, q) and return where the motors were sent, (m, q), m or rad.

        LinuxCNC is not moved where it stands already.
        """
        last = self._last
        if last is not None and np.array_equal(poses, last[0]) and np.array_equal(approaches, last[1]):
            return last[2]
        codes = [code for pose, signs in zip(poses, approaches, strict=True) for code in self._codes(pose, signs)]
        steps = self._session.move(codes)[1::2]
        result = np.empty(poses.shape)
        for row, step in zip(result, steps, strict=True):
            for k, motor in zip(self._driven, step.motor, strict=True):
                row[k] = motor / self._scale(self._machine.axes[k])
        self._last = poses.copy(), approaches.copy(), result
        return result

    @property
    def errors(self) -> tuple[str, ...]:
        """The messages of LinuxCNC to the operator."""
        return self._session.errors

    def close(self) -> None:
        """Stop LinuxCNC."""
        self._session.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _make_ready(self, hal: str) -> None:
        """Wait until corrections that come slowly, after homing or when they are switched on, are all there."""
        gains = [gain for mark, gain in ((_GAIN, _GAIN), (_WHOLE, f"{_WHOLE}.gain")) if mark in hal]
        if _WHOLE in hal:
            self._session.move([f"setp {_WHOLE}.enable 1"])
        end = time.monotonic() + _COMING
        while gains and min(self._session.read(gains)) < 1.0:
            if time.monotonic() > end:
                remedy = "Look at the pin {component}.fault-code"
                raise ControlError("the correction did not come", remedy, component=_WHOLE)
            time.sleep(0.05)

    @property
    def _overrun(self) -> Array:
        """How far before a target each axis is come from, (q,) m or rad."""
        return np.array([_OVERRUN / to_unit(1.0, axis.unit) for axis in self._machine.axes])

    @property
    def _driven(self) -> list[int]:
        """The axis of each joint."""
        return self._axes

    def _codes(self, pose: Array, signs: Array) -> list[str]:
        """Return a move beside the pose and one to it; axes without a direction come upwards."""
        before = pose - np.where(signs == 0, 1.0, np.sign(signs)) * self._overrun
        return [self._code(at) for at in (before, pose)]

    def _code(self, pose: Array) -> str:
        """Return the move that brings the joints to a pose."""
        shown = ((self._machine.axes[k], float(pose[k])) for k in self._axes)
        return " ".join(["G53 G0", *(f"{axis.name}{at * self._scale(axis):.7f}" for axis, at in shown)])

    def _scale(self, axis: Axis) -> float:
        return to_unit(1.0, axis.unit)

    def _joints(self, files: Mapping[str, str]) -> list[Joint]:
        """Return the joints in the order of their numbers, with their tables."""
        found = []
        for axis in (self._machine.axes[k] for k in self._axes):
            low, high = (to_unit(end, axis.unit) for end in (min(axis.travel[0], 0.0), max(axis.travel[1], 0.0)))
            found.append(Joint(axis.name, low - _ROOM, high + _ROOM, table=files.get(f"{axis.name}.comp")))
        return found

    def _settings(self, files: Mapping[str, str]) -> Settings:
        """Return what LinuxCNC is given besides its joints."""
        return Settings.loading(files)


def _letter(axis: Axis) -> str:
    if axis.name not in _ORDER:
        remedy = "Its axes are {known}"
        raise SourceError("LinuxCNC has no axis {axis}", remedy, axis=axis.name, known=", ".join(_ORDER))
    return axis.name
