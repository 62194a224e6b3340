"""Whether a set-up can be read where it says: within the travels, within the stroke, on which arc, and in sight.

Trackers and tracers say by `stations`, `range`, `sight` and `faces` where they stand and what they see.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from axiscal.description.artefacts import ArtefactTable
from axiscal.description.campaign_schema import SetupTable
from axiscal.document import Document
from axiscal.document.validation import Stated
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import later, listed, said
from axiscal.machine.kinematics import linear_axes
from axiscal.measurement.candidates import FEWEST, chart_candidates, chart_places
from axiscal.measurement.charts.kinds import FINEST_PLACE, Balls, Circle, Sight
from axiscal.measurement.charts.room import Chart, Room
from axiscal.measurement.instruments.displacement import Displacement, Straightedge
from axiscal.measurement.instruments.distance import Tracer
from axiscal.measurement.instruments.rotation import Rotation
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array, even_subset
from axiscal.units import format_quantity
from axiscal_core.machine import Machine
from axiscal_core.points import even_points

_LOOKED_AT = 1000
"""Places looked at: what lacks room does so at a good part of them."""
_STDS = 4.0
_STROKES = 100
"""Places at which the stroke is looked at."""
_FEWER = 2
"""A bar is set in the middle of its stroke: half of it is left either way."""


def refuse_unreachable(machine: Machine, setup: Setup) -> None:
    """Raise DescriptionError for a chart, or a ball of it, that no pose reaches from an allowed side."""
    chart = setup.chart
    each = chart.each() if isinstance(chart, Balls) else [] if chart is None else [chart]
    for number, part in enumerate(each):
        places, _ = chart_places(machine, setup, part, _LOOKED_AT)
        finite = all(each.step > 0 for each in part.coordinates)
        if len(places) >= (1 if finite else FEWEST):
            continue
        named = {"instrument": setup.instrument, "setup": setup.name}
        what = 'the {instrument} of "{setup}" sees the tool in no pose, or hardly any'
        remedy = "Look at range, sight, faces and the station, which are of the workpiece frame"
        if not isinstance(part, Sight):
            what = 'no pose reaches where "{setup}" is to be read within the travels and clear of stems'
            remedy = _nearest(machine, part)
        if isinstance(part, Balls) and setup.artefact is not None:
            what = "no pose reaches ball {ball} of {artefact} within the travels and clear of stems"
            named = {"ball": setup.artefact.balls[setup.balls[number]].name, "artefact": setup.artefact.name}
        raise DescriptionError(what, remedy, None, None, **named)


def _nearest(machine: Machine, part: Chart) -> str:
    """Say what is lacking at the place that leaves the travels least."""
    low, high = np.array([each[:2] for each in part.coordinates]).reshape(-1, 2).T
    poses = part.poses(low + (high - low) * even_points(_LOOKED_AT, len(low)))
    if np.isnan(poses).any(axis=1).all():
        slides = listed(said(" and "), [machine.axes[k].name for k in linear_axes(machine)])
        return said("{axes} alone never carry the tool point so far aside: place it where they do", axes=slides)
    low, high = np.array([axis.travel for axis in machine.axes]).T
    touching = part.touching if isinstance(part, Balls) else None
    gone = poses[None] if touching is None else np.concatenate([poses[None], touching(poses)])
    short = (np.maximum(low - gone, gone - high) / (high - low)).max(axis=0)
    best = int(np.nan_to_num(short.max(axis=1), nan=np.inf).argmin())
    lacks = float(short[best].max())
    if lacks <= 0:
        what = (
            "In every pose tool, holder or spindle nose meet a stem, the post of another ball or what is to be kept "
            "out, or there is no room to draw back: look at free, cone, keep_out, retract, [tool] and the travels"
        )
        return said(what)
    axis = machine.axes[int(short[best].argmax())]
    turned = [(each.name, math.degrees(at)) for each, at in zip(machine.axes, poses[best], strict=True) if each.rotary]
    where = listed(said(" and "), [said("{axis} at {angle:.0f} deg", axis=name, angle=a) for name, a in turned])
    what = (
        "At the nearest, with {where}, it lacks {lack} of {axis}"
        if where
        else "At the nearest it lacks {lack} of {axis}"
    )
    return said(what, where=where, lack=format_quantity(lacks * axis.length, axis.unit, 3), axis=axis.name)


def refuse_short_stroke(machine: Machine, setup: Setup, stroke: float) -> None:
    """Raise DescriptionError where the machine as described may deviate by more than what touches can follow.

    Four standard deviations of the deviation's change over the chart may not exceed half the stroke of a bar, or the
    stroke of a nest.
    """
    assert setup.chart is not None  # what is held in touch has one
    poses, approaches = chart_candidates(machine, setup, setup.chart, _LOOKED_AT)
    few = even_subset(np.hstack([poses, approaches]), _STROKES)
    rows = machine.rows_at(poses[few], approaches[few])
    changing = (rows - rows.mean(axis=0)).reshape(-1, machine.size) @ machine.root()
    change = _STDS * float(np.sqrt(np.sum(changing**2, axis=1).max()))
    allowed = stroke / (_FEWER if setup.length else 1)
    if change > allowed:
        room, size = format_quantity(allowed, "mm", 3), format_quantity(change, "mm", 3)
        what = "what touches follows to ±{room}: the machine may deviate by {size} as it is described"
        raise DescriptionError(what, "Align the axes first, or state smaller std", room=room, size=size)


_FINE = math.radians(0.25)
"""Finer than the whole degrees of the result."""
_SHORTEST = math.radians(5.0)
"""Nobody goes round a shorter arc."""
_WHOLE_DEGREES = math.radians(1.0)
"""What a person dials in."""


def reached_arc(circle: Circle, name: str) -> tuple[float, float]:
    """Return the longest arc that is reached in one piece, to whole degrees; raises DescriptionError for none."""
    taken, low, high = _reached(circle, _FINE * np.arange(2.0 * round(math.tau / _FINE)))  # around the circle and on
    if np.all(taken):
        return 0.0, math.tau
    if high - low < _SHORTEST:
        what = 'the bar of "{name}" reaches no arc of its circle within the travels and clear of stems'
        remedy = "Give another plane, station or length"
        if any(axis.rotary for axis in circle.room.machine.axes):
            remedy = "Give another plane, station or length, or park the rotary axes elsewhere"
        raise DescriptionError(what, remedy, name=name)
    behind = low >= math.pi and not np.any(circle.rates)  # what turns with it stands elsewhere a turn before
    return (low - math.tau, high - math.tau) if behind else (low, high)


def refuse_gap(circle: Circle, name: str) -> None:
    """Raise DescriptionError where an arc that was asked for cannot be gone round."""
    low, high, *_ = circle.coordinates[0]
    angles = np.linspace(low, high, 2 + int((high - low) / _FINE))
    taken, *ends = _reached(circle, angles)
    if np.all(taken):
        return
    bad = angles[~taken][:1]
    pairs = zip(circle.room.machine.axes, circle.poses(bad[:, None])[0], strict=True)
    axes = [axis.name for axis, at in pairs if not axis.travel[0] <= at <= axis.travel[1]]
    what = 'the bar of "{name}" meets a stem, or what is to be kept out, at {angle:.0f} deg'
    what = 'the bar of "{name}" leaves the travel of {axes} at {angle:.0f} deg' if axes else what
    ends = [*reached_arc(circle, name)] if ends[1] - ends[0] < _SHORTEST else ends
    angle, low, high = np.degrees([*bad, *ends]).tolist()
    remedy = 'Give arc = ["{low:.0f} deg", "{high:.0f} deg"]'
    raise DescriptionError(what, remedy, name=name, axes=", ".join(axes), angle=angle, low=low, high=high)


def _reached(circle: Circle, angles: Array) -> tuple[NDArray[np.bool_], float, float]:
    """Return at which angles the bar can be, (m,), and the whole degrees within the longest run of them, rad."""
    taken = circle.feasible(circle.poses(angles[:, None]))
    starts, stops = np.flatnonzero(np.diff(np.concatenate([[0], taken, [0]]))).reshape(-1, 2).T
    if not len(starts):
        return taken, 0.0, 0.0
    best = (stops - starts).argmax()
    first, last = angles[[starts[best], stops[best] - 1]] / _WHOLE_DEGREES
    return taken, math.ceil(first - 1e-9) * _WHOLE_DEGREES, math.floor(last + 1e-9) * _WHOLE_DEGREES


_KEYS = ("range", "sight", "faces")
_CONE = math.radians(60.0)
"""A corner cube is seen within so much of its axis, as makers state for theirs."""


def refuse_stray_keys(stated: Stated[SetupTable]) -> None:
    """Raise DescriptionError for keys that belong to what the set-up has not: nothing would come of them."""
    table, kind = stated.table, stated.table.instrument
    bar, lies, touches = (
        kind.site == "bar" and table.length is not None,
        kind is Straightedge,
        kind.usual.contact != "free",
    )
    balls = table.artefact is not None and touches
    warm = table.temperature is not None or kind.against_length or balls
    owners = (
        ("temperature_std expansion expansion_std", warm, later("a temperature, or a length that is compared with")),
        ("direction", kind.directed, later("an instrument that reads in one direction")),
        ("offset", issubclass(kind, Displacement), later("an instrument that reads a length in one direction")),
        ("base", issubclass(kind, Rotation), later("a level or the mirror of an autocollimator")),
        ("range sight faces", kind.site == "sight", later("a tracker or tracer")),
        ("stations", kind is Tracer, later('instrument = "tracer"')),
        ("station", kind.site in ("sight", "bar"), later("a ball bar, tracker or tracer")),
        ("lengths", kind.site == "length", later('instrument = "gauge"')),
        ("length", kind.site == "bar", later("a ball bar")),
        ("plane", bar, later("a ball bar with its length")),
        ("arc turning", bar and table.plane is not None, later("a ball bar with its length and plane")),
        ("stroke", bar or (balls and kind.usual.contact == "held"), later("a ball bar with its length, or an R-test")),
        ("reach map", not (bar or balls), later("an instrument that no ball or bar holds")),
        ("artefact", touches or kind.site == "bar" or lies, later("what reads balls, or a square")),
        ("ball at turn", table.artefact is not None and not lies, later("an artefact with balls")),
        ("mounted", table.artefact is not None, later("an artefact")),
        ("retract", bar or balls, later("what touches balls, or a ball bar with its length")),
    )
    _refuse_idle(stated, owners)


def refuse_idle_artefacts(tables: Sequence[ArtefactTable], document: Document) -> None:
    """Raise DescriptionError for keys of artefacts of which nothing comes."""
    for number, table in enumerate(tables):
        together, balls = table.calibrated is not None, bool(table.balls or table.grid)
        owners = (
            ("scale", together, later("calibrated, of three balls or more")),
            ("turned", together or not balls, later("calibrated, of three balls or more")),
            ("placed diameter free cone", balls, later("balls")),
        )
        _refuse_idle(Stated(document, table, ("artefacts", number)), owners)


def _refuse_idle(stated: Stated[Any], owners: Iterable[tuple[str, bool, str]]) -> None:
    """Raise DescriptionError for keys.  owners : keys, whether there is what they belong to, and that in words"""
    for keys, has, owner in owners:
        for key in (key for key in keys.split() if not has and key in stated.table.model_fields_set):
            what, remedy = "nothing comes of {key} without {owner}", "Take {key} out, or add that, too"
            raise stated.misstated(key, what, remedy, key=key, owner=said(owner))


def refuse_of_length(stated: Stated[SetupTable]) -> None:
    """Raise DescriptionError for a length without its ends, or with a way beside them."""
    table = stated.table
    if table.instrument.site != "length":
        return
    for key in ("direction", "moves", "along", "raster", "approach"):
        if key in table.model_fields_set:
            what = "a length goes from its first end to its second"
            raise stated.misstated(key, what, "Take {key} out", key=key)
    if not table.lengths:
        what = "it is not said between which places the {instrument} lies"
        remedy = (
            'Write lengths = {{ low = [["0 mm", "0 mm", "0 mm"], ["100 mm", "0 mm", "0 mm"]] }}, in the workpiece frame'
        )
        raise stated.misstated("instrument", what, remedy, instrument=table.instrument.instrument)


def refuse_both(stated: Stated[SetupTable]) -> None:
    """Raise DescriptionError for keys that exclude one another."""
    table = stated.table
    if table.along is None or table.instrument is Straightedge:
        return
    for pair in (sorted(("along", key)) for key in ("length", "artefact", "reach") if getattr(table, key)):
        what = "{first} and {second} exclude one another"
        raise stated.misstated(pair[1], what, "Give one of them", first=pair[0], second=pair[1])


def seen(stated: Stated[SetupTable], machine: Machine, setup: Setup) -> Setup:
    """Return a set-up that is read where its instrument sees the tool, as far as its table states that.

    Raises DescriptionError or UnitError.
    """
    table = stated.table
    said = [key for key in _KEYS if key in table.model_fields_set]
    if not said or not setup.standing:
        return setup
    if table.faces is None and table.sight is not None:
        what = "it is not said where the reflector looks that is seen within this angle"
        raise stated.misstated("sight", what, 'Write faces = "z", or leave sight out where it turns to the station')
    pairs = zip(setup.coordinates, setup.moves, strict=True)
    coordinates = tuple(c if machine.axes[k].rotary else c._replace(finest=FINEST_PLACE) for c, k in pairs)
    where = Room.empty(machine), np.array(setup.park), coordinates, setup.moves, np.array(setup.standing), table.range
    faces = None if table.faces is None else np.array(table.faces)
    setup = replace(setup, chart=Sight(*where, faces, _CONE if table.sight is None else table.sight))
    with stated.at_key(said[0]):
        refuse_unreachable(machine, setup)
    return setup


_AT_BALL = later('write artefact = "..." and [[artefacts]] with its place')
_ON_LINE = later("along = [...] with the two ends of a line")
_WITHIN = later(
    'name the axis in moves, and where its reference reaches: reach = {{ X = ["150 mm", "450 mm"] }}; or {line}'
)
_PLACED = {
    "ballbar": later('write length = "150 mm", and station or artefact for the centre'),
    "rtest": _AT_BALL,
    "sphere": _AT_BALL,
    "straightedge": _WITHIN,
    "probe": later("{within}; or an artefact with its balls"),
}
"""By instrument: what says where it reads; of others the one axis that moves, or a line."""


def lack_of(setup: Setup, machine: Machine, reached: Collection[str], chosen: bool) -> tuple[str, str] | None:
    """Return what a set-up does not say of where it can be read, and what to add; None where it says enough.

    reached : names of the axes whose reach is stated; chosen : the axes that move are named, not all by default
    """
    moving = [machine.axes[k].name for k in setup.moves]
    everywhere = all(name in reached for name in moving)
    site = setup.site
    enough = len(moving) == 1 or (site != "line" and (chosen or everywhere))
    enough = everywhere if site == "reach" else enough and site not in ("ball", "bar")
    if enough or setup.chart is not None or site == "sight":
        return None
    what = said(
        'it is not said where the {instrument} of "{setup}" reads', instrument=setup.instrument, setup=setup.name
    )
    line, axis = said(_ON_LINE), moving[0] if moving else "X"
    remedy = _PLACED.get(setup.instrument, later('write moves = ["{axis}"], or {line}'))
    return what, said(remedy, axis=axis, line=line, within=said(_WITHIN, line=line))
