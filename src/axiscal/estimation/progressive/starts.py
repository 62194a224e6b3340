"""Where a station may stand, in closed form, and where its mirror image does.

n = |p − s| + z squared is linear in s, z and |s|² − z²:  −2 pᵀs + 2 n z + (|s|² − z²) = n² − |p|². Five points that
are not in a plane settle it. Seen from points in one plane, a station and its mirror image in that plane are alike.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.estimation.case import Case
from axiscal.machine.kinematics import frames
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

_SOUND = 1e-6
"""Share of the largest singular value below which points are as good as in a plane."""


def closed_form(case: Case, readings: Sequence[Reading], point: Array) -> Array:
    """Return a point (k,) with stations and dead paths of distances where they alone fit the readings best.

    Those of too few points, or of points in a plane, stay.
    """
    found = point.copy()
    for index, setup in enumerate(case.description.setups):
        columns, seen_by = case.station_columns(index), [r for r in readings if r.setup == setup.name]
        if columns is None or setup.station is None or len(seen_by) < 6:
            continue
        own = dict(zip((u.name for u in setup.unknowns), case.observation.unknowns_of(index).tolist(), strict=True))
        stated = np.array(setup.station)
        places = tips(case, seen_by) - stated
        lengths = np.array([reading.value for reading in seen_by]) + np.linalg.norm(places, axis=1)
        table = np.column_stack([-2 * places, 2 * lengths, np.ones(len(lengths))])
        table = table if "zero" in own else np.delete(table, 3, axis=1)
        scale = np.linalg.norm(table, axis=0)
        if np.linalg.svd(table / scale, compute_uv=False)[-1] < _SOUND:
            continue
        solved = np.linalg.lstsq(table / scale, lengths**2 - np.sum(places**2, axis=1), rcond=None)[0] / scale
        found[list(columns)] = solved[:3]
        if "zero" in own:
            found[own["zero"]] = solved[3]
    return found


def mirrored(case: Case, readings: Sequence[Reading], point: Array, index: int) -> Array | None:
    """Return a point (k,) with the station of one set-up behind the plane that its points are nearest to.

    None where it has too few points, or nothing to move.
    """
    setup = case.description.setups[index]
    columns, seen_by = case.station_columns(index), [r for r in readings if r.setup == setup.name]
    if columns is None or setup.station is None or len(seen_by) < 4:
        return None
    places = tips(case, seen_by)
    middle = places.mean(axis=0)
    normal = np.linalg.svd(places - middle)[2][-1]
    station = np.array(setup.station) + point[list(columns)]
    image = station - 2 * float((station - middle) @ normal) * normal
    found = point.copy()
    found[list(columns)] = image - np.array(setup.station)
    return found


def tips(case: Case, readings: Sequence[Reading]) -> Array:
    """Return the nominal tool points of readings in the workpiece frame, (m, 3), m."""
    return frames(case.description.machine, np.array([reading.pose for reading in readings])).tcp
