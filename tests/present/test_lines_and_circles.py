"""Positioning and ball bar circles: numbers of the tests' own, drawn to scale, with the lines pictures keep."""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.present.drawing.strokes import Point, simplified
from axiscal.present.drawn_by_standards import (
    BallBarCircle,
    ball_bar_circles,
    circle_picture,
    division,
    positioning_curves,
)
from tests.evaluation.said import idle
from tests.generators.kinematics import tip
from tests.generators.laser_axis import CAMPAIGN, MACHINE
from tests.generators.texts import campaign_text, setup_text

_BAR = campaign_text(
    "three-axis-mill",
    setup_text("bar", "ballbar", length="150 mm", station=["300 mm", "200 mm", "80 mm"], plane="xy", approach="both"),
    target={"readings": 40},
)


def _laser() -> tuple[Case, list[Reading]]:
    case = Case(campaign_from_texts(CAMPAIGN, "c.toml", MACHINE, "m.toml"))
    low, high = case.description.machine.axes[0].travel
    places = np.linspace(low, high, 9)
    readings = [
        Reading("laser", (float(x),), (side,), 1e-5 * math.sin(3 * x / high) + side * 1e-6)
        for side in (1, -1)
        for x in places
    ]
    return case, readings


def test_positioning_is_that_of_the_estimate_from_both_sides() -> None:
    case, readings = _laser()
    known = concluded(case, readings)
    (curve,) = positioning_curves(known)
    estimate, axis = known.estimate(), case.description.machine.axes[0]
    at = np.linspace(*axis.travel, len(curve.position))
    np.testing.assert_allclose(curve.position, 1e3 * at, atol=1e-9)
    sides = [estimate.deviation(at[:, None], np.full((len(at), 1), side))[:, 0] for side in (1.0, -1.0)]
    mean = np.mean(sides)
    for found, own in zip(curve.found, sides, strict=True):
        np.testing.assert_allclose(found, 1e6 * (own - mean), atol=1e-6)
    assert curve.left is None
    assert min(min(half) for half in curve.half) > 0


def test_a_circle_shows_the_readings_without_their_centre() -> None:
    machine = load_machine("three-axis-mill")
    case = Case(campaign_from_texts(_BAR, "c.toml", machine.text, "m.toml"))
    angles = np.radians(np.arange(5.0, 360.0, 20.0))
    oval = 8e-6 * np.cos(2 * angles)
    bars = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    base = tip(machine, np.zeros(3))
    poses = np.array([0.3, 0.2, 0.08]) + 0.15 * bars - base
    poses = poses[:, [{"X": 0, "Y": 1, "Z": 2}[axis.name] for axis in machine.axes]]
    values = oval + 2e-5 * np.cos(angles) - 3e-5 * np.sin(angles) + 4e-6
    readings = [
        Reading("bar", tuple(pose.tolist()), (1, 1, 1), float(v)) for pose, v in zip(poses, values, strict=True)
    ]
    known = concluded(case, readings)
    (circle,) = ball_bar_circles(known, idle)
    assert circle.plane == "xy"
    np.testing.assert_allclose(circle.angle, np.degrees(angles), atol=1e-6)
    np.testing.assert_allclose(circle.read, 1e6 * oval, atol=1e-6)
    np.testing.assert_allclose(circle.left or (), circle.found, atol=1e-9)
    assert ball_bar_circles(concluded(case, readings[:7])) == []
    assert ball_bar_circles(concluded(case, readings[:9])) == []  # half a turn


@pytest.mark.parametrize("size", [0.3, 7.0, 180.0])
def test_a_circle_is_drawn_to_scale(size: float) -> None:
    angles = np.arange(0.0, 360.0, 30.0)
    rng = np.random.default_rng(2)
    read = size * rng.uniform(-1, 1, len(angles))
    circle = BallBarCircle("bar", "zx", angles.tolist(), read.tolist(), (read / 2).tolist(), None)
    assert max(abs(read)) / 5 <= division(circle) <= max(abs(read)) / 2
    drawing = ElementTree.fromstring(circle_picture(circle, 340.0))
    radii = sorted(float(each.get("r", "0")) for each in drawing.iter("circle"))
    step, nominal = (radii[-1] - radii[0]) / 10, radii[5]
    marks = next(each.get("d", "") for each in drawing.iter("path") if each.get("stroke-linecap") == "round")
    points = np.array([[float(x), float(y)] for x, y in re.findall(r"M([\d.]+) ([\d.]+)h0", marks)]) - 170.0
    np.testing.assert_allclose(np.hypot(*points.T), nominal + read / division(circle) * step, atol=0.2)
    turns = np.degrees(np.arctan2(-points[:, 1], points[:, 0])) % 360
    np.testing.assert_allclose(turns, angles, atol=0.2)
    words = {each.text for each in drawing.iter("text")}
    assert words == {"z", "x", f"one division: {division(circle):g} µm"}
    assert all(float(each.get("font-size", "0")) >= 14 for each in drawing.iter("text"))


_SEEN = 0.12
"""Pixels."""


def _off(point: Point, start: Point, end: Point) -> float:
    along, away = (end[0] - start[0], end[1] - start[1]), (point[0] - start[0], point[1] - start[1])
    length = math.hypot(*along)
    return abs(along[0] * away[1] - along[1] * away[0]) / length if length else math.hypot(*away)


def _kept(points: list[Point], first: int, last: int) -> set[int]:
    """Return which points between two that are kept are kept; of two as far off the later one goes first."""
    each = [(_off(points[i], points[first], points[last]), i) for i in range(first + 1, last)]
    if not each or max(each)[0] <= _SEEN:
        return set()
    far = max(each)[1]
    return {far} | _kept(points, first, far) | _kept(points, far, last)


@pytest.mark.parametrize("seed", range(12))
def test_the_points_that_are_kept_are_those_of_douglas_and_peucker(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x = np.arange(120.0)
    y = 50 + 20 * np.sin(x / (3 + seed)) + (seed % 3) * rng.random(120)
    points = list(zip(x.tolist(), (np.round(y) if seed % 4 == 1 else y).tolist(), strict=True))
    if seed % 4 == 2:
        points += points[::-1]  # there and back: it ends where it began
    kept = sorted({0, len(points) - 1} | _kept(points, 0, len(points) - 1))
    assert simplified(points) == [points[i] for i in kept]
