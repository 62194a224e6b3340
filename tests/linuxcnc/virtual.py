"""A virtual machine that is moved by a real LinuxCNC: in mm or inches, on one joint for an axis or two, in TCP mode.

LinuxCNC makes every move; where it sends the motors, the hidden errors of the virtual machine are added. Tables that
are loaded into it act as they would on the shop floor.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.surface import CommandedMachine
from axiscal.units import to_unit
from axiscal_core.axes import Axis
from tests.linuxcnc.lab import Joint, Session, Settings

_ORDER = "XYZABCUVW"
_OVERRUN = 2.0
"""mm or deg before a target from which it is approached: more than the backlash of any simulated joint."""
_GAIN = "axiscal-gain"
_WHOLE = "axiscal-vcomp"
_COMING = 20.0
"""s that a correction may take to come, which is a second or two."""
_ROOM = 10.0
"""mm or deg beyond the travel that the simulated joints are given, for overrun and compensation."""
_SWING = 390.0
"""mm or deg that joints of a machine in TCP mode travel further than others."""
_SPEED, _ACCELERATION = 5000.0, 5e5
"""mm or deg in seconds, of every joint."""


@dataclass(frozen=True, slots=True)
class Build:
    """How a LinuxCNC machine is built.

    unit : of its configuration, mm or in; pairs : axes that two joints drive
    tcp : it turns with xyzac- or xyzbc-trt-kins, and positions are those of the tool on the workpiece
    """

    unit: str = "mm"
    pairs: str = ""
    tcp: bool = False


_TABLE = Build(tcp=True), ExportOptions()
EXAMPLES: dict[str, tuple[str, Build, ExportOptions]] = {
    "three-axis": ("three-axis", Build(), ExportOptions()),
    "gantry": ("gantry", Build(pairs="Y"), ExportOptions(numbers={"Y": (1, 2)})),
    "inch": ("three-axis", Build(unit="in"), ExportOptions(unit="in")),
    "xyzac": ("xyzac", *_TABLE),
    "xyzbc": ("xyzbc", *_TABLE),
    "xyzac-all": ("xyzac-all", *_TABLE),
}
"""Name -> whose description it is, how LinuxCNC is set up, what is exported."""


def description(name: str) -> CampaignDescription:
    """Return the campaign on one of `EXAMPLES`."""
    stem = EXAMPLES[name][0]
    folder = Path(__file__).with_name("machines")
    campaign, machine = (folder / f"{stem}.{kind}.toml" for kind in ("campaign", "machine"))
    described, built = (path.read_text(encoding="utf-8") for path in (campaign, machine))
    return campaign_from_texts(described, campaign.name, built, machine.name)


class LinuxcncMachine:
    """A virtual machine behind a running LinuxCNC; a context manager.

    tables : files of `axiscal export --to linuxcnc` or `--to linuxcnc-volumetric` that it loads, by name
    seen : the machine as its instruments see it
    Raises ControlError.
    """

    def __init__(
        self, truth: VirtualMachine, tables: Mapping[str, str] | None = None, build: Build | None = None
    ) -> None:
        self._machine, self._build = truth.model, build or Build()
        axes = self._machine.axes
        in_order = sorted(range(len(axes)), key=lambda k: _ORDER.index(axes[k].name))
        self._driven = [k for k in in_order for _ in range(1 + (axes[k].name in self._build.pairs))]
        settings = self._settings(tables or {})
        self._session = Session([self._joint(axes[k], tables or {}) for k in self._driven], settings)
        self._make_ready(settings.hal)
        self._last: tuple[Array, Array, Array] | None = None
        self.seen: VirtualMachine = CommandedMachine.behind(truth, lambda poses, ways: self.sent(poses, ways) - poses)

    def sent(self, poses: Array, approaches: Array) -> Array:
        """Move to poses (m, q) and return where the motors were sent, (m, q), m or rad; both motors of a pair alike.

        LinuxCNC is not moved where it stands already.
        """
        last = self._last
        if last is not None and np.array_equal(poses, last[0]) and np.array_equal(approaches, last[1]):
            return last[2]
        codes = [code for pose, signs in zip(poses, approaches, strict=True) for code in self._codes(pose, signs)]
        result = np.full(poses.shape, np.nan)
        for row, step in zip(result, self._session.move(codes)[1::2], strict=True):
            for k, motor in zip(self._driven, step.motor, strict=True):
                at = motor / self._scale(self._machine.axes[k])
                assert np.isnan(row[k]) or row[k] == at, "the joints of an axis do not go together"
                row[k] = at
        self._last = poses.copy(), approaches.copy(), result
        return result

    @property
    def errors(self) -> tuple[str, ...]:
        """The messages of LinuxCNC to the operator."""
        return self._session.errors

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._session.close()

    def _make_ready(self, hal: str) -> None:
        """Wait until corrections that come slowly, after homing or when they are switched on, are all there."""
        if self._build.tcp:
            self._session.move([f"G43.1 Z{self._machine.tool_length * self._scale(self._machine.axis('Z')):.7f}"])
        gains = [gain for mark, gain in ((_GAIN, _GAIN), (_WHOLE, f"{_WHOLE}.gain")) if mark in hal]
        if _WHOLE in hal:
            self._session.move([f"setp {_WHOLE}.enable 1"])
        end = time.monotonic() + _COMING
        while gains and min(self._session.read(gains)) < 1.0:
            assert time.monotonic() < end, f"the correction did not come: look at the pin {_WHOLE}.fault-code"
            time.sleep(0.05)

    def _codes(self, pose: Array, signs: Array) -> list[str]:
        """Return a move beside the pose and one to it; axes without a direction come upwards."""
        overrun = np.array([_OVERRUN / to_unit(1.0, axis.unit) for axis in self._machine.axes])
        before = pose - np.where(signs == 0, 1.0, np.sign(signs)) * overrun
        return [self._code(at) for at in (before, pose)]

    def _code(self, pose: Array) -> str:
        """Return the move that brings the joints, or in TCP mode the tool, to a pose."""
        shown = {self._machine.axes[k].name: float(pose[k]) for k in self._driven}
        if self._build.tcp:
            shown |= dict(zip("XYZ", map(float, self._machine.frames(pose[None]).tcp[0]), strict=True))
        words = [f"{letter}{at * self._scale(self._machine.axis(letter)):.7f}" for letter, at in shown.items()]
        return " ".join(["G0" if self._build.tcp else "G53 G0", *words])

    def _scale(self, axis: Axis) -> float:
        return to_unit(1.0, axis.unit if axis.rotary else self._build.unit)

    def _joint(self, axis: Axis, files: Mapping[str, str]) -> Joint:
        room = (_ROOM + _SWING * self._build.tcp) / to_unit(1.0, axis.unit)
        scale, size = self._scale(axis), self._scale(axis) / to_unit(1.0, axis.unit)
        low, high = min(axis.travel[0], 0.0) - room, max(axis.travel[1], 0.0) + room
        table = files.get(f"{axis.name}.comp")
        return Joint(axis.name, low * scale, high * scale, _SPEED * size, _ACCELERATION * size, table)

    def _settings(self, files: Mapping[str, str]) -> Settings:
        """Return what LinuxCNC is given besides its joints, with the place of the rotary axes in TCP mode."""
        plain = replace(Settings.loading(files), unit=self._build.unit)
        if not self._build.tcp:
            return plain
        (swivel,) = (axis for axis in self._machine.axes if axis.name in ("A", "B"))
        line, table = np.array(swivel.origin), np.array(self._machine.axis("C").origin)
        kinematics, across = f"xyz{swivel.name.lower()}c-trt-kins", "yx"["AB".index(swivel.name)]
        pins = {f"{way}-rot-point": at for way, at in zip("xyz", (*table[:2], line[2]), strict=True)}
        pins[f"{across}-offset"] = (line - table)["xy".index(across)]
        hal = "".join(f"setp {kinematics}.{pin} {to_unit(at, self._build.unit):.7f}\n" for pin, at in pins.items())
        hal += f"{plain.hal}net tool-length motion.tooloffset.z => {kinematics}.tool-offset\n"
        return replace(plain, hal=hal, kinematics=kinematics)
