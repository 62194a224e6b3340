"""How a running LinuxCNC stands: only looked at, nothing here gives it a command.

It runs beside LinuxCNC with `agent`, under the system's Python. Coordinates are those of the machine.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from typing import Any

LETTERS = "XYZABCUVW"
_SWITCHED = {"xyzac-trt-kins", "xyzbc-trt-kins", "5axiskins"}
"""Kinematics whose type 1 is identity, or 0 with sparm=identityfirst."""
_WHOLE = "axiscal-vcomp"
_DUST = 1e-6
"""mm or deg: the last decimal of what is sent."""


class Stance:
    """stat : of LinuxCNC, as it was polled last; ini : opens an INI file by name."""

    def __init__(self, stat: Any, ini: Callable[[str], Any]) -> None:
        self.stat, self._ini = stat, ini

    def document(self) -> dict[str, Any]:
        """Return how it stands, mm and deg."""
        stat, letters, joints = self.stat, self.letters(), range(self.stat.joints)
        return {
            "homed": self.homed(),
            "estop": bool(stat.estop),
            "enabled": bool(stat.enabled),
            "spindle": self.spins(),
            "feed": float(stat.feedrate),
            "feed_heeded": bool(stat.feed_override_enabled),
            "probe": bool(stat.probe_val),
            "offsets": [float(each) / self.unit("X") for each in stat.tool_offset],
            "rotation": float(stat.rotation_xy),
            "axes": {a: self.limits(a) for a in letters},
            "position": {a: self.here(a) for a in letters},
            "joints": self.joint_places(),
            "compensated": [
                n for n in joints if self._said(f"JOINT_{n}", "COMP_FILE") or stat.joint[n]["backlash"] != 0.0
            ],
            "whole": _bit(f"{_WHOLE}.active"),
            "checksum": _pin(f"{_WHOLE}.checksum"),
            "tip": self._tip(),
        }

    def homed(self) -> bool:
        """Return whether every joint is."""
        return all(self.stat.homed[joint] for joint in range(self.stat.joints))

    def spins(self) -> bool:
        """Return whether a spindle turns, or is on."""
        return any(each["enabled"] or each["speed"] for each in getattr(self.stat, "spindle", ())[: self.stat.spindles])

    def unit(self, letter: str) -> float:
        """Return one mm or deg in the machine's units."""
        return float(self.stat.angular_units if letter in "ABC" else self.stat.linear_units) or 1.0

    def here(self, letter: str) -> float:
        """Return where an axis stands, mm or deg."""
        return float(self.stat.position[LETTERS.index(letter)]) / self.unit(letter)

    def at_limits(self) -> dict[str, float]:
        """Return the axes that stand at one of their limits, with it, mm or deg.

        After a touch LinuxCNC goes on from where they are seen to stand, and takes no line that ends 1e-17 beyond.
        """
        ends = [(a, limit) for a in self.letters() for limit in self.limits(a)]
        return {a: limit for a, limit in ends if abs(self.here(a) - limit) < _DUST}

    def limits(self, letter: str) -> list[float]:
        """Return between which an axis may stand, mm or deg."""
        stated = self.stat.axis[LETTERS.index(letter)]
        return [float(stated[f"{end}_position_limit"]) / self.unit(letter) for end in ("min", "max")]

    def off(self, letter: str, end: float) -> float:
        """Return how far an axis is from where it is to stand, mm or deg; full turns are none."""
        way = abs(self.here(letter) - end)
        return min(way % 360, -way % 360) if letter in "ABC" else way

    def shift(self, letter: str) -> float:
        """Return how far the zero of coordinates in force is from the machine's, mm."""
        stat, k = self.stat, LETTERS.index(letter)
        return float(stat.g5x_offset[k] + stat.g92_offset[k] + stat.tool_offset[k]) / self.unit(letter)

    def letters(self) -> list[str]:
        """Return the axes."""
        return list(dict.fromkeys(self._joints()))

    def _joints(self) -> str:
        """Return the axis of each joint."""
        found = re.search(r"coordinates=(\w+)", self._said("KINS", "KINEMATICS"))
        return (found[1] if found else self._said("TRAJ", "COORDINATES") or "XYZ").replace(" ", "").upper()

    def joint_places(self) -> list[tuple[str, float]]:
        """Return the axis of each joint and where the joint stands, mm or deg: two belts as X and Y."""
        at = [float(each) for each in self.stat.joint_position[: self.stat.joints]]
        if self._said("KINS", "KINEMATICS").startswith("corexykins"):
            at[:2] = (at[0] + at[1]) / 2, (at[0] - at[1]) / 2
        return [(axis, place / self.unit(axis)) for axis, place in zip(self._joints(), at, strict=False)]

    def _tip(self) -> bool | None:
        """Whether switchable kinematics hold the tool point; None if LinuxCNC does not show it."""
        words = self._said("KINS", "KINEMATICS").split()
        if not words or words[0] not in _SWITCHED:
            return None
        return _bit(f"kinstype.is-{1 if 'sparm=identityfirst' in words else 0}")

    def _said(self, section: str, key: str) -> str:
        """Return what the INI file says, "" where it is silent."""
        return str(self._ini(self.stat.ini_filename).find(section, key) or "")


def _bit(name: str) -> bool | None:
    """Return a bit of HAL, None where there is no such pin."""
    found = _pin(name)
    return None if found is None else found == "TRUE"


def _pin(name: str) -> str | None:
    """Return what halcmd says of a pin, None where there is none."""
    try:
        found = subprocess.run(["halcmd", "getp", name], capture_output=True, text=True, timeout=5, check=False)
    except OSError:
        return None
    return found.stdout.strip() if found.returncode == 0 else None
