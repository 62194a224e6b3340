"""What a file holds: a machine as the control knows it, in the units of its configuration."""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.numerics import Array
from axiscal.tables.surface import Mesh

AXES, JOINTS, KNOTS, MOTIONS = 6, 9, 96, 6
"""By the component's source: axes, joint numbers, knots of an axis, error motions of an axis."""
LEAST_DETERMINANT = 0.2
"""By the component's source: of the directions of the linear axes; less is a fault."""
FADE_MM, FADE_DEG = 5.0, 5.0
"""By the component's source: over so much beyond the last knot a curve's slope fades to nothing."""


@dataclass(frozen=True, eq=False, slots=True)
class VcompAxis:
    """One axis; positions are those by ISO 841, `sense` times what its joints count.

    along : 0, 1, 2 for x, y, z; side : 1 tool, -1 workpiece; joints : its numbers, two of a gantry
    origin : (3,) of a rotary axis; place : (6,) location errors; tilt : (3,) rad, of the travel of a linear axis
    knots : (n,); motions : (n - 1, 6, 4), a b c d of x y z and about x y z from each knot on
    reversals : (n - 1, r, 4), r 6 or, where there are none, 0; seconds : that a reversal takes
    """

    name: str
    along: int
    rotary: bool
    side: int
    sense: int
    joints: tuple[int, ...]
    origin: Array
    place: Array
    tilt: Array
    cyclic: bool
    seconds: float
    knots: Array
    motions: Array
    reversals: Array


@dataclass(frozen=True, eq=False, slots=True)
class VcompFile:
    """A whole file.

    campaign : the beginning of its record's hash; unit : mm or inch
    limit, limit_deg : the largest correction of a linear and of a rotary joint; tool : (3,) from the spindle nose
    axes : in chain order, from the workpiece to the tool
    bed : what is added to z over x and y beside them, m, where the control has that
    """

    campaign: str
    unit: str
    limit: float
    limit_deg: float
    tool: Array
    axes: tuple[VcompAxis, ...]
    bed: Mesh | None = None


def fnv1a(data: bytes) -> int:
    """Return the 32-bit FNV-1a hash of bytes (Fowler, Noll, Vo): any single changed byte changes it."""
    found = 2166136261
    for byte in data:
        found = (found ^ byte) * 16777619 & 0xFFFFFFFF
    return found
