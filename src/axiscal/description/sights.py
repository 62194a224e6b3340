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
from axiscal.language.spoken import later, said
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
_LOOKING = ("tracker", "tracer")
_KEYS = ("range", "sight", "faces")
_CONE = math.radians(60.0)
"""A corner cube is seen within so much of its axis, as makers state for theirs."""


def refuse_no_sight(table: SetupTable, at: At) -> None:
    """Raise DescriptionError for keys of what is seen in a set-up whose instrument does not look."""
    for key in _KEYS:
        if getattr(table, key) is not None and table.instrument not in _LOOKING:
            with at(key):
                raise DescriptionError("{key} belongs to a tracker or tracer", "Take {key} out", key=key)


def refuse_stray_keys(table: SetupTable, at: At) -> None:
    """Raise DescriptionError for keys that exclude one another, or belong to what the set-up has not."""
    given = {key for key in ("along", "length", "artefact", "reach") if getattr(table, key)}
    for pair in ({"along", "length"}, {"along", "artefact"}, {"along", "reach"}, {"artefact", "reach"}):
        if pair <= given and table.instrument != "straightedge":
            first, second = sorted(pair)
            with at(second):
                what = "{first} and {second} exclude one another"
                raise DescriptionError(what, "Give one of them", first=first, second=second)
    if table.touches and (table.instrument != "sphere" or table.sides == "mean"):
        what = "three touches are those of a sphere, and meet no side and its opposite: there is no mean of both"
        with at("touches"):
            raise DescriptionError(what, "Take sides out, or touches")
    for key in ("at", "turn"):
        if getattr(table, key) is not None and table.artefact is None:
            with at(key):
                remedy = 'Give artefact = "board", too'
                raise DescriptionError("{key} belongs to an artefact, and the set-up has none", remedy, key=key)
    for key in ("plane", "arc", "turning", "stroke"):
        if getattr(table, key) is not None and table.length is None and table.instrument != "rtest":
            with at(key):
                remedy = "Give its length, too"
                raise DescriptionError("{key} belongs to a bar, and the set-up has none", remedy, key=key)


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
            remedy = 'Write the nearer end first: ["1 m", "8 m"]'
            raise DescriptionError("{text} is no range", remedy, text=shown(table.range))
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
        what = "several stations are read at once by length-only tracers, and this set-up has a {instrument}"
        remedy = 'Write instrument = "tracer", or a set-up for each of the others'
        raise DescriptionError(what, remedy, instrument=usual.name)
    if table.station is not None:
        what = "it is said twice where it stands, by station and by stations"
        raise DescriptionError(what, "Keep station for one tracer, stations for those that read at once")
    if not 2 <= len(said) <= MOST:
        what = (
            "{count} station cannot be read at once here"
            if len(said) == 1
            else "{count} stations cannot be read at once here"
        )
        remedy = "Name two to {most}; one alone is station, more are set-ups of their own"
        raise DescriptionError(what, remedy, count=len(said), most=MOST)
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
        what = 'a ball bar reads at its own length from a centre, and "{setup}" does not state it'
        remedy = 'write length = "150 mm", and station or artefact for the centre'
    elif setup.instrument == "rtest":
        what, remedy = 'an R-test reads at a ball, and the set-up "{setup}" names none', _AT_BALL
    else:
        what, remedy = 'a sphere probe reads at a ball, and the set-up "{setup}" names none', _AT_BALL
    return said(what, setup=setup.name), said(remedy)


_AT_BALL = later('write artefact = "..." and [[artefacts]] with its place')


def _of_many_axes(setup: Setup, moving: Sequence[str]) -> Lack:
    what = 'a {instrument} follows one axis or one line: in "{setup}" {axes} may move'
    if setup.instrument[0] in "aei":
        what = 'an {instrument} follows one axis or one line: in "{setup}" {axes} may move'
    remedy = 'write moves = ["{axis}"], or along = [...] with the two ends of a line'
    lack = said(what, instrument=setup.instrument, setup=setup.name, axes=" ".join(moving))
    return lack, said(remedy, axis=moving[0] if moving else "X")


def _without_reach(setup: Setup, axes: Sequence[str]) -> Lack:
    what = 'it is not said where along {axes} the {instrument} of "{setup}" touches'
    remedy = (
        'name the axis in moves, and where its reference reaches: reach = {{ X = ["150 mm", "450 mm"] }}; or {line}'
    )
    if setup.instrument == "probe":
        remedy = (
            'name the axis in moves, and where its reference reaches: reach = {{ X = ["150 mm", "450 mm"] }}; '
            "or {line}; or an artefact with its balls"
        )
    line = said("along = [...] with the two ends of a line")
    return said(what, axes=" ".join(axes), instrument=setup.instrument, setup=setup.name), said(remedy, line=line)
