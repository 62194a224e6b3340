"""The files of a simulated LinuxCNC machine, of one or several joints for each axis: text only."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Self


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint of an axis in machine units, mm or inch, deg and seconds, with the text of its COMP_FILE.

    home_offset : coordinate of the place where it is homed
    """

    axis: str
    low: float = -500.0
    high: float = 500.0
    velocity: float = 5000.0
    acceleration: float = 5e5
    table: str | None = None
    home_offset: float = 0.0

    @property
    def rotary(self) -> bool:
        """Whether the axis turns."""
        return self.axis[0] in "ABC"


@dataclass(frozen=True, slots=True)
class Settings:
    """What a LinuxCNC is given besides its joints.

    hal : text that is run after motion has been loaded, such as corrections over other axes
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
    """Return name and text of every file that LinuxCNC reads."""
    tables = {f"joint{number}.comp": joint.table for number, joint in enumerate(joints) if joint.table is not None}
    return {
        "machine.ini": _ini(joints, settings),
        "machine.hal": _hal(joints, settings.hal),
        "sim.tbl": "T1 P1 D6 Z0\n",
        **settings.beside,
    } | tables


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
    home = {"HOME": 0, "HOME_OFFSET": joint.home_offset, "HOME_SEQUENCE": 0}
    table = {} if joint.table is None else {"COMP_FILE": f"joint{number}.comp", "COMP_FILE_TYPE": 0}
    return {f"AXIS_{joint.axis}": limits, f"JOINT_{number}": drive | limits | home | table}


def motors(joints: Sequence[Joint], hal: str) -> list[str]:
    """Return the pin or signal of each joint that holds the position its motor is sent to."""
    moved = _moved(hal)
    return [moved.get(n, f"joint.{n}.motor-pos-cmd") for n in range(len(joints))]


def signals(count: int, hal: str) -> list[str]:
    """Return the signal of each of the first joints that holds the position its motor is sent to."""
    moved = _moved(hal)
    return [moved.get(n, f"j{n}m") for n in range(count)]


def _moved(hal: str) -> dict[int, str]:
    """Return the signals that hold where motors are sent, of the joints whose motors the text moves."""
    tables = re.findall(r"net (\S+)-seen => joint\.(\d+)\.motor-pos-fb", hal)
    whole = re.findall(r"net (vc)-fb-(\d+) \S+ => joint\.\2\.motor-pos-fb", hal)
    return {int(n): f"{name}-motor" for name, n in tables} | {int(n): f"{name}-drv-{n}" for name, n in whole}


def _hal(joints: Sequence[Joint], hal: str) -> str:
    lines = [
        "loadrt [KINS]KINEMATICS",
        "loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS",
        "addf motion-command-handler servo-thread",
        "addf motion-controller servo-thread",
        "net estop-loop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in",
        "net tool-prep iocontrol.0.tool-prepare => iocontrol.0.tool-prepared",
        "net tool-chg iocontrol.0.tool-change => iocontrol.0.tool-changed",
    ]
    moved = _moved(hal)
    fed_back = (n for n in range(len(joints)) if n not in moved)
    lines += [f"net j{n}m joint.{n}.motor-pos-cmd => joint.{n}.motor-pos-fb" for n in fed_back]
    # where a motor really turns, its encoder shows where it was sent
    wired = re.sub(r"(axiscal-[a-z0-9-]+)-encoder", r"\1-motor", re.sub(r"net vc-enc-(\d)", r"net vc-drv-\1", hal))
    return "\n".join(lines) + "\n" + _loaded_once(wired)


def _loaded_once(hal: str) -> str:
    """Return HAL text in which a module that several parts load is loaded once, with all their names."""
    names: dict[str, list[str]] = {}
    for module, given in _LOADED.findall(hal):
        names.setdefault(module, []).append(given)

    def first(found: re.Match[str]) -> str:
        given = names.pop(found[1], None)
        return "" if given is None else f"loadrt {found[1]} names={','.join(given)}\n"

    return _LOADED.sub(first, hal)


_LOADED = re.compile(r"^loadrt (\S+) names=(\S+)\n", re.MULTILINE)
