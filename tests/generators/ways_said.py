"""The ways of a printed program, held to what its campaign says: nothing is run into.

From the text of the program, of the campaign and of the machine alone.
"""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from axiscal.numerics import Array
from tests.generators.kinematics import in_travel, stem, tip
from tests.generators.printed_machine import number
from tests.generators.program_ways import STEP, Reader
from tests.generators.said_places import Said, spot
from tests.generators.solids import filled, solids

_LEVER = 1.0
"""m, from the rotary axes to the tool point, at most."""
_BESIDE = 0.02
"""m, from the middle of a ball that nothing is to come nearer to while the tool is drawn back."""


class WaysSaid:
    """The ways of the program of one set-up.  samples : poses of each straight move that are looked at"""

    def __init__(self, said: Said, setup: str, controller: str, samples: int = 9) -> None:
        self._said, self._machine, self._table = said, said.machine, said.setups[setup]
        self._controller, self._samples = controller, samples
        self._artefact = said.artefacts.get(self._table.get("artefact", ""), {})

    @property
    def _retracted(self) -> bool:
        """Whether it goes off a ball and back from place to place."""
        at_ball = bool(self._artefact.get("balls") or self._artefact.get("grid"))
        return self._table["instrument"] in ("sphere", "probe") and at_ball

    def holds(self, text: str, planned: Mapping[int, Array]) -> int:
        """Assert that a program reads where it was planned, numbers of readings -> poses, and that its ways can be.

        Returns the number of ways from one reading to the next.
        """
        reader = Reader(self._machine, self._controller, self._samples)
        legs: list[list[tuple[str, list[Array]]]] = [[]]
        slack = STEP[self._controller] * 1e-3 + _LEVER * self._rounded  # slides follow an angle as it is written
        for what, poses in reader.follow(text):
            for pose in poses:
                assert in_travel(self._machine, pose, slack), (what, pose)
                self.keeps_out(pose)
            if what.startswith("READING"):
                self._reads(int(re.findall(r"\d+", what)[0]), poses[0], planned)
                legs.append([])
            legs[-1].append((what, poses))
        assert len(legs) == len(planned) + 1
        for leg in legs[1:-1]:
            self._way(leg)
        return len(legs) - 2

    def _reads(self, reading: int, pose: Array, planned: Mapping[int, Array]) -> None:
        """At a reading the tool point is where the plan has it; one that touches stands off, along itself."""
        wanted = planned[reading]
        turned = [abs((a - b + np.pi) % (2 * np.pi) - np.pi) for a, b in zip(pose, wanted, strict=True)]
        for axis, angle in zip(self._machine.axes, turned, strict=True):
            assert not axis.rotary or angle <= self._rounded, (reading, axis.name)
        far = number(self._table.get("retract", "50 mm")) if self._retracted else 0.0
        target = tip(self._machine, wanted) + far * stem(self._machine, wanted)
        slack = 1e-6 + 1e-3 * STEP[self._controller] + 2 * _LEVER * self._rounded
        assert np.linalg.norm(tip(self._machine, pose) - target) <= slack, (reading, pose, wanted)

    @property
    def _rounded(self) -> float:
        """By how much an angle may be off as it is written, rad."""
        return float(np.radians(0.51e-3 if self._controller == "fanuc" else 0.51e-4))

    def _way(self, leg: list[tuple[str, list[Array]]]) -> None:
        """From one reading to the next the tool stays drawn back."""
        if self._retracted:
            for pose in (pose for _, each in leg for pose in each):
                self._stays_off(pose)

    def _stays_off(self, pose: Array) -> None:
        """The tool, a line from its tip to the spindle, passes no ball of the artefact nearer than it may."""
        at, along = tip(self._machine, pose), stem(self._machine, pose)
        for name, ball in self._said.balls({"artefact": self._table["artefact"]}).items():
            up = float(np.clip((ball - at) @ along, 0.0, self._machine.tool_length))
            assert np.linalg.norm(at + up * along - ball) >= _BESIDE, (name, pose)

    def keeps_out(self, pose: Array) -> None:
        """Assert that tool, holder and nose are in no box."""
        boxes = [_sides(box) for box in self._artefact.get("keep_out", [])]
        for solid in solids(self._machine).values() if boxes else ():
            points = filled(self._machine, pose, solid)
            for box in boxes:
                assert not np.any(np.all((points > box[:, 0] + 1e-6) & (points < box[:, 1] - 1e-6), axis=1)), pose


def _sides(box: Mapping[str, Any]) -> Array:
    """Return from where to where a box goes along x, y, z, (3, 2) m; without end where it says nothing."""
    return np.array([spot(box[axis]) if axis in box else [-np.inf, np.inf] for axis in "xyz"])
