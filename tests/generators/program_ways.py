"""Programs followed word by word, with matrices of the tests' own: over which poses the axes go."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from axiscal.numerics import Array
from tests.generators.kinematics import Chain

STEP = {"linuxcnc": 1e-4, "sinumerik": 1e-4, "heidenhain": 1e-4, "fanuc": 1e-3, "isg": 1e-4}
"""mm, the last decimal of a coordinate."""


@dataclass
class Reader:
    """Follows a program word by word; mm and deg outside, m and rad inside.

    samples : poses of each straight move, both ends among them
    """

    machine: Chain
    controller: str
    samples: int = 3
    at: dict[str, float] = field(default_factory=dict)

    def follow(self, text: str) -> Iterator[tuple[str, list[Array]]]:
        """Yield "way" with the poses that it goes over, or "READING n" with the pose that it is at."""
        for line in text.splitlines():
            block = re.sub(r"^\d+ ", "", line) if self.controller == "heidenhain" else line
            if found := re.search(r"READING (\d+)\)?$", block):
                yield f"READING {found[1]}", [self.pose]
            elif re.match(r"(G53 G1|G1 SUPA|G1|L) [A-Z]", block):
                assert self.controller in ("fanuc", "isg") or re.search("M91|G53|SUPA", block), block
                yield "way", self._way(words(block))

    @property
    def pose(self) -> Array:
        """Where the axes are."""
        return np.array([self.at[axis.name] for axis in self.machine.axes])

    def _way(self, to: dict[str, float]) -> list[Array]:
        begin = dict(self.at)
        known = len(begin) == len(self.machine.axes)
        shares = np.linspace(0, 1, self.samples) if known else np.ones(1)
        poses = []
        for share in shares:
            for name, end in to.items():
                self.at[name] = begin.get(name, end) + share * (end - begin.get(name, end))
            poses += [self.pose] if known else []
        return poses


def words(block: str) -> dict[str, float]:
    """Return the axes of a block, m or rad."""
    found = re.findall(r"(?<![A-Z])([XYZABC])=?([+-]?\d+\.\d+)", block)
    return {name: math.radians(float(v)) if name in "ABC" else float(v) / 1e3 for name, v in found}
