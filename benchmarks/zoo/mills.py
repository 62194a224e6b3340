"""A mill and a lathe: another axis parked elsewhere, a line that stands for a volume, diameters for radii."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from axiscal.numerics import Array
from benchmarks.zoo.animals import Animal, Job, Met, Truth
from benchmarks.zoo.answers import Answer
from benchmarks.zoo.axes import LASER, AxisTruth, Visits, even, line, written
from benchmarks.zoo.running import predicted, rows_of

YAW = 40e-6
"""Of X over 600 mm, rad."""
_MILL = Job("three-axis-mill", ("laser",), "20 um")
_ALONE = Job("three-axis-mill", ("laser",), "20 um", errors=("EXX",))
_HIGH = ('moves = ["X"]', 'moves = ["X"]\noffset = ["0 mm", "0 mm", "150 mm"]')
_MIRROR = Job("three-axis-mill", ("laser",), "20 um", (_HIGH,), ("EXX",))


class YawTruth(Truth):
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


def _deviation(x: Array, y: Array) -> Array:
    """Return what X is off along x with the tool at Y, um: a lead error of 15 um/m, and the yaw's lever."""
    yaw = YAW * np.sin(np.pi * (x / 600 - 0.5))
    return 0.015 * x - 1000 * yaw * (y - 200)


def parked(at: float) -> Callable[[int], Met]:
    """Return how the mill is met when Y stands there, while the file says nothing of it.  at : mm"""

    def met(seed: int) -> Met:
        rng, visits = np.random.default_rng((seed, 8)), even(13, 1, 600)
        shown = _deviation(visits.x, np.full(26, at)) + rng.normal(0, LASER.noise, 26)
        return Met(written(LASER, visits, shown - shown[0]), YawTruth())

    return met


def mirrored(seed: int) -> Met:
    """Return how X is met by a laser whose mirror sits 150 mm over the tool point, while X pitches by 30 urad."""
    rng, visits = np.random.default_rng((seed, 10)), even(13, 1, 600)
    pitch = 30 * np.sin(2 * np.pi * visits.x / 400)
    shown = 0.04 * visits.x + 150e-3 * pitch + rng.normal(0, LASER.noise, 26)
    return Met(written(LASER, visits, shown - shown[0]), AxisTruth(lambda x, _: 0.04 * x, end=600))


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


def diameters(seed: int) -> Met:
    """Return a cross slide of 300 um/m read by a dial, its positions the diameters that the display shows."""
    rng, radii = np.random.default_rng((seed, 9)), even(11, 1, 50)
    shown = 0.3 * radii.x + rng.normal(0, LASER.noise, 22)
    straight = line(radii.x, shown, LASER.noise)
    return Met(written(LASER, Visits(2 * radii.x, radii.sides), shown), AxisTruth(lambda x, _: 0.3 * x, straight, 100))


@dataclass(frozen=True, slots=True)
class BarTruth(Truth):
    """A mill without an error but backlash, in the plane of a circle."""

    backlash: float

    def left(self, answer: Answer) -> Array:
        """Return how far the tool is from where the record says in the plane, the mean taken off, um."""
        rng = np.random.default_rng(12)
        poses, sides = np.round(rng.uniform([150, 50], [450, 350], (100, 2)), 3), rng.choice([-1, 1], (100, 2))
        rows = [(x, y, 200, "X+ Y+" if i + j > 0 else "X- Y-") for (x, y), (i, j) in zip(poses, sides, strict=True)]
        signs = np.where(sides.sum(axis=1) > 0, 0.5, -0.5)[:, None]
        left = signs * self.backlash - predicted(answer, "X_mm,Y_mm,Z_mm,approach", rows)[:, :2]
        off: Array = np.linalg.norm(left - left.mean(axis=0), axis=1)
        return off


@dataclass(frozen=True, slots=True)
class RowsTruth(Truth):
    """What rows of the answer should say, with their sign."""

    rows: tuple[tuple[str, float], ...]

    def left(self, answer: Answer) -> Array:
        """Return how far off each row is, over its U, (r,)."""
        found = {row["row"]: row for row in answer.result["rows"]}
        said = [(found[name]["signed"][0]["value"], found[name]["known_to"], true) for name, true in self.rows]
        return np.array([(value - true) / known_to for value, known_to, true in said])

    def promised(self, _: Answer) -> float:
        """Return U over itself."""
        return 1.0


def backlashes(backlash: float) -> RowsTruth:
    """Return a backlash of both axes of a circle, um."""
    return RowsTruth((("backlash X", backlash), ("backlash Y", backlash)))


def circled(
    lag: float = 0.0,
    over: float = 0.0,
    truth: Callable[[float], Truth] = BarTruth,
    *,
    ways: tuple[int, ...] = (1, -1),
    backlash: float = 4.0,
) -> Callable[[int], Met]:
    """Return how a mill is met by a ball bar.

    lag : um, of X behind Y at that feed; over : mm, after which the reversal of X lacks 1/e, all of it as it turns
    ways : round, in this order; backlash : of both axes, um
    """

    def met(seed: int) -> Met:
        rng, rows = np.random.default_rng((seed, 13)), list[tuple[object, ...]]()
        for way in ways:
            for turn in way * np.radians(np.arange(0, 360, 10)):
                bar, before = (np.array([np.cos(t), np.sin(t)]) for t in (turn, turn - way * 1e-4))
                sides = np.sign(bar - before)
                missing = np.exp(-150 * (1 + sides * bar) / over) * [1, 0] if over else 0.0
                off = sides * backlash * (0.5 - missing) + [lag * way * np.sin(turn), 0]
                where, value = [300, 200] + 150 * bar, bar @ off + rng.normal(0, 0.5)
                came = " ".join(f"{axis}{'+' if side > 0 else '-'}" for axis, side in zip("XY", sides, strict=True))
                rows.append(("ball bar in xy", *np.round(where, 6).tolist(), 200, came, round(float(value), 2)))
        return Met(rows_of("setup,X_mm,Y_mm,Z_mm,approach,value_um", rows), truth(backlash))

    return met


