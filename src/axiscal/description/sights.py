"""Where trackers and tracers stand and what they see: `stations`, `range`, `sight` and `faces` of a set-up."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from axiscal.description.campaign_schema import SetupTable
from axiscal.description.reachable import refuse_unreachable
from axiscal.description.vectors import At
from axiscal.document import shown
from axiscal.exceptions import DescriptionError
from axiscal.machine import Machine
from axiscal.measurement.charts.box import Sight
from axiscal.measurement.charts.room import Room
from axiscal.measurement.instrument import Instrument
from axiscal.measurement.instruments.distance import MOST
from axiscal.measurement.setup import Setup, Vector
from axiscal.numerics import Array
from axiscal.units import parse_quantity

Lack = tuple[str, str]
"""What is not said, and what to add."""

_ONE_LINE = ("interferometer", "autocollimator")
_AT_BALL = 'Write artefact = "..." and [[artefacts]] with its place'
_LINE = "along = [...] with the two ends of a line"

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
    """Return a set-up that is read where its instrument sees the tool, as far as its table states that.

    Raises DescriptionError or UnitError.
    """
    refuse_no_sight(table, at)
    said = [key for key in _KEYS if getattr(table, key) is not None]
    if not said or not setup.standing:
        return setup
    spans = np.array([setup.span(machine.axes[k], k) for k in setup.moves])
    steps = tuple(setup.raster[k] for k in setup.moves)
    chart = Sight(
        Room.empty(machine),
        setup.moves,
        spans,
        np.array(setup.park),
        steps,
        np.array(setup.standing),
        _range(table, at),
        _faces(table, at),
        _CONE if table.sight is None else table.sight,
    )
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
    return np.array(table.faces)


def stations_of(table: SetupTable, usual: Instrument) -> tuple[Vector, ...]:
    """Return where tracers stand that read at once; none where one instrument reads.  Raises DescriptionError."""
    said = table.stations
    if said is None:
        return ()
    if usual.name != "tracer":
        what = f"several stations are read at once by length-only tracers, and this set-up has a {usual.name}"
        raise DescriptionError(what, 'Write instrument = "tracer", or a set-up for each of the others')
    if table.station is not None:
        what = "it is said twice where it stands, by station and by stations"
        raise DescriptionError(what, "Keep station for one tracer, stations for those that read at once")
    if not 2 <= len(said) <= MOST:
        what = f"{len(said)} {'station' if len(said) == 1 else 'stations'} cannot be read at once here"
        raise DescriptionError(what, f"Name two to {MOST}; one alone is station, more are set-ups of their own")
    if len(set(said)) < len(said):
        raise DescriptionError("two of the stations are the same place", "Give each tracer its own")
    return tuple(said)


def lack_of(setup: Setup, machine: Machine, reached: Collection[str], chosen: bool) -> Lack | None:
    """Return what a set-up does not say of where it can be read; None where it says enough.

    reached : names of the axes whose reach is stated; chosen : the axes that move are named, not all by default
    """
    if setup.chart is not None or setup.instrument in ("tracker", "tracer"):
        return None
    if setup.instrument in ("rtest", "sphere", "ballbar"):
        return _without_place(setup)
    moving = [machine.axes[k].name for k in setup.moves]
    unreached = [name for name in moving if name not in reached]
    if setup.instrument in ("straightedge", "probe"):
        return _without_reach(setup, unreached) if unreached else None
    if len(moving) == 1 or (setup.instrument not in _ONE_LINE and (chosen or not unreached)):
        return None
    return _of_many_axes(setup, moving)


def _without_place(setup: Setup) -> Lack:
    if setup.instrument == "ballbar":
        what = f'a ball bar reads at its own length from a centre, and "{setup.name}" does not state it'
        return what, 'Write length = "150 mm", and station or artefact for the centre'
    named = "an R-test" if setup.instrument == "rtest" else "a sphere probe"
    return f'{named} reads at a ball, and the set-up "{setup.name}" names none', _AT_BALL


def _of_many_axes(setup: Setup, moving: Sequence[str]) -> Lack:
    article = "an" if setup.instrument[0] in "aei" else "a"
    what = f'{article} {setup.instrument} follows one axis or one line: in "{setup.name}" {" ".join(moving)} may move'
    return what, f'Write moves = ["{moving[0] if moving else "X"}"], or {_LINE}'


def _without_reach(setup: Setup, axes: Sequence[str]) -> Lack:
    what = f'it is not said where along {" ".join(axes)} the {setup.instrument} of "{setup.name}" touches'
    remedy = 'Name the axis in moves, and where its reference reaches: reach = { X = ["150 mm", "450 mm"] }'
    return what, f"{remedy}; or {_LINE}" + ("; or an artefact with its balls" if setup.instrument == "probe" else "")
