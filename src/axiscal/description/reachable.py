"""Whether a set-up can be read where it says: within the travels, within the stroke, on which arc."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.model import ErrorModel
from axiscal.exceptions import DescriptionError
from axiscal.machine import Machine
from axiscal.machine.inverse import linear_axes
from axiscal.measurement.candidates import FEWEST, chart_candidates
from axiscal.measurement.charts.bar import Circle
from axiscal.measurement.charts.box import Sight
from axiscal.measurement.charts.chart import Chart
from axiscal.measurement.charts.held import Balls, Held
from axiscal.measurement.setup import Setup
from axiscal.measurement.touched import cycle_of, touches
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
        where = _where(setup, part, number)
        what = f"no pose reaches {where} within the travels and clear of stems"
        if len(poses) >= (1 if finite else FEWEST):
            if (remedy := _lacking_beside(machine, setup, part)) is None:
                continue
            what = f"the probe has no room to touch {where} from all sides"
        elif isinstance(part, Sight):
            remedy = "Look at range, sight, faces and the station, which are of the workpiece frame"
            raise DescriptionError(
                f'the {setup.instrument} of "{setup.name}" sees the tool in no pose, or hardly any', remedy
            )
        else:
            remedy = _nearest(machine, part)
        raise DescriptionError(what, remedy)


def _lacking_beside(machine: Machine, setup: Setup, part: Chart) -> str | None:
    """Say what the touches of a ball lack where no rotary axis turns; None where nothing, or nobody says sizes."""
    sized = setup.artefact is not None and setup.artefact.diameter is not None and machine.stylus > 0
    if not sized or part.size > 0 or setup.instrument != "sphere" or setup.three_touches:
        return None
    pose = part.poses(np.zeros((1, 0)))[0]
    stops = [stop for touch in touches(machine, pose, cycle_of(machine, setup)) for stop in (*touch.way, touch.beside)]
    low, high = np.array([axis.travel for axis in machine.axes]).T
    short = np.maximum(low - stops, stops - high).max(axis=0)
    axis = machine.axes[int(short.argmax())]
    lack = f"It lacks {format_quantity(float(short.max()), axis.unit, 3)} of {axis.name}"
    return f"{lack}: put it nearer to the middle of the travels" if short.max() > 0 else None


def _where(setup: Setup, part: Chart, number: int) -> str:
    if isinstance(part, Held) and setup.artefact is not None:
        return f"ball {setup.artefact.balls[setup.balls[number]].name} of {setup.artefact.name}"
    return f'where "{setup.name}" is to be read'


def _nearest(machine: Machine, part: Chart) -> str:
    """Say what is lacking at the place that leaves the travels least."""
    ends = [part.bounds(k) for k in range(part.size)]
    unit = even_points(_LOOKED_AT, part.size)
    poses = part.poses(
        np.column_stack([unit[:, :0], *(e.low + (e.high - e.low) * s for e, s in zip(ends, unit.T, strict=True))])
    )
    if np.isnan(poses).any(axis=1).all():
        slides = " and ".join(machine.axes[k].name for k in linear_axes(machine))
        return f"{slides} alone never carry the tool point so far aside: place it where they do"
    low, high = np.array([axis.travel for axis in machine.axes]).T
    short = np.maximum(low - poses, poses - high) / (high - low)
    best = int(np.nan_to_num(short.max(axis=1), nan=np.inf).argmin())
    axis = int(short[best].argmax())
    if short[best, axis] <= 0:
        return (
            "The tool is against a stem, or in what is to be kept out, in every pose: look at free, cone and keep_out"
        )
    lack = format_quantity(float(short[best, axis] * (high - low)[axis]), machine.axes[axis].unit, 3)
    at = [k for k, each in enumerate(machine.axes) if each.rotary]
    said = " and ".join(f"{machine.axes[k].name} at {math.degrees(poses[best, k]):.0f} deg" for k in at)
    return f"At the nearest{f', with {said},' if said else ''} it lacks {lack} of {machine.axes[axis].name}"


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
        what = f"what touches follows to ±{room}: the machine may deviate by {size} as it is described"
        raise DescriptionError(what, "Align the axes first, or state smaller std")


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
        what = f'the bar of "{name}" reaches no arc of its circle within the travels and clear of stems'
        raise DescriptionError(what, "Give another plane, station or length, or park the rotary axes elsewhere")
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
    leaves = f"leaves the travel of {', '.join(away)}" if away else "meets a stem, or what is to be kept out,"
    first, count = _longest_of(taken)
    low, high = _whole(angles[first], angles[first + max(count, 1) - 1])
    if high - low < _SHORTEST:
        low, high = reached_arc(circle, name)
    what = f'the bar of "{name}" {leaves} at {math.degrees(bad):.0f} deg'
    raise DescriptionError(what, f'Give arc = ["{math.degrees(low):.0f} deg", "{math.degrees(high):.0f} deg"]')


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
