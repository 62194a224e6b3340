"""The coordinates of an axis at which the rows of a set-up are not smooth, and how smooth they are in between."""

from __future__ import annotations

import numpy as np

from axiscal.errors.plane import PlaneError
from axiscal.measurement.instrument import values_of
from axiscal.measurement.observation import Observation
from axiscal.measurement.way import feet
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered

_COINCIDE = 1e-12
"""Knots and edges of cells so close together, in lengths of travel, are one: they differ by rounding."""


@remembered
def breaks_along(observation: Observation, axis: int, setup: int) -> Array:
    """Return the coordinates between which a set-up's rows are smooth along an axis: knots, edges of visited cells.

    An instrument on feet meets them at each foot, which is aside of its position.
    """
    edges = _knots(observation, axis)
    for index, cell in observation.cells:
        term = observation.errors.terms[index]
        if isinstance(term, PlaneError):
            edges += term.edges(cell, axis)
        elif term.axis == axis:
            edges.append(term.edges(cell))
    return _between(observation, axis, setup, edges)


def knots_along(observation: Observation, axis: int, setup: int) -> Array:
    """Return the same without the edges of cells."""
    return _between(observation, axis, setup, _knots(observation, axis))


@remembered
def smoothness_along(observation: Observation, axis: int, setup: int) -> tuple[int, float]:
    """Return polynomial degree and phase (rad) of the gain's forms on one interval of an axis.

    Rows are cubic; a lever arm adds one degree along a linear axis, and sine and cosine along a rotary one. Forms
    are squares, and products of as many as a reading has numbers.
    """
    times = values_of(observation.setups[setup])
    if not observation.machine.axes[axis].rotary:
        angular = any(f.angular for f in observation.errors.terms)
        return times * (8 if angular else 6), 0.0
    return 6 * times, 2 * times * float(np.max(np.diff(breaks_along(observation, axis, setup))))


def _knots(observation: Observation, axis: int) -> list[Array]:
    own = [f.basis.knots for f in observation.errors.functions if f.axis == axis]
    return own + [knots for plane in observation.errors.planes for knots in plane.knots_along(axis)]


def _between(observation: Observation, axis: int, setup: int, edges: list[Array]) -> Array:
    """Return the edges as they meet a set-up's feet, sorted, within where it can be read, with the ends of that."""
    mounted, shifts = observation.setups[setup], np.zeros(1)
    low, high = mounted.span(observation.machine.axes[axis], axis)
    if mounted.base and axis in mounted.moves:
        shifts = np.array([foot.shift for foot in feet(mounted.base)])
    everywhere = np.unique(np.concatenate([np.zeros(0), *edges])[:, None] - shifts)
    shortest = _COINCIDE * (high - low)
    inside = everywhere[(everywhere > low + shortest) & (everywhere < high - shortest)]
    apart = np.diff(inside, prepend=low) > shortest
    return np.concatenate([[low], inside[apart], [high]])
