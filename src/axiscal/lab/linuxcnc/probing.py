"""A touch probe in the simulated machine: a ball that LinuxCNC touches with real `G38` moves.

HAL compares the distance of the motors from the ball's centre with its radius and drives `motion.probe-input`. Each
point is touched fast, then slowly from 0.2 mm away; at 60 mm/min LinuxCNC notices within 1 um.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.exceptions import ControlError
from axiscal.lab.linuxcnc.session import Ending, Session
from axiscal.numerics import Array

_CLEAR, _PAST, _BACK = 4.0, 2.0, 0.2
"""mm: clear of the ball, past its surface, and back off it; any way that meets the ball will do."""
_FAST, _SLOW = 1500, 60
"""mm/min, as one probes; the simulated probe triggers within a servo period at either."""
_SIDES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1))
"""Geometry: the sides from which a ball on a post can be touched."""


def ball(radius: float) -> str:
    """Return HAL text with a ball of a radius, mm; `touched` says where it is.  Joints 0 to 2 are X, Y, Z."""
    lines = ["loadrt sum2 names=ball-x,ball-y,ball-z", "loadrt hypot names=ball-far", "loadrt comp names=ball-touch"]
    for joint, axis in enumerate("xyz"):
        lines += [f"addf ball-{axis} servo-thread", f"net j{joint}m => ball-{axis}.in0"]
        lines += [f"net ball-d{axis} ball-{axis}.out => ball-far.in{joint}"]
    lines += ["addf ball-far servo-thread", "addf ball-touch servo-thread"]
    lines += ["net ball-distance ball-far.out => ball-touch.in0", f"setp ball-touch.in1 {radius:.6f}"]
    lines += ["net ball-touched ball-touch.out => motion.probe-input"]
    return "\n".join(lines) + "\n"


def touched(session: Session, place: Sequence[float], expected: Sequence[float], radius: float) -> Array:
    """Return where the centre of a ball is found, (3,) mm, in the positions that LinuxCNC shows.

    place : where the motors meet the ball; expected : where the program looks for it, both mm
    Raises ControlError when the probe finds nothing.
    """
    codes = [f"setp ball-{axis}.offset {-at:.9f}" for axis, at in zip("xyz", place, strict=True)]
    slow = []
    for side in _SIDES:
        part, index = _touch(np.array(expected), np.array(side, dtype=float), radius)
        slow.append(len(codes) + index)
        codes += part
    steps = session.move(codes)
    return _centre(np.array([_hit(steps[i]) for i in slow]), np.array(expected), radius)


def _touch(centre: Array, side: Array, radius: float) -> tuple[list[str], int]:
    """Return the moves that touch one side, and which of them is the slow one."""
    away, over = centre + side * (radius + _CLEAR), centre[2] + radius + 2 * _CLEAR
    into = centre + side * (radius - _PAST)
    back = side * _BACK
    codes = [
        f"G53 G0 Z{over:.6f}",
        f"G53 G0 X{away[0]:.6f} Y{away[1]:.6f}",
        f"G53 G0 Z{away[2]:.6f}",
        f"G38.3 F{_FAST} X{into[0]:.6f} Y{into[1]:.6f} Z{into[2]:.6f}",
        "G91",
        f"G1 F{_FAST} X{back[0]:.6f} Y{back[1]:.6f} Z{back[2]:.6f}",
        "G90",
        f"G38.3 F{_SLOW} X{into[0]:.6f} Y{into[1]:.6f} Z{into[2]:.6f}",
        f"G53 G0 X{away[0]:.6f} Y{away[1]:.6f} Z{away[2]:.6f}",
        f"G53 G0 Z{over:.6f}",
    ]
    return codes, 7


def _hit(step: Ending) -> Sequence[float]:
    position, tripped = step.probe
    if not tripped:
        raise ControlError("the probe found no ball where it was looked for", "Look for it elsewhere")
    return position[:3]


def _centre(hits: Array, start: Array, radius: float) -> Array:
    """Return the centre of the ball of a known radius that is nearest to the hits (Gauss-Newton)."""
    centre = start.copy()
    for _ in range(10):
        spokes = hits - centre
        lengths = np.linalg.norm(spokes, axis=1)
        step = np.linalg.lstsq(spokes / lengths[:, None], lengths - radius, rcond=None)[0]
        centre += step
    return centre
