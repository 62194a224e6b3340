"""Beds of many owners' printers: what a few probed points leave, beside an even grid and a thin-plate spline.

Each owner's densest map is the truth, the plane of best fit taken off, stretched onto the bed of the built-in printer.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.interpolate import RBFInterpolator, RegularGridInterpolator

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import expanded_uncertainty
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from benchmarks.trust.curves import DATA

BEDS = DATA / "sisters"
COUNTS = (9, 16, 25)
_DENSE = 7
"""Points along each side of a map that is dense enough to be a truth."""
_LOW, _HIGH = 0.010, 0.290
_PRINTER = "printer-gantry"
_CAMPAIGN = f"""machine = "{_PRINTER}"
[target]
readings = 16
directions = ["z"]
volume = {{ X = ["10 mm", "290 mm"], Y = ["10 mm", "290 mm"], Z = ["0 mm", "1 mm"] }}
[[setups]]
name = "probe"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
park = {{ Z = "0 mm" }}
reach = {{ X = ["10 mm", "290 mm"], Y = ["10 mm", "290 mm"] }}
noise = "2 um"
unknowns = {{ zero = "5 mm" }}
"""


@dataclass(frozen=True, eq=False)
class Bed:
    """A printer's bed.  kind : of printer; places : (m, 2) m; heights : (m,) m; between : heights anywhere"""

    kind: str
    places: Array
    heights: Array
    between: RegularGridInterpolator


@dataclass(frozen=True, slots=True)
class Kept:
    """What so many readings leave: missed m RMS, planned, at an even grid, and of the spline on that grid.

    inside : share of the bed within U as printed, planned and even
    """

    missed: tuple[float, float, float]
    inside: tuple[float, float]


def beds() -> Iterator[Bed]:
    """Yield the bed of each owner who has a dense map."""
    for path in sorted(BEDS.glob("*/*.json")):
        maps = json.loads(path.read_text(encoding="utf-8"))["maps"]
        dense = max(maps, key=lambda each: len(each["x_mm"]) * len(each["y_mm"]))
        if min(len(dense["x_mm"]), len(dense["y_mm"])) >= _DENSE:
            yield _bed(path.parent.name, *(np.array(dense[key], dtype=float) for key in ("x_mm", "y_mm", "z_mm")))


def _bed(kind: str, x: Array, y: Array, z: Array) -> Bed:
    along, across = (_LOW + (_HIGH - _LOW) * (each - each[0]) / (each[-1] - each[0]) for each in (x, y))
    places = np.array([(a, b) for b in across for a in along])
    plane = np.column_stack([np.ones(len(places)), places])
    heights = 1e-3 * z.ravel()
    heights -= plane @ np.linalg.lstsq(plane, heights, rcond=None)[0]
    between = RegularGridInterpolator((across, along), heights.reshape(z.shape), bounds_error=False, fill_value=None)
    return Bed(kind, places, heights, between)


@cache
def _case(std: str = "60 um") -> Case:
    """Return the built-in printer.  std : stated of the heights along X, along Y, and of both together"""
    text = re.sub(r'(EZX|EZY|EZXY) = \{ std = "60 um"', rf'\1 = {{ std = "{std}"', load_machine(_PRINTER).text)
    return Case(campaign_from_texts(_CAMPAIGN, "campaign.toml", text, _PRINTER))


@cache
def _planned(count: int, std: str) -> Array:
    """Return where a plan of so many readings probes, (n, 2) m."""
    plan = proposed(_case(std), Limits(count), 1000)
    return np.clip([_on_bed(pose) for pose in plan.places.poses], _LOW, _HIGH)


def _even(count: int) -> Array:
    side = np.linspace(_LOW, _HIGH, math.isqrt(count))
    return np.array([(x, y) for y in side for x in side])


def _on_bed(pose: Array) -> tuple[float, float]:
    axes = [axis.name for axis in _case().description.machine.axes]
    return float(pose[axes.index("X")]), float(pose[axes.index("Y")])


def _poses(places: Array) -> Array:
    """Return poses of the machine over places of the bed, (m, q) m."""
    axes = [axis.name for axis in _case().description.machine.axes]
    poses = np.zeros((len(places), len(axes)))
    poses[:, [axes.index("X"), axes.index("Y")]] = places
    return poses


def kept(bed: Bed, count: int, std: str = "60 um") -> Kept:
    """Return what so many readings leave of a bed.  std : that is stated of its heights"""
    planned, even = (_estimated(bed, places, std) for places in (_planned(count, std), _even(count)))
    at = _even(count)
    spline = RBFInterpolator(at, bed.between(at[:, ::-1]), kernel="thin_plate_spline")(bed.places)
    return Kept((planned[0], even[0], _spread(bed.heights - spline)), (planned[1], even[1]))


def _estimated(bed: Bed, places: Array, std: str) -> tuple[float, float]:
    """Return what readings at places of the bed leave, m RMS, and which share of the bed lies within U."""
    values = bed.between(places[:, ::-1])
    poses = _poses(places)
    readings = [
        Reading("probe", tuple(pose.tolist()), tuple(0 for _ in pose), float(value))
        for pose, value in zip(poses, values, strict=True)
    ]
    known = concluded(_case(std), readings)
    where = _poses(bed.places)
    left = bed.heights - known.estimate().deviation(where, np.zeros_like(where))[:, 2]
    left -= left.mean()
    return _spread(left), float(np.mean(np.abs(left) <= expanded_uncertainty(known).space))


def _spread(left: Array) -> float:
    return float(np.std(left))


def bed_rows(every: Sequence[Bed]) -> Iterator[str]:
    """Yield a line for each count of readings."""
    kinds = sorted({bed.kind for bed in every})
    for count in COUNTS:
        found = [kept(bed, count) for bed in every]
        missed = np.log([each.missed for each in found])
        planned, even, spline = np.exp(missed.mean(axis=0)) * 1e6
        inside = [f"{np.mean([each.inside[k] for each in found]):.0%}" for k in range(2)]
        gains = missed[:, 0] - missed[:, 1]
        of = np.array([bed.kind for bed in every])
        worst = max(np.exp(gains[of == kind].mean()) for kind in kinds)
        sizes = f"{planned:.3g} | {even:.3g} | {spline:.3g}"
        yield f"| {count} | {inside[0]} | {inside[1]} | {sizes} | {np.exp(gains.mean()):.2f} | {worst:.2f} |"


def available() -> bool:
    """Return whether the maps are there: they are no part of the project."""
    return BEDS.is_dir()
