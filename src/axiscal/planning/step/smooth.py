"""Where a set-up can be read, as boxes over each of which what it sees is one polynomial, to rounding.

A coordinate is an axis that moves, or one of a chart. Rows are polynomials between knots and edges of visited cells.
Along an axis that turns, and along a chart, sines take part: a polynomial of a higher degree follows them to rounding
over pieces that are short enough. On a chart knots of the axes lie on curves. So one coordinate of it may be free; the
others need steps, and each of their values has pieces of its own.
"""

from __future__ import annotations

from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from axiscal.exceptions import PlanError
from axiscal.language.spoken import later
from axiscal.measurement.candidates import smoothness_along
from axiscal.measurement.instrument import values_of
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array
from axiscal.numerics.bernstein import misfit, patches
from axiscal.numerics.chebyshev import node_count
from axiscal.planning.step.ground import Ground, ground_of

_AXES, _ON_CHART = 3, 1
"""Axes that move together, and coordinates of a chart without steps, up to which boxes are cut till a gap is closed."""
_PLACES = 5_000_000
"""Places from which polynomials are found: of time."""
_PARTS, _DEGREE = 72, 12
"""Pieces of a chart's coordinate are no longer than a part of it, 5 deg of a turn; rows have four harmonics at most,
and cubics: their squares are polynomials of this degree to rounding."""
_EXACT = 1e-8
"""Rounding of a polynomial of degree 18, with room; a wrong degree is off by thousandths."""
_LOOKS = 16
"""Boxes at which it is compared with the rows; what is no polynomial shows in almost all."""
_REMEDY = later("Leave --prove out, then the bound holds for the candidates")


class Region(NamedTuple):
    """Boxes of places that are come to from the same sides.

    low, high : (b, size) u, the same where a coordinate has steps; sides : (size,)
    degree : (size,) of the square of what a reading sees, along each coordinate
    """

    ground: Ground
    sides: Array
    low: Array
    high: Array
    degree: tuple[int, ...]

    def readings(self, places: Array) -> tuple[Array, Array]:
        """Return poses and approaches, (m, q) each.  places : (m, size) u"""
        return self.ground.readings(places, np.tile(self.sides, (len(places), 1)))


def regions(observation: Observation, setup: int) -> list[Region]:
    """Return the boxes of a set-up, for all sides that differ in what is seen.

    Raises PlanError where they are too many, or what is seen is no polynomial in them.
    """
    mounted, ground = observation.setups[setup], ground_of(observation, setup)
    charted, most = mounted.chart is not None, _AXES if mounted.chart is None else _ON_CHART
    free = ground.continuous if charted else list(range(len(ground.ends)))
    if len(free) > most:
        what = 'no proof for readings anywhere: "{setup}" has {count} coordinates without steps, more than {most}'
        raise PlanError(what, _REMEDY, setup=mounted.name, count=len(free), most=most)
    degree = tuple(_degree(observation, setup, k) if k in free else 0 for k in range(len(ground.ends)))
    found = [Region(ground, sides, *_boxes(ground, sides, free, charted), degree) for sides in ground.choices]
    found = [region for region in found if len(region.low)]
    if sum(len(region.low) for region in found) * np.prod(np.array(degree) + 1.0) > _PLACES:
        what = 'no proof for readings anywhere: "{setup}" has too many knots along its axes together'
        raise PlanError(what, _REMEDY, setup=mounted.name)
    if not all(_follows(observation, setup, region) for region in found):
        what = 'no proof for readings anywhere: what "{setup}" sees is no polynomial of where it is'
        raise PlanError(what, _REMEDY, setup=mounted.name)
    return found


def _degree(observation: Observation, setup: int, number: int) -> int:
    mounted = observation.setups[setup]
    if mounted.chart is not None:
        return _DEGREE
    (degree, phase), times = smoothness_along(observation, mounted.moves[number], setup), values_of(mounted)
    return node_count(degree // times, phase / times) - 1


def _boxes(ground: Ground, sides: Array, free: list[int], charted: bool) -> tuple[Array, Array]:
    """Return the ends of boxes that can be taken, (b, size) each."""
    size, cut = len(ground.ends), np.diff(ground.ends).ravel() / _PARTS
    values = [ground.ends[k, :1] if k in free else ground.looks(k) for k in range(size)]
    low, high = [np.zeros((0, size))], [np.zeros((0, size))]
    for place in map(np.array, product(*values)):
        each = [ground.pieces(k, place, sides) if k in free else place[[[k, k]]] for k in range(size)]
        if charted:
            each = [_parts(ends, cut[k]) if k in free else ends for k, ends in enumerate(each)]
        if not free and not np.all(ground.taken(place[None], sides[None])):
            continue
        for into, end in ((low, 0), (high, 1)):
            grids = np.meshgrid(*(ends[:, end] for ends in each), indexing="ij")
            into.append(np.stack([grid.ravel() for grid in grids], axis=1))
    return np.concatenate(low), np.concatenate(high)


def _parts(pieces: Array, longest: float) -> Array:
    """Return pieces (b, 2) cut into even parts no longer than this."""
    counts = [1 + int(np.ceil((right - left) / longest)) for left, right in pieces]
    cut = [np.linspace(float(left), float(right), n) for (left, right), n in zip(pieces, counts, strict=True)]
    return np.array([part for at in cut for part in pairwise(at)]).reshape(-1, 2)


def _follows(observation: Observation, setup: int, region: Region) -> bool:
    """Return whether polynomials are the squares of what readings see."""

    def forms(places: Array) -> tuple[Array, Array]:
        seen = observation.numbers(setup, *region.readings(places)).rows
        return np.sum(seen**2, axis=(1, 2)), np.ones(len(places))

    few = np.unique(np.linspace(0, len(region.low) - 1, _LOOKS).astype(np.intp))
    return misfit(forms, patches(forms, region.low[few], region.high[few], region.degree)) < _EXACT
