"""A rotary table over all turns on Debian's LinuxCNC: the joint counts on, and every turn is corrected alike."""

from __future__ import annotations

import numpy as np
import pytest

from tests.linuxcnc.lab import Joint
from tests.linuxcnc.needed import LONG
from tests.linuxcnc.watched import run
from tests.tables.test_rotary_turns import deviation, exported, known

pytestmark = LONG

ANGLES = (-850.0, -487.0, -127.0, 33.0, 233.0, 475.0, 835.0)


def test_every_turn_within_the_limits_is_corrected() -> None:
    estimate = known()
    files = exported(estimate).files
    joints = [
        Joint("X", acceleration=1e5),
        Joint("Y", acceleration=1e5),
        Joint("C", -1000.0, 1000.0, acceleration=1e5, table=files["C.comp"]),
    ]
    codes = [f"G0 C{angle - side * step:.6f}" for angle in ANGLES for side in (1, -1) for step in (5, 0)]
    ended = run(joints, codes)
    assert ended.errors == ()
    left = []
    for (angle, side), step in zip(((a, s) for a in ANGLES for s in (1, -1)), ended.steps[1::2], strict=True):
        beyond = step.motor[2] - step.command[2]
        off = deviation(estimate, angle, side > 0)
        assert step.command[2] == pytest.approx(angle, abs=1e-6)
        left.append((off, off + beyond))
    before, after = np.abs(np.array(left)).max(axis=0)
    assert after < np.degrees(2e-6) < np.degrees(2e-5) < before
