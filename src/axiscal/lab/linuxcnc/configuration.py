"""The files of a simulated LinuxCNC machine with one joint for each axis: text only."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product


@dataclass(frozen=True, slots=True)
class Joint:
    """One axis in machine units, mm or deg and seconds, with the text of its COMP_FILE."""

    axis: str
    low: float = -500.0
    high: float = 500.0
    velocity: float = 5000.0
    acceleration: float = 5e5
    table: str | None = None

    @property
    def rotary(self) -> bool:
        """Whether the axis turns."""
        return self.axis[0] in "ABC"


@dataclass(frozen=True, slots=True)
class Cross:
    """HAL text that corrects axes over other axes; axes : those whose motors it moves."""

    axes: tuple[str, ...]
    text: str


def files(
    joints: Sequence[Joint], servo_period: float, cross: Cross | None = None, kinematics: str = "trivkins"
) -> Mapping[str, str]:
    """Return name and text of every file that LinuxCNC reads; kinematics : name of its module."""
    tables = {f"joint{number}.comp": joint.table for number, joint in enumerate(joints) if joint.table is not None}
    return {
        "machine.ini": _ini(joints, servo_period, kinematics),
        "machine.hal": _hal(joints, cross),
        "sim.tbl": "T1 P1 D6 Z0\n",
    } | tables


def _ini(joints: Sequence[Joint], servo_period: float, kinematics: str) -> str:
    letters = "".join(joint.axis for joint in joints)
    fastest, hardest = max(joint.velocity for joint in joints), max(joint.acceleration for joint in joints)
    traj: dict[str, object] = {"COORDINATES": letters, "LINEAR_UNITS": "mm", "ANGULAR_UNITS": "degree"}
    for limit, kind in product(("MAX", "DEFAULT"), ("LINEAR", "ANGULAR")):
        traj |= {f"{limit}_{kind}_VELOCITY": fastest, f"{limit}_{kind}_ACCELERATION": hardest}
    sections: dict[str, dict[str, object]] = {
        "EMC": {"VERSION": 1.1, "MACHINE": "axiscal"},
        "DISPLAY": {"DISPLAY": "./driver.py"},
        "TASK": {"TASK": "milltask", "CYCLE_TIME": 0.001},
        "RS274NGC": {"PARAMETER_FILE": "sim.var"},
        "EMCMOT": {"EMCMOT": "motmod", "COMM_TIMEOUT": 4.0, "SERVO_PERIOD": round(servo_period * 1e9)},
        "EMCIO": {"EMCIO": "io", "CYCLE_TIME": 0.1, "TOOL_TABLE": "sim.tbl"},
        "HAL": {"HALFILE": "machine.hal"},
        "KINS": {"KINEMATICS": f"{kinematics} coordinates={letters}", "JOINTS": len(joints)},
        "TRAJ": traj,
    }
    for number, joint in enumerate(joints):
        sections |= _axis(number, joint)
    lines = (
        f"[{name}]\n" + "".join(f"{key} = {value}\n" for key, value in body.items()) for name, body in sections.items()
    )
    return "\n".join(lines)


def _axis(number: int, joint: Joint) -> dict[str, dict[str, object]]:
    limits: dict[str, object] = {
        "MIN_LIMIT": joint.low,
        "MAX_LIMIT": joint.high,
        "MAX_VELOCITY": joint.velocity,
        "MAX_ACCELERATION": joint.acceleration,
    }
    drive = {"TYPE": "ANGULAR" if joint.rotary else "LINEAR", "FERROR": 100, "MIN_FERROR": 100}
    home = {"HOME": 0, "HOME_SEQUENCE": 0}
    table = {} if joint.table is None else {"COMP_FILE": f"joint{number}.comp", "COMP_FILE_TYPE": 0}
    return {f"AXIS_{joint.axis}": limits, f"JOINT_{number}": drive | limits | home | table}


def motors(joints: Sequence[Joint], cross: Cross | None = None) -> list[str]:
    """Return the pin or signal of each joint that holds what its motor is told."""
    moved = () if cross is None else cross.axes
    return [
        f"axiscal-{joint.axis.lower()}-motor" if joint.axis in moved else f"joint.{number}.motor-pos-cmd"
        for number, joint in enumerate(joints)
    ]


def _hal(joints: Sequence[Joint], cross: Cross | None) -> str:
    lines = [
        "loadrt [KINS]KINEMATICS",
        "loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS",
        "addf motion-command-handler servo-thread",
        "addf motion-controller servo-thread",
        "net estop-loop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in",
        "net tool-prep iocontrol.0.tool-prepare => iocontrol.0.tool-prepared",
        "net tool-chg iocontrol.0.tool-change => iocontrol.0.tool-changed",
    ]
    moved = () if cross is None else cross.axes
    lines += [
        f"net j{n}m joint.{n}.motor-pos-cmd => joint.{n}.motor-pos-fb"
        for n, joint in enumerate(joints)
        if joint.axis not in moved
    ]
    # where a motor really turns, its encoder shows what it was told
    wired = "" if cross is None else re.sub(r"axiscal-([a-z])-encoder", r"axiscal-\1-motor", cross.text)
    return "\n".join(lines) + "\n" + wired
