"""The files of a simulated LinuxCNC machine, of one or several joints for each axis: text only."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Self


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint of an axis in machine units, mm or inch, deg and seconds."""

    axis: str
    low: float
    high: float
    velocity: float
    acceleration: float

    @property
    def rotary(self) -> bool:
        """Whether the axis turns."""
        return self.axis[0] in "ABC"


@dataclass(frozen=True, slots=True)
class Settings:
    """What a LinuxCNC is given besides its joints.

    hal : text of the component, which stands between motion and the motors; "" where nothing does
    kinematics : name of the module; unit : mm or in
    beside : files that lie beside the configuration; sources : of a realtime component, X.comp and what it includes
    """

    hal: str = ""
    kinematics: str = "trivkins"
    unit: str = "mm"
    beside: Mapping[str, str] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def loading(cls, exported: Mapping[str, str]) -> Self:
        """Return what loads exported files but COMP_FILEs: HAL text in their order, the component and its data."""
        hal = "".join(text for name, text in exported.items() if name.endswith(".hal"))
        sources = {name: text for name, text in exported.items() if name.startswith("axiscal_vcomp")}
        return cls(hal, beside={n: text for n, text in exported.items() if n.endswith(".vcomp")}, sources=sources)


def files(joints: Sequence[Joint], settings: Settings) -> Mapping[str, str]:
    """Return name and text of every file that LinuxCNC reads.

    Where the component stands before the motors, their encoders show where it has sent them.
    """
    hal = re.sub(r"net vc-enc-(\d)", r"net vc-drv-\1", settings.hal) or "".join(map(fed_back, range(len(joints))))
    return {
        "machine.ini": _ini(joints, settings),
        "machine.hal": MOTION + hal,
        "sim.tbl": "T1 P1 D6 Z0\n",
        **settings.beside,
    }


def _ini(joints: Sequence[Joint], settings: Settings) -> str:
    letters = "".join(joint.axis for joint in joints)
    gantry = " kinstype=BOTH" if len(set(letters)) < len(letters) else ""
    fastest, hardest = max(joint.velocity for joint in joints), max(joint.acceleration for joint in joints)
    traj: dict[str, object] = {"COORDINATES": letters, "LINEAR_UNITS": _UNITS[settings.unit], "ANGULAR_UNITS": "degree"}
    for limit, kind in product(("MAX", "DEFAULT"), ("LINEAR", "ANGULAR")):
        traj |= {f"{limit}_{kind}_VELOCITY": fastest, f"{limit}_{kind}_ACCELERATION": hardest}
    sections: dict[str, dict[str, object]] = {
        "EMC": {"VERSION": 1.1, "MACHINE": "axiscal"},
        "DISPLAY": {"DISPLAY": "./driver.py"},
        "TASK": {"TASK": "milltask", "CYCLE_TIME": 0.001},
        "RS274NGC": {"PARAMETER_FILE": "sim.var"},
        "EMCMOT": {"EMCMOT": "motmod", "COMM_TIMEOUT": 4.0, "SERVO_PERIOD": _SERVO_PERIOD},
        "EMCIO": {"EMCIO": "io", "CYCLE_TIME": 0.1, "TOOL_TABLE": "sim.tbl"},
        "HAL": {"HALFILE": "machine.hal"},
        "KINS": {"KINEMATICS": f"{settings.kinematics} coordinates={letters}{gantry}", "JOINTS": len(joints)},
        "TRAJ": traj,
    }
    for number, joint in enumerate(joints):
        sections |= _axis(number, joint)
    lines = (
        f"[{name}]\n" + "".join(f"{key} = {value}\n" for key, value in body.items()) for name, body in sections.items()
    )
    return "\n".join(lines)


_UNITS = {"mm": "mm", "in": "inch"}
_SERVO_PERIOD = 1_000_000
"""ns."""


def _axis(number: int, joint: Joint) -> dict[str, dict[str, object]]:
    limits: dict[str, object] = {
        "MIN_LIMIT": joint.low,
        "MAX_LIMIT": joint.high,
        "MAX_VELOCITY": joint.velocity,
        "MAX_ACCELERATION": joint.acceleration,
    }
    drive = {"TYPE": "ANGULAR" if joint.rotary else "LINEAR", "FERROR": 100, "MIN_FERROR": 100}
    home = {"HOME": 0, "HOME_OFFSET": 0, "HOME_SEQUENCE": 0}
    return {f"AXIS_{joint.axis}": limits, f"JOINT_{number}": drive | limits | home}


MOTION = """\
loadrt [KINS]KINEMATICS
loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net estop-loop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net tool-prep iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net tool-chg iocontrol.0.tool-change => iocontrol.0.tool-changed
"""
"""What every configuration loads and joins."""


def fed_back(joint: int) -> str:
    """Return the line by which a motor stands where it is sent."""
    return f"net j{joint}m joint.{joint}.motor-pos-cmd => joint.{joint}.motor-pos-fb\n"
