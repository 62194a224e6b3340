"""Programs followed word by word, with matrices of the tests' own: over which poses the axes go."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from axiscal.numerics import Array
from tests.generators.kinematics import Chain, pose_with_tip, tip

ON = {
    "linuxcnc": "M428",
    "sinumerik": "TRAORI",
    "heidenhain": "FUNCTION TCPM",
    "fanuc": "G1 G43.4 ",
    "isg": "#TRAFO ON",
}
OFF = {
    "linuxcnc": "M429",
    "sinumerik": "TRAFOOF",
    "heidenhain": "FUNCTION RESET TCPM",
    "fanuc": "G1 G49 ",
    "isg": "#TRAFO OFF",
}
STEP = {"linuxcnc": 1e-6, "sinumerik": 1e-6, "heidenhain": 1e-4, "fanuc": 1e-3, "isg": 1e-6}
"""mm, the last decimal of a place of the tool point."""


@dataclass
class Reader:
    """Follows a program word by word; mm and deg outside, m and rad inside.

    samples : poses of each straight move, both ends among them
    """

    machine: Chain
    controller: str
    samples: int = 3
    held: bool = False
    at: dict[str, float] = field(default_factory=dict)
    tip: Array = field(default_factory=lambda: np.zeros(3))
    """Of the tool point on the workpiece, m, while it is held."""

    def follow(self, text: str) -> Iterator[tuple[str, list[Array]]]:
        """Yield "way" with the poses that it goes over, "held", "free", or "READING n" with the pose that it is at."""
        for line in text.splitlines():
            block = re.sub(r"^\d+ ", "", line) if self.controller == "heidenhain" else line
            if block.startswith(ON[self.controller]):
                yield "held", self._hold(block)
            elif block.startswith(OFF[self.controller]) and self.held:
                yield "free", self._release(block)
            elif found := re.search(r"READING (\d+)\)?$", block):
                yield f"READING {found[1]}", [self.pose]
            elif re.match(r"(G53 G1|G1 SUPA|G1|L) [A-Z]", block):
                machine = "M91" in block or "G53" in block or "SUPA" in block
                assert self.controller in ("fanuc", "isg") or machine != self.held, block
                yield "way", self._way(words(block))

    @property
    def pose(self) -> Array:
        """Where the axes are."""
        if self.held:
            turned = [self.at.get(axis.name, 0.0) if axis.rotary else 0.0 for axis in self.machine.axes]
            return pose_with_tip(self.machine, np.array(turned), self.tip)
        return np.array([self.at[axis.name] for axis in self.machine.axes])

    def _hold(self, block: str) -> list[Array]:
        pose = self.pose
        if self.controller in ("heidenhain", "fanuc", "isg"):  # what the table is when it begins counts
            assert all(at == 0 for axis, at in zip(self.machine.axes, pose, strict=True) if axis.rotary)
        self.held, self.tip = True, tip(self.machine, pose)
        if self.controller == "fanuc":  # the block names where it stands already
            stated = np.array([words(block)[name] for name in "XYZ"])
            assert np.abs(stated - self.tip).max() <= 0.6e-6
        return [pose]

    def _release(self, block: str) -> list[Array]:
        pose = self.pose
        self.held = False
        self.at = {axis.name: float(at) for axis, at in zip(self.machine.axes, pose, strict=True)}
        if self.controller == "fanuc":
            for name, at in words(block).items():
                assert abs(at - self.at[name]) <= 0.6e-6
        return [pose]

    def _way(self, to: dict[str, float]) -> list[Array]:
        begin, tip_begin = dict(self.at), self.tip
        known = len(begin) == len(self.machine.axes)
        shares = np.linspace(0, 1, self.samples) if known else np.ones(1)
        poses = []
        for share in shares:
            for name, end in to.items():
                if self.held and name in "XYZ":
                    place = "XYZ".index(name)
                    self.tip = self.tip.copy()
                    self.tip[place] = tip_begin[place] + share * (end - tip_begin[place])
                else:
                    self.at[name] = begin.get(name, end) + share * (end - begin.get(name, end))
            poses += [self.pose] if known else []
        return poses


def words(block: str) -> dict[str, float]:
    """Return the axes of a block, m or rad."""
    found = re.findall(r"(?<![A-Z])([XYZABC])=?([+-]?\d+\.\d+)", block)
    return {name: math.radians(float(v)) if name in "ABC" else float(v) / 1e3 for name, v in found}
