"""Candidates for a reading: poses spread evenly over what the set-ups allow, with the directions of approach.

The coordinates of an axis at which the rows of a set-up are not smooth.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.volume import Box
from axiscal.measurement.charts.room import Chart, Coordinate, arrivals, has_room
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import SHORTEST
from axiscal.numerics import Array, even_subset
from axiscal.numerics.remembered import remembered
from axiscal_core.machine import Machine
from axiscal_core.points import distinct_between, even_points


@remembered
def breaks_along(observation: Observation, axis: int, setup: int) -> Array:
    """Return the coordinates between which a set-up's rows are smooth along an axis: knots.

    An instrument on feet meets them at each foot, which is aside of its position.
    """
    mounted = observation.setups[setup]
    low, high = mounted.span(observation.machine.axes[axis], axis)
    stepped = mounted.base is not None and axis in mounted.moves
    half = max(mounted.base or 0.0, SHORTEST) / 2 if stepped else 0.0
    knots = np.concatenate([np.zeros(0), *observation.errors.knots_along(axis)])
    return distinct_between(np.concatenate([[low, high], knots - half, knots + half]), low, high)


MOST_TRIED = 20_000
"""Places tried where few can be taken: of time; the places that are found are spread evenly all the same."""
FEWEST = 20
"""Places at least that a chart is asked for, so that the best step has where to begin."""
_WHOLE, _MANY = 4, 200
"""Where so many are asked for, a raster of up to so many times as many is taken whole."""


def spread(machine: Machine, setups: tuple[Setup, ...], count: int) -> Places:
    """Return about `count` candidates, shared evenly between the set-ups."""
    each = max(2, count // max(1, len(setups)))
    return Places.joined([Places.of_setup(i, *_of_setup(machine, setup, each)) for i, setup in enumerate(setups)])


_SEED = 2
"""Any: the same machine has the same plan."""
_DIGITS = 9
"""Decimals of m or rad: rounding of a place."""


def distinct(candidates: Places) -> Places:
    """Return one of the candidates at each place of a set-up, its side drawn at random; in any order."""
    mixed = candidates.within(np.random.default_rng(_SEED).permutation(len(candidates)))
    _, first = np.unique(np.round(np.column_stack([mixed.setups, mixed.poses]), _DIGITS), axis=0, return_index=True)
    return mixed.within(first)


def drawn_places(candidates: Places, among: NDArray[np.intp], count: int, turn: int = 0) -> Places:
    """Return `count` candidates drawn at random, fewer where there are fewer.

    among : (n,) set-ups of readings, by which they are shared; turn : another one draws others
    """
    rng, found = np.random.default_rng([_SEED, turn]), [candidates.within(slice(0, 0))]
    shares = np.sort(among)[(np.arange(count) * len(among) + len(among) // 2) // max(count, 1)]
    for setup in dict.fromkeys(shares.tolist()):
        mine = np.flatnonzero(candidates.setups == setup)
        found.append(candidates.within(rng.permutation(mine)[: int(np.sum(shares == setup))]))
    return Places.joined(found)


def _of_setup(machine: Machine, setup: Setup, count: int) -> tuple[Array, Array]:
    if setup.chart is not None:
        return chart_candidates(machine, setup, setup.chart, count)
    moves = list(setup.moves)
    unit = even_points(count, 2 * len(moves))
    poses = np.tile(np.array(setup.park), (count, 1))
    low, high = np.array([each[:2] for each in setup.coordinates]).reshape(-1, 2).T
    span = high - low
    poses[:, moves] = low + span * unit[:, : len(moves)] if len(moves) > 1 else low + span * even_points(count, 1)
    approaches = np.zeros_like(poses)
    approaches[:, moves] = np.where(unit[:, len(moves) :] > 0.5, setup.sides[0], setup.sides[-1])
    return snapped(setup, poses), approaches


def snapped(setup: Setup, poses: Array) -> Array:
    """Return poses (m, q) moved to the nearest multiples of the set-up's raster that lie in the travel."""
    result = poses.copy()
    for k, end in zip(setup.moves, setup.coordinates, strict=True):
        if end.step > 0:
            result[:, k] = np.clip(np.round(poses[:, k] / end.step) * end.step, *end.values[[0, -1]])
    return result


