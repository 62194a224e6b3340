"""Few readings of a map, planned or on an even grid, and what is made of them at all its nodes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded, estimated
from axiscal.measurement.reading import Place, Reading
from axiscal.numerics import Array
from axiscal.planning.next_readings import next_places
from axiscal.planning.promise import plan_basis
from axiscal.units import to_unit
from benchmarks.planes.maps import Plane

_BAND = 1.96
_WAY_OFF = 0.3
"""What a grid costs that leaves a reading over, against a cell that is not square; a matter of taste."""


class Outcome(NamedTuple):
    """missed : RMS of truth less estimate over all nodes, um; held : share of the unread nodes in the 95 % band."""

    missed: float
    held: float


def outcome(plane: Plane, count: int, planned: bool, together: bool) -> Outcome:
    """Return what so many readings make of a map.  together : with the error of both axes, or with two curves only"""
    campaign, machine = plane.texts(count, together)
    case = Case(campaign_from_texts(campaign, "campaign.toml", machine, "map"))
    read = _planned(plane, case, count) if planned else even_grid(plane, count)
    known = concluded(case, [_reading(plane, node) for node in read]).printed
    poses = plane.nodes
    seen = known.observation.rows(0, poses, np.ones_like(poses))
    loose = seen.variances - known.observation.setups[0].noise ** 2
    missed = plane.heights - seen.rows @ known.belief.mean
    std = np.sqrt(np.sum((seen.rows @ known.belief.factor) ** 2, axis=1) + loose)
    unread = np.ones(len(poses), dtype=bool)
    unread[read] = False
    held = float(np.mean((np.abs(missed) <= _BAND * std)[unread]))
    return Outcome(to_unit(float(np.sqrt(np.mean(missed**2))), "um"), held)


def _reading(plane: Plane, node: int) -> Reading:
    x, y = plane.nodes[node].tolist()
    return Reading("probe", (x, y), (1, 1), float(plane.heights[node]))


def _planned(plane: Plane, case: Case, count: int) -> list[int]:
    """Return the nodes that a campaign reads: it plans anew when sizes were learnt, or a reading is doubted."""
    nodes, known, coming, basis = list[int](), estimated(case, ()), list[Place](), None
    while len(nodes) < count:
        now = plan_basis(known.case, known.readings, known.outliers)
        if now != basis or not coming:
            coming = list(next_places(known.case, known.knowledge, known.readings, known.outliers, (), coming))
            basis = now
        nodes.append(plane.nearest(np.array(coming.pop(0).pose)))
        known = estimated(case, [_reading(plane, node) for node in nodes])
    return nodes


def even_grid(plane: Plane, count: int) -> list[int]:
    """Return the nodes nearest to an even grid of about square cells, and to its largest gaps where places are left."""
    columns, rows = min(_grids(count), key=lambda grid: _unevenness(plane.span, grid, count))
    lines = (np.linspace(0, side, number) for side, number in zip(plane.span, (columns, rows), strict=True))
    found = list[int]()
    for place in np.column_stack([each.ravel() for each in np.meshgrid(*lines)]):
        order = np.argsort(np.sum(((plane.nodes - place) / plane.span) ** 2, axis=1), kind="stable")
        found.append(next(int(node) for node in order if node not in found))
    while len(found) < count:
        away = [np.sum(((plane.nodes - plane.nodes[node]) / plane.span) ** 2, axis=1) for node in found]
        found.append(int(np.min(away, axis=0).argmax()))
    return found


def _grids(count: int) -> list[tuple[int, int]]:
    pairs = [(columns, round(count / columns)) for columns in range(2, count + 1)]
    return [(columns, rows) for columns, rows in pairs if rows >= 2 and columns * rows <= count]


def _unevenness(span: Array, grid: tuple[int, int], count: int) -> float:
    columns, rows = grid
    cell = span[0] / (columns - 1) * (rows - 1) / span[1]
    return float(abs(np.log(cell))) + _WAY_OFF * (count - columns * rows)
