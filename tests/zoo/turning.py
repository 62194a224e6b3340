"""A five-axis machine with spheres on its table; its motion is written out here, and deviations are not linearised."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.spatial.transform import Rotation

from axiscal.numerics import Array
from tests.zoo.animals import Animal, Job, Met, Truth
from tests.zoo.answers import Answer
from tests.zoo.running import predicted, rows_of

TOOL = 120.0
LOW, HIGH = np.array([[-300.0, -250.0, 0.0, -30.0, 0.0], [300.0, 250.0, 500.0, 120.0, 360.0]])
"""Travel of X, Y, Z (mm), B, C (deg)."""
BALLS = np.array([[83.0, 0.0, 88.0], [-42.0, 67.0, 172.0], [-42.0, -67.0, 138.0]])
"""Where `init` writes that the spheres stand, mm."""


def _job(*stated: tuple[str, str]) -> Job:
    return Job("dmu60", ("touch probe",), "20 um", stated)


@dataclass(frozen=True, slots=True)
class Geometry:
    """Lines of B and C and the stretch of X: what is nominal, in mm and as a share, unless said otherwise."""

    b: tuple[float, float, float] = (0.0, 0.0, -200.0)
    c: tuple[float, float, float] = (0.0, 0.0, -200.0)
    stretch: float = 0.0
    tool: float = TOOL

    def at(self, poses: Array) -> Array:
        """Return the tool point in the frame of the workpiece, (p, 3) mm.  poses : (p, 5) X Y Z mm, B C deg"""
        x, y, z, b, c = poses.T
        tip = np.column_stack([x * (1 + self.stretch), y, z - self.tool])
        on_b = _about("y", b).apply(tip - self.b) + self.b
        return np.asarray(_about("z", c).apply(on_b - self.c) + self.c)

    def reaching(self, points: Array, turned: Array) -> Array:
        """Return the poses that bring the tool to points of the workpiece.  points : (p, 3) mm; turned : (p, 2) deg"""
        b, c = turned.T
        on_b = _about("z", -c).apply(points - self.c) + self.c
        tip = _about("y", -b).apply(on_b - self.b) + self.b
        return np.column_stack([tip + np.array([0.0, 0.0, self.tool]), turned])


def _about(axis: str, angle: Array) -> Rotation:
    """Return turns about an axis of the frame.  angle : (p,) deg"""
    return Rotation.from_euler(axis, angle[:, None], degrees=True)


NOMINAL = Geometry()
REAL = Geometry(b=(0.0, 0.0, -200.020), c=(0.055, -0.025, -200.0), stretch=20e-6)


@dataclass(frozen=True)
class TableTruth(Truth):
    """What the machine does beside what it should."""

    real: Geometry

    def left(self, answer: Answer) -> Array:
        """Return how far the tool is from where the record says, (p,) um, a shift and a turn of the part taken off."""
        rng = np.random.default_rng(5)
        poses = rng.uniform(LOW, HIGH, (300, 5))
        where = NOMINAL.at(poses)
        left = 1000 * (self.real.at(poses) - where) - predicted(answer, _POSES, np.round(poses, 6).tolist())
        columns = np.concatenate([np.tile(np.eye(3), (len(poses), 1)), _turns(where)], axis=1)
        fitted = np.linalg.lstsq(columns, left.ravel(), rcond=None)[0]
        size: Array = np.linalg.norm(left - (columns @ fitted).reshape(left.shape), axis=1)
        return size

    def promised(self, answer: Answer) -> float:
        """Return U, um."""
        return answer.expanded


@dataclass(frozen=True)
class CentreTruth(Truth):
    """Where the line of C lies beside where it should."""

    real: Geometry

    def left(self, answer: Answer) -> Array:
        """Return how far off the line is said to be beside what is true, (2,) um along x and y."""
        said = [answer.result["constants"][name]["mean"] for name in ("X0C", "Y0C")]
        return np.array(said) - 1000 * (np.array(self.real.c) - NOMINAL.c)[:2]

    def promised(self, answer: Answer) -> float:
        """Return U of the centre of C, um."""
        return next(float(row["known_to"]) for row in answer.result["rows"] if row["row"] == "centre of C")


_POSES = "X_mm,Y_mm,Z_mm,B_deg,C_deg"


def _turns(where: Array) -> Array:
    """Return what small turns about x, y and z do at points, (3p, 3)."""
    scaled = where / 100
    return np.concatenate([np.cross(np.eye(3), point).T for point in scaled])


def touched(
    truth: Callable[[Geometry], TableTruth | CentreTruth], longer: float = 0.0, *, machine_frame: bool = False
) -> Callable[[int], Met]:
    """Return how the machine is met.

    longer : how much the tool is longer than stated, mm; machine_frame : values are along the machine's x, y, z
    """

    def met(seed: int) -> Met:
        rng, real = np.random.default_rng((seed, 6)), replace(REAL, tool=TOOL + longer)
        turned = np.array(list(product((-30.0, -15.0, 0.0, 30.0), np.arange(0.0, 360.0, 30.0))))
        points = BALLS[np.arange(len(turned)) % 3]
        poses = NOMINAL.reaching(points, turned)
        reached = np.all((poses > LOW - 1e-9) & (poses < HIGH + 1e-9), axis=1)
        poses, points = poses[reached], points[reached]
        off = real.at(poses) - points
        if machine_frame:
            off = poses[:, :3] - real.reaching(points, turned[reached])[:, :3]
        shown = np.round(1000 * off + rng.normal(0, 1.5, off.shape), 1)
        rows = (
            ("spheres", *np.round(pose, 6).tolist(), "B+ C+", *values.tolist())
            for pose, values in zip(poses, shown, strict=True)
        )
        return Met(rows_of(f"setup,{_POSES},approach,value_x_um,value_y_um,value_z_um", rows), truth(REAL))

    return met


_STATED = _job(('tool_length = "100 um"', 'tool_length = "5 um"'))
_FRAME = r"machine('s)? (frame|directions|X, Y)|frame of the machine|turned by"
_TOOL = r"tool.{0,60}(certificate|source|longer|not as stated)"
TURNING = tuple(
    Animal(f"{kind}: {name}", job, touched(truth, longer, machine_frame=in_machine), cause)
    for kind, job, longer, in_machine, cause in (
        ("touches of the workpiece", _job(), 0.0, False, ""),
        ("touches in the machine's frame", _job(), 0.0, True, _FRAME),
        ("tool 50 um longer than stated", _STATED, 0.05, False, _TOOL),
    )
    for name, truth in (("centre of C", CentreTruth), ("volume", TableTruth))
)
