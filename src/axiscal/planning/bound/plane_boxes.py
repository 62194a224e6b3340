"""The largest |Z b|² of a set-up that moves two linear axes, enclosed: where errors do not add up axis by axis.

Errors of two axes, and lever arms that both lengthen, make Z b(x, y) a polynomial of both coordinates between knots.
|Z b|² is then one of degree 6 in each, 8 with lever arms, and boxes with its Bernstein coefficients enclose it
(`numerics.bernstein_plane`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.measurement.free_plane import EXACT, on_free_plane, plane_pieces, plane_poses
from axiscal.measurement.observation import Observation, directions_of
from axiscal.numerics import Array
from axiscal.numerics.bernstein_plane import PlaneForms, largest_ratio, misfit

_PARTS = 3
"""Places looked at in each knot interval along each axis: a curve between knots has no more hills than that."""
_FINER, _ROUNDS = 3.0, 8
"""Hills are climbed on grids of three by three, each so much finer: in the end to a thousandth of a knot interval."""


class Tops(NamedTuple):
    """No |Z b|² is above upper; places (m, 2) are hills, the highest first, lengths (m,) |Z b|² there."""

    upper: float
    places: Array
    lengths: Array


def planar(observation: Observation, setup: int) -> bool:
    """Return whether a set-up reads one number all over two linear axes, by polynomials of both between knots."""
    mounted = observation.setups[setup]
    if not on_free_plane(observation, setup):
        return False
    side = np.array([1.0 if axis in mounted.moves else 0.0 for axis in range(len(observation.machine.axes))])
    forms = _forms(observation, setup, side, np.eye(observation.size))
    return misfit(forms, *plane_pieces(observation, setup)) < EXACT


def largest_on_plane(observation: Observation, setup: int, side: Array, reach: Array, level: float, boxes: int) -> Tops:
    """Enclose the largest |g reach|² of readings of a set-up from one side; what is not above a level is not followed.

    reach : (n, w) per unit of noise; boxes : how many to look at; what is then still open counts with its upper bound
    """
    forms, (breaks, degree) = _forms(observation, setup, side, reach), plane_pieces(observation, setup)
    places, lengths = _hills(forms, breaks)
    known = max(level, float(lengths.max(initial=0.0)))
    found = largest_ratio(forms, breaks, degree, known, boxes)
    if found.lower > known:
        places, lengths = np.vstack([found.place, places]), np.append(found.lower, lengths)
    return Tops(found.upper, places, lengths)


def _forms(observation: Observation, setup: int, side: Array, reach: Array) -> PlaneForms:
    """Return |g reach|², over one, as a function of places (m, 2)."""
    mounted = observation.setups[setup]
    (way,) = directions_of(mounted)

    def forms(places: Array) -> tuple[Array, Array]:
        poses = plane_poses(mounted, places)
        rows = observation.rows(setup, poses, np.tile(side, (len(poses), 1)), way).rows
        return np.sum((rows @ reach) ** 2, axis=1), np.ones(len(places))

    return forms


def _hills(forms: PlaneForms, breaks: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return the hills of a fine grid, climbed, the highest first: places (m, 2), lengths (m,)."""
    lines = [np.unique(np.linspace(at[:-1], at[1:], _PARTS + 1).ravel()) for at in breaks]
    grid = np.stack([each.ravel() for each in np.meshgrid(*lines, indexing="ij")], axis=1)
    heights = forms(grid)[0].reshape(len(lines[0]), len(lines[1]))
    around = np.pad(heights, 1, constant_values=-np.inf)
    shifts = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    beside = np.max([around[i : i + heights.shape[0], j : j + heights.shape[1]] for i, j in shifts], axis=0)
    places = grid[(heights >= beside).ravel()]
    low, high = (np.array([line[end] for line in lines]) for end in (0, -1))
    step = np.array([float(np.max(np.diff(line))) for line in lines])
    moves = np.stack([each.ravel() for each in np.meshgrid([0, -1, 1], [0, -1, 1], indexing="ij")], axis=1)
    for _ in range(_ROUNDS):
        step = step / _FINER
        tried = np.clip(places[:, None] + moves * step, low, high)
        best = forms(tried.reshape(-1, 2))[0].reshape(len(places), -1).argmax(axis=1)
        places = tried[np.arange(len(places)), best]
    lengths = forms(places)[0]
    order = np.argsort(-lengths, kind="stable")
    return places[order], lengths[order]
