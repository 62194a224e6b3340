"""Starts and polish each by itself: exact distances, and scipy's least squares."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from axiscal.estimation.case import Case
from axiscal.estimation.stations import BentReadings, mirrored, polished, progressed, tips
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from tests.generators.tracers import tracers

CASE = tracers("300 mm", "100 mm")
TRUTH = np.array([0.12, -0.21, 0.05])
ZERO = 0.031


def exact(case: Case, poses: Sequence[tuple[float, float, float]], index: int = 0) -> list[Reading]:
    """Return what a tracer shows that stands off by TRUTH, of a machine without errors."""
    setup = case.description.setups[index]
    bare = [Reading(setup.name, pose, (1, 1, 1), 0.0, time=0.0) for pose in poses]
    stated, dead = np.array(setup.standing[0]), ZERO if "zero" in {u.name for u in setup.unknowns} else 0.0
    places = tips(case, bare)
    shown = np.linalg.norm(places - stated - TRUTH, axis=1) - np.linalg.norm(places - stated, axis=1) - dead
    return [replace(each, value=float(value)) for each, value in zip(bare, shown, strict=True)]


POSES = [(0.0, 0.0, 0.0), (0.5, 0.0, 0.1), (0.0, 0.4, 0.2), (0.5, 0.4, 0.3), (0.2, 0.1, 0.35), (0.3, 0.3, 0.05)]


def test_six_exact_distances_give_the_station_and_its_dead_path() -> None:
    readings = exact(CASE, POSES)
    point = progressed(CASE, readings, ()).about
    assert point is not None
    assert point[list(CASE.station_columns(0)[0])] == pytest.approx(TRUTH, abs=1e-4)
    assert BentReadings(CASE, readings).left(point) == pytest.approx(0, abs=0.1)


def test_an_image_is_as_far_from_every_place_of_a_plane_and_behind_it() -> None:
    flat = [(x, y, 0.2) for x, y, _ in POSES]
    readings = exact(CASE, flat)
    (image,) = mirrored(CASE, readings, CASE.prior.mean, 0)
    columns = list(CASE.station_columns(0)[0])
    stated, places = np.array(CASE.description.setups[0].standing[0]), tips(CASE, readings)
    station, behind = stated + CASE.prior.mean[columns], stated + image[columns]
    assert np.linalg.norm(places - station, axis=1) == pytest.approx(np.linalg.norm(places - behind, axis=1))
    assert (station - places[0])[2] == pytest.approx(-(behind - places[0])[2])
    assert not np.delete(image - CASE.prior.mean, columns).any()
    assert mirrored(CASE, readings[:4], CASE.prior.mean, 0)
    assert mirrored(CASE, readings[:3], CASE.prior.mean, 0) == []
    assert mirrored(CASE, readings, CASE.prior.mean, 1) == []


def _bent_readings() -> BentReadings:
    """Return what a tracer shows at nine places, off by some micrometres that no station explains."""
    rng = np.random.default_rng(3)
    readings = exact(CASE, [(*xy, z) for *xy, z in rng.uniform(0.0, 0.35, (9, 3)).tolist()])
    return BentReadings(CASE, [replace(each, value=each.value + 3e-6 * rng.standard_normal()) for each in readings])


def test_the_polish_ends_where_scipy_ends_and_never_above_its_start() -> None:
    problem = _bent_readings()

    def left(z: Array) -> Array:
        both: Array = np.r_[z, problem.left(problem.start + problem.root @ z)]
        return both

    start = CASE.prior.mean  # 300 mm off, by damping alone
    found = polished(problem, start)
    z, before = problem.whitened(found.point), problem.whitened(start)
    assert found.cost < float(left(before) @ left(before)) / 2
    assert found.cost == pytest.approx(float(left(z) @ left(z)) / 2)
    by_scipy = least_squares(left, z, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    assert found.cost == pytest.approx(float(by_scipy.cost), rel=1e-9)
    assert np.abs(by_scipy.x - z).max() < 1e-5
    again = polished(problem, found.point)
    assert again.cost <= found.cost * (1 + 1e-12)  # rounding
    assert problem.whitened(again.point) == pytest.approx(z, abs=1e-6)
