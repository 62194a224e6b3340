"""A mill with a table C on a swivel A or B as it stands in the hall, for LinuxCNC's trt-kins: truth and instrument.

Written from what the drives do and from nothing of the package: a drive that counts up turns the workpiece by the
right hand about the positive direction x, y or z of the bed, which is against ISO 841. Lengths in mm, angles in deg.

    python tilting_table.py A        answers requests of `exec:` line by line
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping

Point = tuple[float, float, float]
TOOL = 80.0
TABLE = (4.0, -3.0)
"""Where the line of C is, x and y."""
LINE = (7.0, -120.0)
"""Where the line of the swivel is: across the bed (y for A, x for B), and its height."""
SWIVELS = {"A": 0, "B": 1}


def tip(swivel: str, drives: Mapping[str, float], approach: Mapping[str, int] | None = None) -> Point:
    """Return where the tool is on the workpiece when the drives stand at these counts; a machine without errors
    when no approach is given.
    """
    real = approach is not None
    side = approach or {}
    x, y, z = drives["X"], drives["Y"], drives["Z"]
    turn, swing = drives["C"], drives[swivel]
    across, height = LINE
    centre = TABLE
    if real:
        x, y, z = (
            x + 0.014 * math.sin(x / 70) + 1.2e-4 * x + 0.003 * side["X"] - 4e-5 * y + 3e-5 * z,
            y - 0.011 * math.sin(y / 60) - 0.9e-4 * y + 0.0025 * side["Y"] - 2e-5 * z,
            z + 0.009 * math.cos(z / 80) + 1.1e-4 * z,
        )
        turn += math.degrees(9e-5 * math.sin(math.radians(turn)) + 4e-5 * math.cos(math.radians(2 * turn)))
        swing += math.degrees(1.1e-4 * math.sin(math.radians(2.2 * swing)) + 7e-5 * math.radians(swing))
        swing += math.degrees(1.2e-5 * side[swivel])
        centre = (centre[0] + 0.021, centre[1] - 0.013)
        across, height = across - 0.017, height + 0.012
    at = (x, y, z - TOOL)
    pivot = (0.0, across, height) if swivel == "A" else (across, 0.0, height)
    at = _turned(at, pivot, SWIVELS[swivel], -swing)
    return _turned(at, (*centre, 0.0), 2, -turn)


def _turned(point: Point, centre: Point, about: int, angle: float) -> Point:
    """Return a point turned by the right hand about a line through a centre along x, y or z."""
    first, second = (about + 1) % 3, (about + 2) % 3
    cos, sin = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    u, v = point[first] - centre[first], point[second] - centre[second]
    moved = list(point)
    moved[first], moved[second] = centre[first] + cos * u - sin * v, centre[second] + sin * u + cos * v
    return moved[0], moved[1], moved[2]


def deviation(swivel: str, drives: Mapping[str, float], approach: Mapping[str, int]) -> Point:
    """Return by how much the tool is off on the workpiece, mm, with the drives at these counts."""
    found, meant = tip(swivel, drives, approach), tip(swivel, drives)
    return found[0] - meant[0], found[1] - meant[1], found[2] - meant[2]


def main() -> None:
    """Answer requests as a tracker does: the deviation along x, y and z, um."""
    swivel = sys.argv[1]
    for line in sys.stdin:
        asked = json.loads(line)
        approach = dict.fromkeys("XYZABC", 0)
        approach |= {axis: 1 if side == "+" else -1 for axis, side in asked["approach"].items()}
        off = deviation(swivel, asked["position"], approach)
        sys.stdout.write(json.dumps({"value": [1e3 * part for part in off], "unit": "um"}) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
