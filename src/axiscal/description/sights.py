"""What a tracker or tracer sees from its station: `range`, `sight` and `faces` of a set-up."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace

import numpy as np

from axiscal.description.campaign_schema import SetupTable
from axiscal.description.reachable import refuse_unreachable
from axiscal.description.vectors import unit_vector
from axiscal.document import shown
from axiscal.exceptions import DescriptionError
from axiscal.machine import Machine
from axiscal.measurement.charts.box import Box
from axiscal.measurement.charts.room import Room
from axiscal.measurement.charts.sight import Sight
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.units import parse_quantity

At = Callable[..., AbstractContextManager[None]]
"""Places failures at the keys of a set-up."""

_LOOKING = ("tracker", "tracer")
_KEYS = ("range", "sight", "faces")
_CONE = math.radians(60.0)
"""A corner cube is seen within so much of its axis, as makers state for theirs."""


def refuse_no_sight(table: SetupTable, at: At) -> None:
    """Raise DescriptionError for keys of what is seen in a set-up whose instrument does not look."""
    for key in _KEYS:
        if getattr(table, key) is not None and table.instrument not in _LOOKING:
            with at(key):
                raise DescriptionError(f"{key} belongs to a tracker or tracer", f"Take {key} out")


def seen(table: SetupTable, machine: Machine, at: At, setup: Setup) -> Setup:
    """Return a set-up that is read where its instrument sees the tool, as far as anything is said of it.

    Raises DescriptionError or UnitError.
    """
    refuse_no_sight(table, at)
    said = [key for key in _KEYS if getattr(table, key) is not None]
    if not said or not setup.standing:
        return setup
    spans = np.array([setup.span(machine.axes[k], k) for k in setup.moves])
    steps = tuple(setup.raster[k] for k in setup.moves)
    box = Box(Room.empty(machine), setup.moves, spans, np.array(setup.park), steps)
    chart = Sight(box, np.array(setup.standing), _range(table, at), _faces(table, at), _cone(table, at))
    setup = replace(setup, chart=chart)
    with at(said[0]):
        refuse_unreachable(machine, setup)
    return setup


def _range(table: SetupTable, at: At) -> tuple[float, float]:
    if table.range is None:
        return 0.0, math.inf
    with at("range"):
        ends = [parse_quantity(text, "length") for text in table.range]
        if len(ends) != 2 or not 0 <= ends[0] < ends[1]:
            raise DescriptionError(f"{shown(table.range)} is no range", 'Write the nearer end first: ["1 m", "8 m"]')
        return ends[0], ends[1]


def _faces(table: SetupTable, at: At) -> Array | None:
    if table.faces is None:
        if table.sight is not None:
            with at("sight"):
                what = "it is not said where the reflector looks that is seen within this angle"
                raise DescriptionError(what, 'Write faces = "z", or leave sight out where it turns to the station')
        return None
    with at("faces"):
        return np.array(unit_vector(table.faces))


def _cone(table: SetupTable, at: At) -> float:
    if table.sight is None:
        return _CONE
    with at("sight"):
        if not 0 < table.sight <= math.pi:
            raise DescriptionError("a sight is above 0 and at most 180 deg", 'Give one such as "60 deg"')
    return table.sight
