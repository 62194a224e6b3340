"""The LinuxCNC of `axiscal.ports.linuxcnc.lab`, which also makes moves, loads tables, and moves axes over others."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from axiscal.ports.linuxcnc import lab
from axiscal.ports.linuxcnc.lab import Settings, available, can_load, configuration
from axiscal.ports.linuxcnc.lab.session import DRIVER

__all__ = ["Ending", "Joint", "Session", "Settings", "available", "can_load", "files", "signals"]

MOVING = Path(__file__).with_name("moving_driver.py")


@dataclass(frozen=True, slots=True)
class Joint(lab.Joint):
    """A joint with the text of its COMP_FILE.  home_offset : coordinate of the place where it is homed"""

    low: float = -500.0
    high: float = 500.0
    velocity: float = 5000.0
    acceleration: float = 5e5
    table: str | None = None
    home_offset: float = 0.0


@dataclass(frozen=True, slots=True)
class Ending:
    """Positions at the end of a move, one number for each joint in mm or deg.

    motor : where the motors are sent; command : the positions that LinuxCNC shows; settled : the correction had arrived
    probe : position and whether the probe touched, of the last probing move
    """

    motor: tuple[float, ...]
    command: tuple[float, ...]
    settled: bool
    probe: tuple[tuple[float, ...], bool]


class Session(lab.Session):
    """A LinuxCNC that takes G-code lines.  start : where the motors were sent after homing"""

    driver = MOVING

    def __init__(self, joints: Sequence[Joint], settings: Settings | None = None, timeout: float = 60.0) -> None:
        super().__init__(joints, settings, timeout)
        self.start = tuple(self._ask("start")["start"])

    def move(self, codes: Sequence[str]) -> tuple[Ending, ...]:
        """Execute G-code lines or `setp PIN VALUE`, and return where each ended."""
        return tuple(_ending(each) for each in self._ask(list(codes))["steps"])

    def _texts(self, joints: Sequence[lab.Joint], settings: Settings) -> Mapping[str, str]:
        own = [joint for joint in joints if isinstance(joint, Joint)]
        return {
            "driver.py": self.driver.read_text(encoding="utf-8"),
            "moving_driver.py": MOVING.read_text(encoding="utf-8"),
            "plain_driver.py": DRIVER.read_text(encoding="utf-8"),
            "job.json": json.dumps({"motors": _motors(len(joints), settings.hal)}),
            **files(own, settings),
        }


def _ending(found: dict[str, Any]) -> Ending:
    position, tripped = found["probe"]
    return Ending(tuple(found["motor"]), tuple(found["command"]), found["settled"], (tuple(position), tripped))


def files(joints: Sequence[Joint], settings: Settings) -> Mapping[str, str]:
    """Return name and text of every file that LinuxCNC reads."""
    plain = configuration.files(joints, settings)
    ini, tables = plain["machine.ini"], dict[str, str]()
    for number, joint in enumerate(joints):
        head, section = f"[JOINT_{number}]\n", ""
        if joint.table is not None:
            tables[f"joint{number}.comp"] = joint.table
            section = f"COMP_FILE = joint{number}.comp\nCOMP_FILE_TYPE = 0\n"
        before, _, behind = ini.partition(head)
        behind = behind.replace("HOME_OFFSET = 0\n", f"HOME_OFFSET = {joint.home_offset}\n", 1)
        ini = before + head + section + behind if behind else ini
    return {**plain, **tables, "machine.ini": ini, "machine.hal": _hal(len(joints), settings.hal), **settings.beside}


def _motors(count: int, hal: str) -> list[str]:
    """Return the pin or signal of each joint that holds the position its motor is sent to."""
    moved = _moved(hal)
    return [moved.get(n, f"joint.{n}.motor-pos-cmd") for n in range(count)]


def signals(count: int, hal: str) -> list[str]:
    """Return the signal of each of the first joints that holds the position its motor is sent to."""
    moved = _moved(hal)
    return [moved.get(n, f"j{n}m") for n in range(count)]


def _moved(hal: str) -> dict[int, str]:
    """Return the signals that hold where motors are sent, of the joints whose motors the text moves."""
    tables = re.findall(r"net (\S+)-seen => joint\.(\d+)\.motor-pos-fb", hal)
    whole = re.findall(r"net (vc)-fb-(\d+) \S+ => joint\.\2\.motor-pos-fb", hal)
    return {int(n): f"{name}-motor" for name, n in tables} | {int(n): f"{name}-drv-{n}" for name, n in whole}


def _hal(count: int, hal: str) -> str:
    """Return HAL text; where a motor really turns, its encoder shows where it was sent."""
    moved = _moved(hal)
    straight = "".join(configuration.fed_back(n) for n in range(count) if n not in moved)
    wired = re.sub(r"(axiscal-[a-z0-9-]+)-encoder", r"\1-motor", re.sub(r"net vc-enc-(\d)", r"net vc-drv-\1", hal))
    return configuration.MOTION + straight + _loaded_once(wired)


_LOADED = re.compile(r"^loadrt (\S+) names=(\S+)\n", re.MULTILINE)


def _loaded_once(hal: str) -> str:
    """Return HAL text in which a module that several parts load is loaded once, with all their names."""
    names: dict[str, list[str]] = {}
    for module, given in _LOADED.findall(hal):
        names.setdefault(module, []).append(given)

    def first(found: re.Match[str]) -> str:
        given = names.pop(found[1], None)
        return "" if given is None else f"loadrt {found[1]} names={','.join(given)}\n"

    return _LOADED.sub(first, hal)
