"""What is believed of an error before the first reading: its knots, and a covariance of the control values."""

from __future__ import annotations

import numpy as np

from axiscal.machine.axis import Axis
from axiscal.machine.entry import JOINT, KNOTS_PER_WAVE, ErrorEntry
from axiscal.numerics import Array
from axiscal.numerics.repeated import Segments
from axiscal_core.splines import Constant, CyclicSpline, NaturalSpline, Repeated, Spline, distances, matern, ramp


def basis(entry: ErrorEntry, axis: Axis) -> Spline:
    """Return the spline of an error over the travel of its axis: a constant, cyclic for a full turn, else natural.

    A wave has a cyclic one over each period; steps have levels between their joints.
    """
    if entry.constant:
        return Constant(*axis.travel)
    if entry.harmonics and entry.period is not None:
        return Repeated(*axis.travel, entry.period, KNOTS_PER_WAVE * entry.harmonics)
    if entry.joints:
        return Segments(*axis.travel, entry.joints, JOINT)
    knots = np.array(entry.knot_positions(axis))
    return CyclicSpline(knots) if axis.cyclic else NaturalSpline(knots)


def covariance(entry: ErrorEntry, spline: Spline) -> Array:
    """Return the prior covariance of the control values, (size, size).

    Independent control points (B&H eq. 16) without a correlation length, else Matérn-5/2 or -3/2 at the knots. On a
    cyclic spline the distance is the chord of the circle, which keeps the kernel positive definite. In a wave, cosine
    and sine of k turns a period have s²/k², k = 1…K. Each step has s², the mean level of steps none. A scale adds the
    coordinate times one unknown.
    """
    if entry.harmonics:
        turns = 2 * np.pi * np.arange(spline.size) / spline.size
        each = [np.cos(k * (turns[:, None] - turns)) / k**2 for k in range(1, entry.harmonics + 1)]
        waves: Array = entry.std**2 * np.sum(each, axis=0)
        return waves
    if entry.joints:
        level = np.tri(spline.size, spline.size, -1)[:, :-1]
        centred = level - level.mean(axis=0)
        steps: Array = entry.std**2 * centred @ centred.T
        return steps
    if entry.length is None or spline.size == 1:
        curve = np.eye(spline.size)
    else:
        curve = matern(distances(spline) / entry.length, entry.smoothness)
    along = (entry.scale or 0.0) * ramp(spline)
    return entry.std**2 * curve + np.outer(along, along)
