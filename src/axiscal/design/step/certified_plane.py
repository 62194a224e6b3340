"""The next position in a plane, certified: no place on the continuum of two linear axes gains noticeably more.

Between knots, and edges of cells that were visited, N = gᵀCWCg and D = σ² + gᵀCg are polynomials of both coordinates,
of degree 6 in each and 8 where lever arms grow with it (method of B&H eq. 27, in two coordinates at once).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.design.gains.gain import Scorer
from axiscal.design.step.starts_with_levers import sides
from axiscal.exceptions import PlanError
from axiscal.measurement.free_plane import EXACT, on_free_plane, plane_pieces, plane_poses
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array
from axiscal.numerics.bernstein_plane import largest_ratio, misfit

_NONE = (
    "this set-up's readings are no polynomials of two coordinates",
    "Let it move two linear axes, without a raster, and read one number",
)


class CertifiedGain(NamedTuple):
    """The largest gain lies between lower, that at the pose (q,) from its side (q,), and upper.  boxes : looked at"""

    lower: float
    upper: float
    pose: Array
    approach: Array
    boxes: int


def certifiable(observation: Observation, setup: int) -> bool:
    """Return whether a set-up reads one number while two linear axes move, anywhere, its rows polynomials of both."""
    mounted = observation.setups[setup]
    return on_free_plane(observation, setup) and not any(mounted.raster[axis] > 0 for axis in mounted.moves)


def certified_gain(scorer: Scorer, setup: int, known: float = 0.0) -> CertifiedGain:
    """Enclose the largest gain of one reading of a set-up, wherever it is taken.

    known : a gain that some place reaches; raises PlanError where two linear axes do not move alone
    """
    if not certifiable(scorer.observation, setup):
        raise PlanError(*_NONE)
    found = [_from_side(scorer, setup, side, known) for side in sides(scorer.observation, setup)]
    best = max(found, key=lambda each: each.lower)
    upper, boxes = max(each.upper for each in found), sum(each.boxes for each in found)
    return best._replace(upper=upper, boxes=boxes)


def _from_side(scorer: Scorer, setup: int, side: Array, known: float) -> CertifiedGain:
    mounted = scorer.observation.setups[setup]

    def forms(places: Array) -> tuple[Array, Array]:
        poses = plane_poses(mounted, places)
        return scorer.forms(setup, poses, np.tile(side, (len(poses), 1)))

    breaks, degree = plane_pieces(scorer.observation, setup)
    if misfit(forms, breaks, degree) > EXACT:
        raise PlanError(*_NONE)
    found = largest_ratio(forms, breaks, degree, known)
    return CertifiedGain(found.lower, found.upper, plane_poses(mounted, found.place[None])[0], side, found.boxes)
