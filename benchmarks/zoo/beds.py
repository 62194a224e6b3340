"""Beds of a printer: a beam that sags, half a bed, a rail that rolls under a probe beside the nozzle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array
from benchmarks.zoo.animals import Animal, Job, Met, Truth
from benchmarks.zoo.answers import Answer
from benchmarks.zoo.running import planned, rows_of

JOB = Job("printer-gantry", ("probe",), "50 um")
NOISE = 3.0
LOW, HIGH = 15.0, 285.0
Height = Callable[[Array, Array], Array]
"""From x and y (mm) to how high the bed stands for the nozzle, um."""


@dataclass(frozen=True)
class BedTruth(Truth):
    """height : of the bed under the nozzle"""

    height: Height

    def left(self, answer: Answer) -> Array:
        """Return what the mesh leaves of the bed, the mean taken off, um."""
        x, y = (each.ravel() for each in np.meshgrid(*2 * [np.linspace(LOW, HIGH, 55)]))
        left = self.height(x, y) - answer.height_map().at(x, y)
        found: Array = left - left.mean()
        return found

    def promised(self, answer: Answer) -> float:
        """Return U with the mesh, um."""
        return answer.expanded_with_tables("reprapfirmware")


def grid(high: float = HIGH, columns: int = 7) -> Array:
    """Return places of a mesh, (m, 2) mm."""
    x, y = np.meshgrid(np.linspace(LOW, high, columns), np.linspace(LOW, HIGH, 7))
    return np.column_stack([x.ravel(), y.ravel()])


def again() -> Array:
    """Return a mesh with its first, middle and last row once more, out and back, (m, 2) mm."""
    return np.vstack([grid(), [[150.0, y] for y in (LOW, 150.0, HIGH, 150.0, LOW)]])


def as_planned() -> Array:
    """Return the places that a plan asks for, (m, 2) mm."""
    return np.array([[float(point["position"][axis]) for axis in "XY"] for point in planned(JOB, 36)])


def probed(height: Height, places: Callable[[], Array], jump: float = 0.0) -> Callable[[int], Met]:
    """Return how a bed is met: a high bed stops the probe early, so readings are its heights with the other sign.

    jump : um, of the probe's zero before the fifth row
    """

    def met(seed: int) -> Met:
        rng, where = np.random.default_rng((seed, 3)), places()
        shown = -height(*where.T) + rng.normal(0, NOISE, len(where)) + jump * (np.arange(len(where)) >= 28)
        rows = (("probe", x, y, round(value, 1)) for (x, y), value in zip(where.tolist(), shown.tolist(), strict=True))
        return Met(rows_of("setup,X_mm,Y_mm,value_um", rows), BedTruth(height))

    return met


def sag(x: Array, y: Array) -> Array:
    """Return a gantry that sags by 200 um between its rails, and droops by 60 um along y."""
    middle = (x - 150) / 150
    return 200 * (1 - middle**2) + 60 * (y / 300) ** 2


def one_sided(x: Array, y: Array) -> Array:
    """Return a bed whose right half bows up by 150 um."""
    found: Array = 150 * np.sin(np.pi * np.maximum(x - 150, 0) / 150) + 20 * np.sin(y / 60)
    return found


def flat(x: Array, y: Array) -> Array:
    """Return a bed that is flat for the nozzle."""
    return 0 * x * y


def rolled(most: float, bends: int, beside: tuple[float, float]) -> Callable[[int], Met]:
    """Return how a mesh of Klipper is met whose rail rolls along X, with the probe beside the nozzle.

    most : rad; bends : half waves over 300 mm; beside : mm along x and y
    """

    def met(seed: int) -> Met:
        rng, (x, _) = np.random.default_rng((seed, 4)), grid().T
        roll = most * np.sin(np.pi * bends * (x - beside[0] - 150) / 300)
        heights = (beside[1] * roll + rng.normal(0, 0.003, len(x))).reshape(7, 7)
        points = "".join(f"#*#   {', '.join(f'{z:.6f}' for z in row)}\n" for row in heights)
        return Met(_CFG.format(points=points, x=beside[0], y=beside[1]), BedTruth(flat), "printer.cfg")

    return met


_CFG = """[bltouch]
x_offset: {x}
y_offset: {y}
z_offset: 1.2
[bed_mesh]
mesh_min: 15,15
mesh_max: 285,285
probe_count: 7,7

#*# <---------------------- SAVE_CONFIG ---------------------->
#*# [bed_mesh default]
#*# version = 1
#*# points =
{points}#*# x_count = 7
#*# y_count = 7
#*# mesh_x_pps = 2
#*# mesh_y_pps = 2
#*# algo = bicubic
#*# tension = 0.2
#*# min_x = 15
#*# max_x = 285
#*# min_y = 15
#*# max_y = 285
"""
_JUMPED = r"(anew|jumped) before reading 29"
_BESIDE = r"beside the (nozzle|tool point)"
BEDS = (
    Animal("sag of a beam: mesh of 7 x 7", JOB, probed(sag, grid)),
    Animal("sag of a beam: 36 planned", JOB, probed(sag, as_planned)),
    Animal("zero that jumps at a row: 7 x 7", JOB, probed(sag, grid, 120.0), _JUMPED, asked=True),
    Animal("zero that jumps at a row: of a flat bed", JOB, probed(flat, grid, 60.0), _JUMPED, asked=True),
    Animal("zero that jumps at a row: by 60 um", JOB, probed(sag, grid, 60.0), "changes meanwhile", asked=True),
    Animal("zero that jumps at a row: rows read again", JOB, probed(sag, again, 60.0), _JUMPED, asked=True),
    Animal("half-probed bed: 7 x 4", JOB, probed(one_sided, lambda: grid(150.0, 4)), r"not read|not probed|15 to 150"),
    Animal("rail that rolls under a probe: 46 mm in front", JOB, rolled(1.2e-3, 1, (-33.0, -46.0)), _BESIDE),
    Animal("rail that rolls under a probe: 24 mm behind", JOB, rolled(8e-4, 3, (12.0, 24.0)), _BESIDE),
)
