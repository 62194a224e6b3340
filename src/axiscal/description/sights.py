"""Whether a set-up can be read where it says: within the travels, within the stroke, on which arc, and in sight.

Trackers and tracers say by `stations`, `range`, `sight` and `faces` where they stand and what they see.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

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
from axiscal_core.points import even_points

_LOOKED_AT = 1000
"""Places looked at: what lacks room does so at a good part of them."""
_STDS = 4.0
_STROKES = 100
"""Places at which the stroke is looked at."""
_FEWER = 2
"""A bar is set in the middle of its stroke: half of it is left either way."""


def refuse_unreachable(setup: Setup) -> None:
    """Raise DescriptionError for a chart, or a ball of it, that no pose reaches from an allowed side."""
    chart, named = setup.chart, {"instrument": setup.instrument, "setup": setup.name}
    for number, part in enumerate(chart.each() if isinstance(chart, Balls) else [chart] if chart else []):
        places, _ = chart_places(setup.machine, setup, part, _LOOKED_AT)
        finite = all(each.step > 0 for each in part.coordinates)
        if len(places) >= (1 if finite else FEWEST):
            continue
        if isinstance(part, Sight):
            what = 'the {instrument} of "{setup}" sees the tool in no pose, or hardly any'
            remedy = "Look at range, sight, faces and the station, which are of the workpiece frame"
            raise DescriptionError(what, remedy, None, None, **named)
        what = 'no pose reaches where "{setup}" is to be read within the travels and clear of stems'
        if isinstance(part, Balls) and setup.artefact is not None:
            what = "no pose reaches ball {ball} of {artefact} within the travels and clear of stems"
            named = {"ball": setup.artefact.balls[setup.balls[number]].name, "artefact": setup.artefact.name}
        low, high = np.array([each[:2] for each in part.coordinates]).reshape(-1, 2).T
        poses = part.poses(low + (high - low) * even_points(_LOOKED_AT, len(low)))
        raise DescriptionError(what, lacking(part, poses), None, None, **named)


def lacking(part: Chart, poses: Array) -> str:
    """Say what is lacking at the one of some poses (m, q) of a chart that leaves the travels least."""
    machine = part.room.machine
    if np.isnan(poses).any(axis=1).all():
        slides = listed(said(" and "), [machine.axes[k].name for k in linear_axes(machine)])
        return said("{axes} alone never carry the tool point so far aside: place it where they do", axes=slides)
    low, high = np.array([axis.travel for axis in machine.axes]).T
    touching = part.touching if isinstance(part, Balls) else None
    gone = poses[None] if touching is None else np.concatenate([poses[None], touching(poses)])
    short = (np.maximum(low - gone, gone - high) / (high - low)).max(axis=0)
    best = int(np.nan_to_num(short.max(axis=1), nan=np.inf).argmin())
    lacks, axis = float(short[best].max()), machine.axes[int(short[best].argmax())]
    what = "At the nearest it lacks {lack} of {axis}"
    if lacks <= 0:
        what = (
            "In every pose tool, holder or spindle nose meet a stem, the post of another ball or what is to be kept "
            "out, or there is no room to draw back: look at free, cone, keep_out, retract, [tool] and the travels"
        )
    return said(what, lack=format_quantity(lacks * axis.length, axis.unit, 3), axis=axis.name)


def refuse_short_stroke(setup: Setup, stroke: float) -> None:
    """Raise DescriptionError where the machine as described may deviate by more than what touches can follow.

    Four standard deviations of the deviation's change over the chart may not exceed half the stroke of a bar, or the
    stroke of a nest.
    """
    assert setup.chart is not None  # what is held in touch has one
    machine = setup.machine
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
    angles = _FINE * np.arange(2.0 * round(math.tau / _FINE))  # around the circle and on
    reached = circle.feasible(circle.poses(angles[:, None]))
    if reached.all():
        return 0.0, math.tau
    runs = np.flatnonzero(np.diff(np.concatenate([[0], reached, [0]]))).reshape(-1, 2).tolist()
    start, stop = max(runs, key=lambda run: run[1] - run[0], default=(0, 1))
    low = math.ceil(angles[start] / _WHOLE_DEGREES - 1e-9) * _WHOLE_DEGREES
    high = math.floor(angles[stop - 1] / _WHOLE_DEGREES + 1e-9) * _WHOLE_DEGREES
    if high - low < _SHORTEST:
        what = 'the bar of "{name}" reaches no arc of its circle within the travels and clear of stems'
        remedy = "Give another plane, station or length, or park the rotary axes elsewhere"
        raise DescriptionError(what, remedy, name=name)
    behind = low >= math.pi and not np.any(circle.rates)  # what turns with it stands elsewhere a turn before
    return (low - math.tau, high - math.tau) if behind else (low, high)


def refuse_gap(circle: Circle, arc: tuple[float, float], name: str) -> None:
    """Raise DescriptionError where an arc that was asked for cannot be gone round.  arc : rad"""
    angles = np.linspace(*arc, 2 + int((arc[1] - arc[0]) / _FINE))
    bad = angles[~circle.feasible(circle.poses(angles[:, None]))]
    if len(bad):
        what = 'the bar of "{name}" leaves the travels or meets what stands there at {angle:.0f} deg'
        angle, low, high = np.degrees([bad[0], *reached_arc(circle, name)]).tolist()
        remedy = 'Give arc = ["{low:.0f} deg", "{high:.0f} deg"]'
        raise DescriptionError(what, remedy, name=name, angle=angle, low=low, high=high)


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
        ("direction", kind.directed and kind.site != "length", later("an instrument that reads in one direction")),
        (
            "moves along raster approach",
            kind.site != "length",
            later("another instrument: a length goes from its first end to its second"),
        ),
        ("length artefact reach", table.along is None or lies, later("another set-up: this one reads along a line")),
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


def seen(stated: Stated[SetupTable], setup: Setup) -> Setup:
    """Return a set-up that is read where its instrument sees the tool, as far as its table states that.

    Raises DescriptionError or UnitError.
    """
    table, machine = stated.table, setup.machine
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
        refuse_unreachable(setup)
    return setup


_ON_LINE = later("along = [...] with the two ends of a line")
_PLACED = {
    "bar": later('write length = "150 mm", and station or artefact for the centre'),
    "ball": later('write artefact = "..." and [[artefacts]] with its place'),
    "reach": later(
        'name the axis in moves, and where its reference reaches: reach = {{ X = ["150 mm", "450 mm"] }}; or {line}'
    ),
    "length": later(
        'write lengths = {{ low = [["0 mm", "0 mm", "0 mm"], ["100 mm", "0 mm", "0 mm"]] }}, in the workpiece frame'
    ),
}
"""By `site`: what says where an instrument reads; of others the one axis that moves, or a line."""


def lack_of(setup: Setup, table: SetupTable) -> tuple[str, str] | None:
    """Return what a set-up does not say of where it can be read, and what to add; None where it says enough."""
    moving, site = [setup.machine.axes[k].name for k in setup.moves], setup.site
    everywhere, alone = all(name in table.reach for name in moving), len(moving) == 1
    enough = {"reach": everywhere, "line": alone, "anywhere": alone or everywhere or table.moves is not None}
    if setup.chart is not None or enough.get(site, site == "sight"):
        return None
    what = said(
        'it is not said where the {instrument} of "{setup}" reads', instrument=setup.instrument, setup=setup.name
    )
    remedy = _PLACED.get(site, later('write moves = ["{axis}"], or {line}'))
    return what, said(remedy, axis=moving[0] if moving else "X", line=said(_ON_LINE))
