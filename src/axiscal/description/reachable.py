"""Whether a set-up can be read where it says: within the travels, within the stroke, on which arc."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.model import ErrorModel
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import listed, said
from axiscal.machine import Machine
from axiscal.machine.kinematics import linear_axes
from axiscal.measurement.candidates import FEWEST, chart_candidates
from axiscal.measurement.charts.bar import Circle
from axiscal.measurement.charts.box import Sight
from axiscal.measurement.charts.chart import Chart
from axiscal.measurement.charts.held import Balls, Held
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.spread import even_points
from axiscal.units import format_quantity

_LOOKED_AT = 1000
"""Places looked at: what lacks room does so at a good part of them."""
_STDS = 4.0
_FEWER = 2
"""A bar is set in the middle of its stroke: half of it is left either way."""


def refuse_unreachable(machine: Machine, setup: Setup) -> None:
    """Raise DescriptionError for a chart, or a ball of it, that no pose reaches from an allowed side."""
    chart = setup.chart
    each = chart.each if isinstance(chart, Balls) else () if chart is None else (chart,)
    for number, part in enumerate(each):
        poses, _ = chart_candidates(machine, setup, part, _LOOKED_AT)
        finite = all(part.bounds(k).step > 0 for k in range(part.size))
        if len(poses) >= (1 if finite else FEWEST):
            continue
        if isinstance(part, Sight):
            what = 'the {instrument} of "{setup}" sees the tool in no pose, or hardly any'
            remedy = "Look at range, sight, faces and the station, which are of the workpiece frame"
            raise DescriptionError(what, remedy, instrument=setup.instrument, setup=setup.name)
        if isinstance(part, Held) and setup.artefact is not None:
            what, ball = (
                "no pose reaches ball {ball} of {artefact} within the travels and clear of stems",
                setup.balls[number],
            )
            at = {"ball": setup.artefact.balls[ball].name, "artefact": setup.artefact.name}
            raise DescriptionError(what, _nearest(machine, part), None, None, **at)
        what = 'no pose reaches where "{setup}" is to be read within the travels and clear of stems'
        raise DescriptionError(what, _nearest(machine, part), setup=setup.name)


def _nearest(machine: Machine, part: Chart) -> str:
    """Say what is lacking at the place that leaves the travels least."""
    ends = [part.bounds(k) for k in range(part.size)]
    unit = even_points(_LOOKED_AT, part.size)
    poses = part.poses(
        np.column_stack([unit[:, :0], *(e.low + (e.high - e.low) * s for e, s in zip(ends, unit.T, strict=True))])
    )
    if np.isnan(poses).any(axis=1).all():
        slides = listed(said(" and "), [machine.axes[k].name for k in linear_axes(machine)])
        return said("{axes} alone never carry the tool point so far aside: place it where they do", axes=slides)
    low, high = np.array([axis.travel for axis in machine.axes]).T
    touching = part.touching if isinstance(part, Held) else None
    gone = poses[None] if touching is None else np.concatenate([poses[None], touching(poses)])
    short = (np.maximum(low - gone, gone - high) / (high - low)).max(axis=0)
    best = int(np.nan_to_num(short.max(axis=1), nan=np.inf).argmin())
    axis = int(short[best].argmax())
    if short[best, axis] <= 0:
        what = (
            "In every pose the tool is against a stem, in what is to be kept out, or without room to draw back: look "
            "at free, cone, keep_out, retract and the travels"
        )
        return said(what)
    lack = format_quantity(float(short[best, axis] * (high - low)[axis]), machine.axes[axis].unit, 3)
    at = [k for k, each in enumerate(machine.axes) if each.rotary]
    turned = [(machine.axes[k].name, math.degrees(poses[best, k])) for k in at]
    where = listed(said(" and "), [said("{axis} at {angle:.0f} deg", axis=name, angle=a) for name, a in turned])
    what = (
        "At the nearest, with {where}, it lacks {lack} of {axis}"
        if where
        else "At the nearest it lacks {lack} of {axis}"
    )
    return said(what, where=where, lack=lack, axis=machine.axes[axis].name)


def refuse_short_stroke(machine: Machine, setup: Setup, stroke: float) -> None:
    """Raise DescriptionError where the machine as described may deviate by more than what touches can follow.

    Four standard deviations of the deviation's change over the chart may not exceed half the stroke of a bar, or the
    stroke of a nest.
    """
    assert setup.chart is not None  # what is held in touch has one
    poses, approaches = chart_candidates(machine, setup, setup.chart, _LOOKED_AT)
    step = max(1, len(poses) // 100)
    model = ErrorModel(machine)
    rows = model.rows(poses[::step], approaches[::step])
    changing = (rows - rows.mean(axis=0)).reshape(-1, model.size) @ model.prior_root()
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
    angles = _FINE * np.arange(float(round(math.tau / _FINE)))
    taken = _taken(circle, angles)
    if np.all(taken):
        return 0.0, math.tau
    start, count = _longest(taken)
    low, high = _whole(angles[start], angles[start] + (count - 1) * _FINE)
    if high - low < _SHORTEST:
        what = 'the bar of "{name}" reaches no arc of its circle within the travels and clear of stems'
        remedy = "Give another plane, station or length, or park the rotary axes elsewhere"
        raise DescriptionError(what, remedy, name=name)
    return (low - math.tau, high - math.tau) if low >= math.pi else (low, high)


def refuse_gap(circle: Circle, name: str) -> None:
    """Raise DescriptionError where an arc that was asked for cannot be gone round."""
    low, high = circle.arc
    angles = np.linspace(low, high, 2 + int((high - low) / _FINE))
    taken = _taken(circle, angles)
    if np.all(taken):
        return
    bad = float(angles[np.flatnonzero(~taken)[0]])
    pose = circle.poses(np.array([[bad]]))[0]
    away = [
        a.name for a, at in zip(circle.room.machine.axes, pose, strict=True) if not a.travel[0] <= at <= a.travel[1]
    ]
    first, count = _longest_of(taken)
    low, high = _whole(angles[first], angles[first + max(count, 1) - 1])
    if high - low < _SHORTEST:
        low, high = reached_arc(circle, name)
    what = 'the bar of "{name}" meets a stem, or what is to be kept out, at {angle:.0f} deg'
    if away:
        what = 'the bar of "{name}" leaves the travel of {axes} at {angle:.0f} deg'
    remedy, bad, low, high = 'Give arc = ["{low:.0f} deg", "{high:.0f} deg"]', *map(math.degrees, (bad, low, high))
    raise DescriptionError(what, remedy, name=name, axes=", ".join(away), angle=bad, low=low, high=high)


def _whole(low: float, high: float) -> tuple[float, float]:
    """Return the whole degrees within an arc, rad."""
    first, last = low / _WHOLE_DEGREES - 1e-9, high / _WHOLE_DEGREES + 1e-9
    return math.ceil(first) * _WHOLE_DEGREES, math.floor(last) * _WHOLE_DEGREES


def _taken(circle: Circle, angles: Array) -> NDArray[np.bool_]:
    return circle.feasible(circle.poses(angles[:, None]))


def _longest(taken: NDArray[np.bool_]) -> tuple[int, int]:
    """Return start and length of the longest run around a circle."""
    start, count = _longest_of(np.concatenate([taken, taken]))
    return start % len(taken), min(count, len(taken))


def _longest_of(taken: NDArray[np.bool_]) -> tuple[int, int]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], taken.astype(int), [0]])))
    starts, stops = edges[::2], edges[1::2]
    if not len(starts):
        return 0, 0
    best = int((stops - starts).argmax())
    return int(starts[best]), int(stops[best] - starts[best])
