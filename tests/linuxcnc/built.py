"""LinuxCNC machines that are built in other ways: in inches, on two joints, in TCP mode, with a probe."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from axiscal.campaign.sources import Answer, Request, Skip
from axiscal.campaign.sources.source import SimulatedSource
from axiscal.machine import Axis
from axiscal.machine.kinematics import frames
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.tables import pivots
from axiscal.units import to_unit
from tests.linuxcnc.lab import Joint, Settings
from tests.linuxcnc.probing import Probe, ball
from tests.linuxcnc.spheres import TouchedSpheres
from tests.linuxcnc.virtual import LinuxcncMachine

_SWING = 390.0
"""mm or deg that joints of a machine in TCP mode travel further than others."""


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


class BuiltMachine(LinuxcncMachine):
    """A virtual machine behind a running LinuxCNC that is built in this way; a context manager.

    spheres : what touches them, where it has a probe
    """

    def __init__(self, truth: VirtualMachine, tables: Mapping[str, str] | None, build: Build) -> None:
        self._build = build
        super().__init__(truth, tables)
        self.spheres: TouchedSpheres | None = None
        if build.probe is not None:
            self.spheres = TouchedSpheres(self._session, truth, self._driven, self._overrun, build.probe)

    def _make_ready(self, hal: str) -> None:
        if self._build.tcp:
            tool = f"G43.1 Z{self._machine.tool * self._scale(self._machine.axis('Z')):.7f}"
            self._session.move([tool, *(["M68 E3 Q1", "M66 E0 L0"] if self._build.probe else [])])
        super()._make_ready(hal)

    @property
    def _driven(self) -> list[int]:
        return [k for k in self._axes for _ in range(1 + (self._machine.axes[k].name in self._build.pairs))]

    def _code(self, pose: Array) -> str:
        if not self._build.tcp:
            return super()._code(pose)
        shown = {self._machine.axes[k].name: float(pose[k]) for k in self._axes}
        shown |= dict(zip("XYZ", map(float, frames(self._machine, pose[None]).tcp[0]), strict=True))
        words = [f"{letter}{at * self._scale(self._machine.axis(letter)):.7f}" for letter, at in shown.items()]
        return " ".join(["G0", *words])

    def _scale(self, axis: Axis) -> float:
        return to_unit(1.0, axis.unit if axis.rotary else self._build.unit)

    def _joints(self, files: Mapping[str, str]) -> list[Joint]:
        found = []
        for joint in super()._joints(files):
            axis, further = self._machine.axis(joint.axis), _SWING * self._build.tcp
            size = self._scale(axis) / to_unit(1.0, axis.unit)
            own = replace(
                joint,
                low=(joint.low - further) * size,
                high=(joint.high + further) * size,
                velocity=joint.velocity * size,
                acceleration=joint.acceleration * size,
            )
            found += [own] * (1 + (joint.axis in self._build.pairs))
        return found

    def _settings(self, files: Mapping[str, str]) -> Settings:
        """Return what LinuxCNC is given besides its joints, with the place of the rotary axes in TCP mode."""
        plain = replace(super()._settings(files), unit=self._build.unit)
        if not self._build.tcp:
            return plain
        nominal, texts = pivots.pivots(self._machine, {}), [plain.hal]
        if nominal.kinematics not in plain.hal:
            texts.append(pivots.write(nominal, self._build.unit))
        texts.append(f"net tool-length motion.tooloffset.z => {nominal.kinematics}.tool-offset\n")
        if self._build.probe is None:
            return replace(plain, hal="".join(texts), kinematics=nominal.kinematics)
        texts += [
            "net kinstype-select motion.analog-out-03 => motion.switchkins-type\n",
            ball(self._build.probe.radius, "".join(texts)),
        ]
        return replace(plain, hal="".join(texts), kinematics=f"{nominal.kinematics} sparm=identityfirst")


class BuiltSource:
    """The machine as a source of readings.  seed : of the noise, and of how a probe's touches scatter"""

    def __init__(self, machine: BuiltMachine, seed: int) -> None:
        self._machine, self._seed, self._simulated = machine, seed, SimulatedSource(machine.seen, seed)

    def read(self, request: Request) -> Answer | Skip:
        """Return the reading; raises ControlError."""
        spheres = self._machine.spheres
        if spheres is None or request.setup.instrument != "sphere" or request.setup.three_touches:
            return self._simulated.read(request)
        rng = np.random.default_rng((self._seed, request.reading))
        value, *others = spheres.read(request.setup, request.pose, request.approach, rng)
        return Answer(value, others=tuple(others))

    def close(self) -> None:
        """LinuxCNC is stopped by whoever started it."""