def corners(box: Box) -> Array:
    """Return the corners of a box of poses, (2^q, q)."""
    return np.stack([g.ravel() for g in np.meshgrid(*box, indexing="ij")], axis=1)


Chosen = tuple[Array, Array]
"""Places on a chart, and the sides from which they are come to, +1 or −1, (m, size) each."""


def chart_candidates(machine: Machine, setup: Setup, chart: Chart, count: int) -> tuple[Array, Array]:
    """Return poses and approaches (m, q) of about so many candidates; fewer where fewer can be taken."""
    places, sides = chart_places(machine, setup, chart, count)
    return chart.poses(places), setup.coming(arrivals(chart, places, sides))


def chart_places(machine: Machine, setup: Setup, chart: Chart, count: int) -> Chosen:
    """Return about so many places of a chart that can be taken, and sides; fewer where fewer can be."""
    choices = chart_sides(machine, setup, chart)
    if all(end.step > 0 for end in chart.coordinates):
        return _thinned(
            _raster(chart, *map(tuple, choices.tolist())), _WHOLE * count if count >= _MANY else count, count
        )
    return _even(chart, choices, count)


def chart_sides(machine: Machine, setup: Setup, chart: Chart) -> Array:
    """Return the sides from which places of a set-up are come to and that differ in what is seen, (choices, size).

    A side shows where a coordinate moves an axis that has a reversal value; other coordinates come from above.
    """
    if setup.approach != "both":
        return np.full((1, len(chart.coordinates)), float(setup.sides[0]))
    reversals = {entry.name for entry in machine.stated if entry.kind == "reversal"}
    reverses = [k for k, axis in enumerate(machine.axes) if f"{axis.positioning_error}_reversal" in reversals]
    shown = [k for k in reverses if machine.axes[k].rotary or not setup.mean_sides]
    middle = np.array([[(each.low + each.high) / 2 for each in chart.coordinates]])
    choices = list[tuple[float, ...]]()
    for number, each in enumerate(chart.coordinates):
        aside = middle + np.eye(middle.size)[number] * (each.overrun or 1.0)
        moved = np.abs(chart.poses(aside) - chart.poses(middle))[0]
        choices.append((1.0, -1.0) if each.overrun > 0 and np.any(moved[shown] > 0) else (1.0,))
    return np.array(list(product(*choices)))


@remembered
def _raster(chart: Chart, *choices: tuple[float, ...]) -> Chosen:
    values = [each.values for each in chart.coordinates]
    grid = np.stack([g.ravel() for g in np.meshgrid(*values, indexing="ij")], axis=1) if values else np.zeros((1, 0))
    return _taken(chart, np.repeat(grid, len(choices), axis=0), np.tile(np.array(choices), (len(grid), 1)))


def _even(chart: Chart, choices: Array, count: int) -> Chosen:
    """Return so many places that can be taken, spread evenly; out of MOST_TRIED at the most."""
    ends, tried = chart.coordinates, count
    while True:
        unit = even_points(tried, len(ends) + 1)
        shares = unit[:, : len(ends)] if len(ends) > 1 else even_points(tried, 1)
        places = np.column_stack([_placed(end, share) for end, share in zip(ends, shares.T, strict=True)])
        which = (unit[:, -1] * len(choices)).astype(np.intp)
        found = _taken(chart, places, choices[which])
        if len(found[0]) >= count or tried >= MOST_TRIED:
            return _thinned(found, count, count)
        tried = min(2 * tried, MOST_TRIED)


def _placed(end: Coordinate, share: Array) -> Array:
    if end.step > 0:
        values = end.values
        return values[np.minimum((share * len(values)).astype(np.intp), len(values) - 1)]
    dialled: Array = np.round((end.low + (end.high - end.low) * share) / end.finest) * end.finest
    return np.clip(dialled, end.low, end.high)


def _taken(chart: Chart, places: Array, sides: Array) -> Chosen:
    kept = has_room(chart, places, sides)
    return places[kept], sides[kept]


def _thinned(chosen: Chosen, most: int, count: int) -> Chosen:
    """Return all of them if they are not too many, else so many that stand for all."""
    places, sides = chosen
    if len(places) <= most:
        return chosen
    kept = np.sort(even_subset(np.hstack([places, sides]), count))
    return places[kept], sides[kept]
