"""What a calibration costs: seconds of machine time for mounting, travel, settling and reading."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.description import Machine
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import way_seconds
from axiscal.numerics import Array
from axiscal.numerics.short_way import route

_ROUNDS = 8
"""Orders that are sought, of time; the shortest of them is taken."""
_SAME = 1e-9
"""s; rounding."""


def reading_seconds(setup: Setup) -> float:
    """Return what one reading takes beside the way to it."""
    return setup.settle + setup.reading_time


def first_seconds(setup: Setup) -> float:
    """Return what the first reading of a set-up takes, with mounting it."""
    return setup.setup_time + reading_seconds(setup)


def short_way(
    machine: Machine, setup: Setup, poses: Array, approaches: Array, first: Array | None = None, *, exact: bool = False
) -> tuple[NDArray[np.intp], Array]:
    """Return an order of poses of a set-up, (m,), and the seconds from each to the next, overrun included, (m - 1,).

    approaches : (m, q), 0 where any side will do; first : (m,) seconds to each from where the machine stands
    exact : ways in touch that lead round, or off and back, count as what they take; else every way as if straight
    The ways of an order are looked at, what they take is put in, and an order is sought anew until all are known.
    """
    table = way_seconds(machine, setup, poses[:, None], poses[None], approaches[None], straight=True)
    best, least = np.zeros(0, dtype=np.intp), np.inf
    for _ in range(_ROUNDS if exact and setup.contact == "held" else 1):
        order = route(table, first)
        here, there = order[:-1], order[1:]
        thought = table[here, there]
        if exact:
            table[here, there] = way_seconds(machine, setup, poses[here], poses[there], approaches[there])
        seconds = float(table[here, there].sum()) + (0.0 if first is None or not len(order) else float(first[order[0]]))
        if not len(best) or seconds < least:
            best, least = order, seconds
        if np.allclose(table[here, there], thought, rtol=0.0, atol=_SAME):
            break
    return best, table[best[:-1], best[1:]]
