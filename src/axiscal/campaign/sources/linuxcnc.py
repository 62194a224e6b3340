"""`linuxcnc[:SEED|:FILE]`: a virtual machine that is moved by a real LinuxCNC.

LinuxCNC makes every move; where it sends the motors, the hidden errors of the virtual machine are added. Tables that
are loaded into it act as they would on the shop floor.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from axiscal.campaign.sources.source import Answer, Request, Skip, Source
from axiscal.exceptions import ControlError, SourceError
from axiscal.units import to_unit

if TYPE_CHECKING:
    from axiscal.lab.linuxcnc import Joint, Session, Settings
    from axiscal.lab.linuxcnc.probing import Probe
    from axiscal.lab.linuxcnc.spheres import TouchedSpheres
    from axiscal.machine import Axis
    from axiscal.numerics import Array
    from axiscal.simulation import VirtualMachine

_ORDER = "XYZABCUVW"
_OVERRUN = 2.0
"""mm or deg before a target from which it is approached: more than the backlash of any simulated joint."""
_GAIN = "axiscal-gain"
_WHOLE = "axiscal-vcomp"
_SOURCE = "axiscal_vcomp"
_COMING = 20.0
"""s that a correction may take to come, which is a second or two."""
_ROOM, _SWING = 10.0, 400.0
"""mm or deg beyond the travel that the simulated joints are given, for overrun and compensation."""


@dataclass(frozen=True, slots=True)
class Tables:
    """Files as `axiscal export --to linuxcnc` or `--to linuxcnc-volumetric` writes them, by name."""

    files: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Build:
    """How a LinuxCNC machine is built.

    unit : of its configuration, mm or in; pairs : axes that two joints drive
    tcp : it turns with xyzac- or xyzbc-trt-kins, and positions are those of the tool on the workpiece
    probe : how it touches spheres, in TCP mode; None where nothing is touched
    """

    unit: str = "mm"
    pairs: str = ""
    tcp: bool = False
    probe: Probe | None = None


class LinuxcncMachine:
    """A virtual machine behind a running LinuxCNC; a context manager.

    tables : loaded into LinuxCNC, or None for none; seen : the machine as its instruments see it
    Raises ControlError.
    """

    def __init__(self, truth: VirtualMachine, tables: Tables | None = None, build: Build | None = None) -> None:
        from axiscal.compensation.commanded import CommandedMachine
        from axiscal.lab.linuxcnc import Session

        self._machine = truth.model.machine
        self._axes = sorted(range(len(self._machine.axes)), key=lambda k: _ORDER.index(_letter(self._machine.axes[k])))
        self._build = build or Build()
        files = {} if tables is None else tables.files
        joints = [joint for k in self._axes for joint in self._joints(self._machine.axes[k], files)]
        settings = self._settings(files)
        self._session: Session = Session(joints, settings)
        if self._build.tcp:
            tool = f"G43.1 Z{self._machine.tool * self._scale(self._machine.axis('Z')):.7f}"
            self._session.move([tool, *(["M68 E3 Q1", "M66 E0 L0"] if self._build.probe else [])])
        self._wait_until_corrected(settings.hal)
        self._last: tuple[Array, Array, Array] | None = None
        self.seen: VirtualMachine = CommandedMachine.behind(truth, self.sent)
        self.spheres = self._spheres(truth)

    def sent(self, poses: Array, approaches: Array) -> Array:
        """Move to poses (m, q) and return where the motors were sent, (m, q), m or rad.

        LinuxCNC is not moved where it stands already.
        """
        import numpy as np

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

    def __enter__(self) -> LinuxcncMachine:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _wait_until_corrected(self, hal: str) -> None:
        """Wait until corrections that come slowly, after homing or when they are switched on, are all there."""
        gains = [gain for mark, gain in ((_GAIN, _GAIN), (_WHOLE, f"{_WHOLE}.gain")) if mark in hal]
        if _WHOLE in hal:
            self._session.move([f"setp {_WHOLE}.enable 1"])
        end = time.monotonic() + _COMING
        while gains and min(self._session.read(gains)) < 1.0:
            if time.monotonic() > end:
                raise ControlError("the correction did not come", f"Look at the pin {_WHOLE}.fault-code")
            time.sleep(0.05)

    def _spheres(self, truth: VirtualMachine) -> TouchedSpheres | None:
        """Return what touches spheres, where it is built to."""
        if self._build.probe is None:
            return None
        from axiscal.lab.linuxcnc.spheres import TouchedSpheres

        return TouchedSpheres(self._session, truth, self._driven, self._overrun, self._build.probe)

    @property
    def _overrun(self) -> Array:
        """How far before a target each axis is come from, (q,) m or rad."""
        import numpy as np

        return np.array([_OVERRUN / to_unit(1.0, axis.unit) for axis in self._machine.axes])

    @property
    def _driven(self) -> list[int]:
        """The axis of each joint."""
        return [k for k in self._axes for _ in range(1 + (self._machine.axes[k].name in self._build.pairs))]

    def _codes(self, pose: Array, signs: Array) -> list[str]:
        """Return a move beside the pose and one to it; axes without a direction come upwards."""
        import numpy as np

        before = pose - np.where(signs == 0, 1.0, np.sign(signs)) * self._overrun
        return [self._code(at) for at in (before, pose)]

    def _code(self, pose: Array) -> str:
        """Return the move that brings the joints to a pose."""
        from axiscal.machine.kinematics import frames

        shown = {_letter(self._machine.axes[k]): float(pose[k]) for k in self._axes}
        if self._build.tcp:
            shown |= dict(zip("XYZ", map(float, frames(self._machine, pose[None]).tcp[0]), strict=True))
        words = [f"{letter}{at * self._scale(self._machine.axis(letter)):.7f}" for letter, at in shown.items()]
        return " ".join(["G0" if self._build.tcp else "G53 G0", *words])

    def _scale(self, axis: Axis) -> float:
        return to_unit(1.0, axis.unit if axis.rotary else self._build.unit)

    def _joints(self, axis: Axis, files: Mapping[str, str]) -> list[Joint]:
        """Return the joints of an axis, in the units of the configuration."""
        from axiscal.lab.linuxcnc import Joint

        room, scale = (_SWING if self._build.tcp else _ROOM) / to_unit(1.0, axis.unit), self._scale(axis)
        low, high = min(axis.travel[0], 0.0) - room, max(axis.travel[1], 0.0) + room
        table = files.get(f"{_letter(axis)}.comp")
        fast = scale / to_unit(1.0, axis.unit)
        joint = Joint(axis.name, low * scale, high * scale, 5000 * fast, 5e5 * fast, table)
        return [joint, joint] if axis.name in self._build.pairs else [joint]

    def _settings(self, files: Mapping[str, str]) -> Settings:
        """Return what LinuxCNC is given besides its joints: HAL files in their order, or the place of axes as built."""
        from axiscal.compensation.controllers.linuxcnc import pivots
        from axiscal.lab.linuxcnc import Settings

        texts = [text for name, text in files.items() if name.endswith(".hal")]
        sources = {name: text for name, text in files.items() if name.startswith(_SOURCE)}
        beside = {name: text for name, text in files.items() if name.endswith(".vcomp")}
        if not self._build.tcp:
            return Settings("".join(texts), unit=self._build.unit, beside=beside, sources=sources)
        nominal = pivots.pivots(self._machine, {})
        if not any(nominal.kinematics in text for text in texts):
            texts.append(pivots.write(nominal, self._build.unit))
        texts.append(f"net tool-length motion.tooloffset.z => {nominal.kinematics}.tool-offset\n")
        kinematics = nominal.kinematics
        if self._build.probe is None:
            return Settings("".join(texts), kinematics, self._build.unit, beside=beside, sources=sources)
        from axiscal.lab.linuxcnc.probing import ball

        texts += [
            "net kinstype-select motion.analog-out-03 => motion.switchkins-type\n",
            ball(self._build.probe.radius, "".join(texts)),
        ]
        kinematics += " sparm=identityfirst"
        return Settings("".join(texts), kinematics, self._build.unit, beside=beside, sources=sources)


class LinuxcncSource:
    """The machine as a source: LinuxCNC starts with the first reading.

    simulated : makes the source that reads a virtual machine; seed : of how a probe's touches scatter
    """

    def __init__(
        self,
        truth: VirtualMachine,
        simulated: Callable[[VirtualMachine], Source],
        tables: Tables | None = None,
        build: Build | None = None,
        seed: int = 0,
    ) -> None:
        self._truth, self._simulated, self._tables, self._build = truth, simulated, tables, build
        self._seed = seed
        self._running: tuple[LinuxcncMachine, Source] | None = None

    def read(self, request: Request) -> Answer | Skip:
        """Return the reading; raises ControlError."""
        if self._running is None:
            machine = LinuxcncMachine(self._truth, self._tables, self._build)
            self._running = machine, self._simulated(machine.seen)
        machine, source = self._running
        if machine.spheres is None or request.setup.instrument != "sphere" or request.setup.three_touches:
            return source.read(request)
        import numpy as np

        rng = np.random.default_rng((self._seed, request.reading))
        value, *others = machine.spheres.read(request.setup, request.pose, request.approach, rng)
        return Answer(value, others=tuple(others))

    def close(self) -> None:
        """Stop LinuxCNC; may be called twice."""
        if self._running is not None:
            self._running[0].close()


def _letter(axis: Axis) -> str:
    if axis.name not in _ORDER:
        raise SourceError(f"LinuxCNC has no axis {axis.name}", f"Its axes are {', '.join(_ORDER)}")
    return axis.name
