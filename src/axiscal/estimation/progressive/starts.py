"""Possible places of a station, in closed form, and of its mirror image.

The square of n = |p − s| + z is linear in s, z and |s|² − z². It reads −2 pᵀs + 2 n z + (|s|² − z²) = n² − |p|². Five
points that are not in a plane settle it. Seen from points in one plane, a station and its mirror image in that plane
are alike.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.estimation.case import Case
from axiscal.machine.kinematics import frames
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.gaussian import settled

_SOUND = 1e-6
"""Share of the largest singular value below which points are as good as in a plane."""


def closed_form(case: Case, readings: Sequence[Reading], point: Array) -> Array:
    """Return a point (k,) with stations and dead paths of distances where they alone fit the readings best.

    Those of too few points, or of points in a plane, stay.
    """
    found = point.copy()
    for index, setup in enumerate(case.description.setups):
        seen_by = [reading for reading in readings if reading.setup == setup.name]
        if len(seen_by) < 6:
            continue
        own = dict(zip((u.name for u in setup.unknowns), case.observation.unknowns_of(index).tolist(), strict=True))
        tip = tips(case, seen_by)
        for number, (columns, stated) in enumerate(zip(case.station_columns(index), setup.standing, strict=False)):
            zero = own.get(f"zero_{number + 1}" if setup.stations else "zero")
            shown = np.array([reading.values[number] for reading in seen_by])
            solved = _one_station(tip - np.array(stated), shown, with_zero=zero is not None)
            if solved is not None:
                found[list(columns)] = solved[:3]
                found[[] if zero is None else [zero]] = solved[3]
    return found


def _one_station(places: Array, shown: Array, *, with_zero: bool) -> Array | None:
    """Return s, and z or something else after it, (4,); None of points in a plane.

    places : (m, 3) from where it is stated to stand; shown : (m,) distances less nominal ones, m
    """
    lengths = shown + np.linalg.norm(places, axis=1)
    table = np.column_stack([-2 * places, 2 * lengths, np.ones(len(lengths))])
    table = table if with_zero else np.delete(table, 3, axis=1)
    scale = np.linalg.norm(table, axis=0)
    if not scale.all() or np.linalg.svd(table / scale, compute_uv=False)[-1] < _SOUND:
        return None
    solved = np.linalg.lstsq(table / scale, lengths**2 - np.sum(places**2, axis=1), rcond=None)[0] / scale
    return np.asarray(solved[:4], dtype=float)


def mirrored(case: Case, readings: Sequence[Reading], point: Array, index: int) -> list[Array]:
    """Return points (k,), each with one station of a set-up behind the plane that its points are nearest to.

    In the order of its stations; none where it has too few points, or nothing to move.
    """
    setup, images = case.description.setups[index], []
    seen_by = [reading for reading in readings if reading.setup == setup.name]
    if len(seen_by) < 4:
        return []
    places = tips(case, seen_by)
    middle = places.mean(axis=0)
    _, sizes, turn = np.linalg.svd(places - middle)
    normal = settled(sizes**2, turn.T)[:, -1]
    for columns, stated in zip(case.station_columns(index), setup.standing, strict=False):
        station = np.array(stated) + point[list(columns)]
        image = station - 2 * float((station - middle) @ normal) * normal
        found = point.copy()
        found[list(columns)] = image - np.array(stated)
        images.append(found)
    return images


def tips(case: Case, readings: Sequence[Reading]) -> Array:
    """Return the nominal tool points of readings in the workpiece frame, (m, 3), m."""
    return frames(case.description.machine, np.array([reading.pose for reading in readings])).tcp