_BAR = Job("three-axis-mill", ("ball bar",), "20 um", errors=("EXX", "EYY", "EXX_reversal", "EYY_reversal", "C0Y"))
_WANTS = ('U = "20 um"', 'wants = ["backlash X", "backlash Y"]')
_BACKLASH = Job("three-axis-mill", ("ball bar",), "20 um", (_WANTS,), _BAR.errors)
LAGGING = Animal("servo that lags: circles both ways round", _BAR, circled(16.0), "one axis lagged", asked=True)
ONE_WAY = Animal("servo that lags: circles one way round", _BAR, circled(16.0, ways=(1,)), "one way round", asked=True)
IN_STEP = Animal("circles of a ball bar: both ways round", _BAR, circled())
_LEGS = ('U = "20 um"', 'wants = ["squareness XY"]')
_SQUARE = Job("three-axis-mill", ("square",), "20 um", (_LEGS,), ("EYX", "EXY", "C0Y"))


def squared(sign: int) -> Callable[[int], Met]:
    """Return how a mill out of square by 60 urad is met by a dial on a square that lies turned by 0.4 mrad.

    sign : of the values along Y
    """

    def met(seed: int) -> Met:
        rng, legs, rows = (
            np.random.default_rng((seed, 14)),
            "dial on the leg of square XY along",
            list[tuple[object, ...]](),
        )
        for name, side in product("XY", (1, -1)):
            for at in np.linspace(-1, 1, 7)[::side].round(2).tolist():
                x, y, slope = (300 + 150 * at, 200, 0.4 * 150) if name == "X" else (300, 200 + 100 * at, -0.46 * 100)
                value = (sign if name == "Y" else 1) * (slope * at + rng.normal(0, 1))
                rows.append((f"{legs} {name}", x, y, 200, f"{name}{'+' if side > 0 else '-'}", round(value, 1)))
        return Met(rows_of("setup,X_mm,Y_mm,Z_mm,approach,value_um", rows), RowsTruth((("squareness XY", 60.0),)))

    return met


SQUARE = Animal("dial on a square: squareness", _SQUARE, squared(1))


class NotKnown(Truth):
    """A truth that no reading tells from its mirror image."""

    def left(self, answer: Answer) -> Array:
        """Return nothing: only the cause counts."""
        return np.zeros(1)


def yawing(seed: int) -> Met:
    """Return how X is met by an autocollimator that counts the other way."""
    rng, visits = np.random.default_rng((seed, 15)), even(11, 1, 600)
    shown = -1e6 * YAW * np.sin(np.pi * (visits.x / 600 - 0.5)) + rng.normal(0, 0.5, 22)
    sides = np.where(visits.sides > 0, "X+", "X-")
    rows = [('"autocollimator along X, about z"', *row) for row in zip(visits.x, sides, shown, strict=True)]
    return Met(rows_of("setup,X_mm,approach,value_urad", rows), NotKnown())


def tracked(seed: int) -> Met:
    """Return how a mill is met by a tracker whose x and y are exchanged."""
    rng = np.random.default_rng((seed, 16))
    poses = rng.uniform([0, 0, 0], [600, 400, 400], (30, 3)).round(1)
    off = np.column_stack([0.03 * poses[:, 0], 10 * np.sin(poses[:, 1] / 100), 0.02 * poses[:, 2]])
    shown = (off[:, [1, 0, 2]] + rng.normal(0, 5, (30, 3))).round(1)
    rows = [("tracker", *at, "X+ Y+ Z+", *values) for at, values in zip(poses, shown, strict=True)]
    columns = ",".join(f"value_{axis}_um" for axis in "xyz")
    return Met(rows_of(f"setup,X_mm,Y_mm,Z_mm,approach,{columns}", rows), NotKnown())


_ANGLES, _TRACKER = (Job("three-axis-mill", (each,), "20 um") for each in ("autocollimator", "tracker"))
MILLS = (
    SQUARE,
    Animal("sign of an angle: yaw", _ANGLES, yawing, "With the other sign", asked=True),
    Animal("frame of a tracker: x and y", _TRACKER, tracked, "With x and y exchanged", asked=True),
    Animal("slip: sign of a leg of a square", _SQUARE, squared(-1), "have the wrong sign", asked=True),
    LAGGING,
    ONE_WAY,
    IN_STEP,
    Animal("circles of a ball bar: backlash", _BACKLASH, circled(truth=backlashes)),
    Animal("servo that lags: backlash by circles", _BACKLASH, circled(16.0, truth=backlashes)),
    Animal(
        "reversal of X that comes late: circles",
        _BACKLASH,
        circled(over=30.0, truth=backlashes, backlash=8.0),
        "a reversal came late",
    ),
    Animal("parked as stated: Y 200", _MILL, parked(200.0)),
    Animal("parked elsewhere: Y 0, all errors described", _MILL, parked(0.0)),
    Animal("parked elsewhere: Y 0, only EXX described", _ALONE, parked(0.0), r"on the line"),
    Animal("line for the volume: only EXX described", _ALONE, parked(200.0), r"on the line"),
    Animal("mirror over the tool point: only EXX described", _MIRROR, mirrored),
    Animal("diameter for radius", Job(LATHE, ("laser",), "20 um"), diameters, r"diameter|radius"),
)
