"""A mill and a lathe: another axis parked elsewhere, a line that stands for a volume, diameters for radii."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array
from tests.zoo.animals import Animal, Job, Met, Slope
from tests.zoo.answers import Answer
from tests.zoo.axes import line
from tests.zoo.running import predicted, rows_of

YAW = 40e-6
"""Of X over 600 mm, rad."""
_MILL = Job("three-axis-mill", ("laser",), "20 um")
_ALONE = Job("three-axis-mill", ("laser",), "20 um", errors=("EXX",))
_HIGH = ('moves = ["X"]', 'moves = ["X"]\noffset = ["0 mm", "0 mm", "150 mm"]')
_MIRROR = Job("three-axis-mill", ("laser",), "20 um", (_HIGH,), ("EXX",))


@dataclass(frozen=True, slots=True)
class YawTruth:
    """An X that yaws: how far the tool is off along x depends on Y."""

    def left(self, answer: Answer) -> Array:
        """Return how far the tool is from where the record says along x, the mean taken off, um."""
        rng = np.random.default_rng(7)
        poses = rng.uniform([0, 0, 0], [600, 400, 400], (400, 3))
        rows = [[*pose, "X+"] for pose in np.round(poses, 3).tolist()]
        left = _deviation(*poses.T[:2]) - predicted(answer, "X_mm,Y_mm,Z_mm,approach", rows)[:, 0]
        off: Array = left - left.mean()
        return off

    def promised(self, answer: Answer) -> float:
        """Return U along x, um."""
        return float(answer.result["U_axis_um"]["x"])

    def kept(self, _: Answer) -> Slope | None:
        """Return nothing."""
        return None


@dataclass(frozen=True, slots=True)
class LeadTruth:
    """An X with a lead error of 40 um/m, read by a mirror high above the tool point."""

    def left(self, answer: Answer) -> Array:
        """Return what the table leaves over the travel, its mean taken off, um."""
        where, values = answer.axis_table("X")
        x = np.linspace(0, 600, 301)
        left = 0.04 * x - np.interp(x, where, values.mean(axis=0))
        off: Array = left - left.mean()
        return off

    def promised(self, answer: Answer) -> float:
        """Return U with the tables, um."""
        return answer.expanded_with_tables()

    def kept(self, _: Answer) -> Slope | None:
        """Return nothing: the pitch has a slope, too."""
        return None


def mirrored(seed: int) -> Met:
    """Return how X is met by a laser whose mirror sits 150 mm over the tool point, while X pitches by 30 urad."""
    rng = np.random.default_rng((seed, 10))
    out = np.linspace(0, 600, 13)
    x, ways = np.concatenate([out, out[::-1]]), ["X+"] * 13 + ["X-"] * 13
    shown = 0.04 * x + 150e-3 * 30 * np.sin(2 * np.pi * x / 400) + rng.normal(0, 0.3, 26)
    rows = zip(["laser along X"] * 26, x.tolist(), ways, np.round(shown - shown[0], 2).tolist(), strict=True)
    return Met(rows_of("setup,X_mm,approach,value_um", rows), LeadTruth())


def _deviation(x: Array, y: Array) -> Array:
    """Return what X is off along x with the tool at Y, um: a lead error of 15 um/m, and the yaw's lever."""
    yaw = YAW * np.sin(np.pi * (x / 600 - 0.5))
    return 0.015 * x - 1000 * yaw * (y - 200)


def parked(at: float) -> Callable[[int], Met]:
    """Return how the mill is met when Y stands there, while the file says nothing of it.  at : mm"""

    def met(seed: int) -> Met:
        rng = np.random.default_rng((seed, 8))
        out = np.linspace(0, 600, 13)
        x, ways = np.concatenate([out, out[::-1]]), ["X+"] * 13 + ["X-"] * 13
        shown = _deviation(x, np.full(26, at)) + rng.normal(0, 0.3, 26)
        rows = zip(["laser along X"] * 26, x.tolist(), ways, np.round(shown - shown[0], 2).tolist(), strict=True)
        return Met(rows_of("setup,X_mm,approach,value_um", rows), YawTruth())

    return met


LATHE = """[EMC]
VERSION = 1.1
[DISPLAY]
LATHE = 1
[KINS]
KINEMATICS = trivkins coordinates=XZ
JOINTS = 2
[TRAJ]
COORDINATES = XZ
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
[AXIS_X]
MIN_LIMIT = -10
MAX_LIMIT = 120
MAX_VELOCITY = 30
MAX_ACCELERATION = 200
[JOINT_0]
TYPE = LINEAR
MIN_LIMIT = -10
MAX_LIMIT = 120
MAX_VELOCITY = 30
MAX_ACCELERATION = 200
[AXIS_Z]
MIN_LIMIT = -400
MAX_LIMIT = 2
MAX_VELOCITY = 30
MAX_ACCELERATION = 200
[JOINT_1]
TYPE = LINEAR
MIN_LIMIT = -400
MAX_LIMIT = 2
MAX_VELOCITY = 30
MAX_ACCELERATION = 200
"""


@dataclass(frozen=True, slots=True)
class CrossSlideTruth:
    """A cross slide with a lead error.  slope : um per mm of the radius; std : what noise gives it"""

    slope: float
    std: float

    def left(self, answer: Answer) -> Array:
        """Return what the table leaves over the travel, its mean taken off, um."""
        where, values = answer.axis_table("X")
        x = np.linspace(0, 100, 201)
        left = self.slope * x - np.interp(x, where, values.mean(axis=0))
        off: Array = left - left.mean()
        return off

    def promised(self, answer: Answer) -> float:
        """Return U along x with the tables, um."""
        return answer.expanded_with_tables()

    def kept(self, answer: Answer) -> Slope | None:
        """Return what the table keeps of the slope."""
        where, values = answer.axis_table("X")
        return Slope(float(np.polyfit(where, values.mean(axis=0), 1)[0]), self.slope, self.std)


def diameters(seed: int) -> Met:
    """Return a cross slide of 300 um/m read by a dial, its positions the diameters that the display shows."""
    rng = np.random.default_rng((seed, 9))
    out = np.linspace(0, 50, 11)
    radius = np.concatenate([out, out[::-1]])
    shown = 0.3 * radius + rng.normal(0, 0.3, 22)
    rows = zip(
        ["laser along X"] * 22, (2 * radius).tolist(), ["X+"] * 11 + ["X-"] * 11, np.round(shown, 2), strict=True
    )
    return Met(rows_of("setup,X_mm,approach,value_um", rows), CrossSlideTruth(0.3, line(radius, shown, 0.3).std))


MILLS = (
    Animal("parked as stated: Y 200", _MILL, parked(200.0)),
    Animal("parked elsewhere: Y 0, all errors described", _MILL, parked(0.0)),
    Animal("parked elsewhere: Y 0, only EXX described", _ALONE, parked(0.0), r"on the line", quick=True),
    Animal("line for the volume: only EXX described", _ALONE, parked(200.0), r"on the line"),
    Animal("mirror over the tool point: only EXX described", _MIRROR, mirrored, quick=True),
    Animal("diameter for radius", Job(LATHE, ("laser",), "20 um"), diameters, r"diameter|radius"),
)
