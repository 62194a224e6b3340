"""The largest |Z b|² of readings on a chart, enclosed: boxes of its coordinates are cut until none may hold more.

Over a box |w(u + h)| ≤ the largest |w + ∂w h| over its corners + ½ Σ |∂ᵢⱼw| hᵢ hⱼ. A box is dropped where an axis must
be out of its travel, the tool out of the cone of its ball, or its side another. The way in may be too short to say from
which side an axis comes. The value seen then lies between both sides and is never more than the larger of the two.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import PlanError
from axiscal.machine.description import Machine
from axiscal.machine.inverse import drawn_back
from axiscal.machine.kinematics import frames
from axiscal.measurement.candidates import arrivals_of, chart_sides
from axiscal.measurement.charts.box import Box
from axiscal.measurement.charts.chart import KNOWN, Chart, begun, has_room
from axiscal.measurement.charts.held import Balls, Held
from axiscal.measurement.charts.line import Line
from axiscal.measurement.observation import Observation
from axiscal.measurement.place import Places
from axiscal.numerics import Array
from axiscal.numerics.largest import largest
from axiscal.numerics.waves import Span
from axiscal.planning.bound.chart_rows import Boxes, ChartRows, TravellingWaves

_PIECES = 72
"""Boxes of a coordinate to begin with, 5 deg of a turn; more are cut where they are needed."""
_BATCH = 512
"""Boxes looked at at once: of memory, not of the result."""
_MANY = 2
"""Coordinates without steps up to which boxes can be cut till the gap is closed."""
_LOOKS = 64
"""Places at which the sums are compared with the rows themselves; a wrong one shows at almost every place."""
_EXACT = 1e-9
"""Rounding of sums of waves, with room; a term that is missing is millions of times larger."""
_SLACK = 1e-9
"""Rounding of a limit, m, rad or of a cosine."""
_ROUNDING = 1e-10
"""Rounding of a squared length, with room: added to the bound."""


class Largest(NamedTuple):
    """No |Z b|² is above upper; places : where it is large."""

    upper: float
    places: Places


class _Slice(NamedTuple):
    """A chart with the coordinates that have steps held.  held : (size,) u; free : indices of the others"""

    chart: Chart
    held: Array
    free: tuple[int, ...]

    def places(self, values: Array) -> Array:
        """Return places u (m, size) from the free coordinates (m, free)."""
        whole = np.tile(self.held, (len(values), 1))
        whole[:, list(self.free)] = values
        return whole

    def poses(self, values: Array) -> Array:
        """Return the poses (m, q)."""
        return self.chart.poses(self.places(values))


def refuse_unless_boxed(observation: Observation, setup: int) -> None:
    """Raise PlanError for a set-up on a chart that cannot be cut into boxes."""
    mounted = observation.setups[setup]
    chart = _chart(observation, setup)
    free = _free(chart)
    if len(free) > _MANY:
        what = (
            'no proof for readings anywhere: "{setup}" is read on a chart of {count} coordinates without steps, more '
            "than {most}"
        )
        remedy = "Write a raster for some of them, or leave --prove out: then the bound holds for the candidates"
        raise PlanError(what, remedy, setup=mounted.name, count=len(free), most=_MANY)
    remedy = "Leave --prove out, then the bound holds for the candidates"
    if observation.errors.planes:
        what = (
            'no proof for readings anywhere: "{setup}" is read on a chart, and {error} is an error of two axes together'
        )
        raise PlanError(what, remedy, setup=mounted.name, error=observation.errors.planes[0].name)
    if free and not all(_matches(observation, setup, part) for part in _slices(chart)[:1]):
        what = (
            'no proof for readings anywhere: "{setup}" is read on a chart along which what it sees is no sum of a few '
            "waves"
        )
        raise PlanError(what, remedy, setup=mounted.name)


def largest_on_chart(
    observation: Observation, setup: int, reach: Array, level: float, gap: float, boxes: int
) -> Largest:
    """Enclose the largest |g reach|² of readings of a set-up; what is not above level · (1 + gap) is not followed.

    reach : (n, w); boxes : how many to look at; what is then still open counts with its upper bound
    """
    chart, mounted, reach = _chart(observation, setup), observation.setups[setup], _short(reach)
    choices = chart_sides(observation.machine, mounted, chart)
    if not _free(chart):
        grid = np.stack([g.ravel() for g in np.meshgrid(*_values(chart), indexing="ij")], axis=1)
        found = _Found(observation, setup, chart, reach)
        for sides in choices:
            found.look(grid, sides)
        return Largest(max(found.best, level), found.places(level * (1 + gap)))
    found, upper = _Found(observation, setup, chart, reach), level
    for part in _slices(chart):
        rows = ChartRows(observation, setup, part.poses, _spans(part), reach)
        for sides in choices:
            search = _BoxCutting(observation, setup, part, sides, rows, found, level, gap)
            upper = max(upper, search.upper(boxes))
    return Largest(upper, found.places(level * (1 + gap / 2)))


def _short(reach: Array) -> Array:
    """Return a matrix (n, r) along which all rows are as long to rounding, with no more columns than it takes."""
    turned, sizes, _ = np.linalg.svd(reach, full_matrices=False)
    kept = sizes > _NOTHING * sizes[0]
    short: Array = turned[:, kept] * sizes[kept]
    return short


_NOTHING = 1e-9
"""Share of the largest singular value: its square is rounding."""


class _Found:
    """Places that were looked at and can be read, and what is seen there."""

    def __init__(self, observation: Observation, setup: int, chart: Chart, reach: Array) -> None:
        self._observation, self._setup, self._chart, self._reach = observation, setup, chart, reach
        self.best = 0.0
        self._all: list[tuple[Array, Array, Array]] = []

    def look(self, places: Array, sides: Array) -> None:
        """Look at places u (m, size) come to from sides (size,)."""
        each = np.tile(sides, (len(places), 1))
        kept = has_room(self._chart, places, each)
        if not kept.any():
            return
        mounted = self._observation.setups[self._setup]
        poses = self._chart.poses(places[kept])
        approaches = arrivals_of(self._observation.machine, mounted, self._chart, places[kept], each[kept])
        seen = self._observation.rows_each(self._setup, poses, approaches)
        lengths = sum(np.sum((rows.rows @ self._reach) ** 2, axis=1) for rows in seen)
        self.best = max(self.best, float(np.max(lengths)))
        self._all.append((poses, approaches, np.asarray(lengths, dtype=np.float64)))

    def places(self, level: float) -> Places:
        """Return a few places above a level, the best first, no two next to each other."""
        if not self._all:
            return Places.none(len(self._observation.machine.axes))
        poses, approaches, lengths = (np.concatenate(parts) for parts in zip(*self._all, strict=True))
        spans = np.array([axis.length for axis in self._observation.machine.axes])
        order = np.argsort(-lengths, kind="stable")[: int(np.sum(lengths > level))]
        chosen = apart(np.hstack([poses / spans, approaches]), order)
        return Places.of_setup(self._setup, poses[chosen], approaches[chosen])


def apart(places: Array, order: NDArray[np.intp]) -> list[int]:
    """Return a few places in order that are no neighbours of each other.  places : (m, k) in shares of the travel"""
    chosen: list[int] = []
    for i in order.tolist():
        if len(chosen) < _ADDED and np.all(np.abs(places[chosen] - places[i]).max(axis=1, initial=0.0) > _NEAR):
            chosen.append(i)
    return chosen


_ADDED = 24
"""Places that enter at once: more make fewer, longer rounds to the same weights."""
_NEAR = 0.01
"""Shares of the travel: places nearer than this enter one after the other."""


class _BoxCutting:
    """The boxes of one slice of a chart, come to from one side of each coordinate."""

    def __init__(
        self,
        observation: Observation,
        setup: int,
        part: _Slice,
        sides: Array,
        rows: ChartRows,
        found: _Found,
        level: float,
        gap: float,
    ) -> None:
        self._level, self._gap = level, gap
        self._machine, self._part, self._sides = observation.machine, part, sides
        self._rows, self._found, spans = rows, found, _spans(part)
        self._limits, self._within = _limits(part, self._before, self._machine)
        self._ways = TravellingWaves.of(self._way, spans)
        follow = observation.setups[setup].sides_follow
        sided = (k for k, axis in enumerate(self._machine.axes) if axis.rotary or follow)
        self._reversing = [k for k in sided if k in observation.errors.reversing]

    def _way(self, values: Array) -> Array:
        """Return how far each axis comes on the way into places, (m, q)."""
        way: Array = self._part.poses(values) - self._part.chart.poses(self._before(values))
        return way

    def _before(self, values: Array) -> Array:
        """Return where the ways into places (m, free) begin, (m, size)."""
        return begun(self._part.chart, self._part.places(values), np.tile(self._sides, (len(values), 1)))

    @property
    def known(self) -> float:
        """The value up to which the search follows nothing; far above the level places matter, and no digits."""
        seen = max(self._level, self._found.best)
        return seen * (1 + max(self._gap, (seen / self._level - 1) / 4))

    def upper(self, most: int) -> float:
        """Return what no |w|² is above, cutting boxes until it is near the largest that was seen, or the level."""
        boxes = _grid(self._part, self._sides)
        found = largest(self, boxes, np.full(len(boxes.middles), np.inf), most, _BATCH)
        return max(self.known, found.upper)

    def split(self, boxes: tuple[Array, ...]) -> list[tuple[Array, ...]]:
        """Return both halves of boxes, cut where they are widest."""
        middles, halves = boxes[0], boxes[1].copy()
        every, widest = np.arange(len(halves)), halves.argmax(axis=1)
        halves[every, widest] /= 2
        aside = np.zeros_like(halves)
        aside[every, widest] = halves[every, widest]
        return [(middles - aside, halves), (middles + aside, halves)]

    def look(self, boxes: tuple[Array, ...]) -> tuple[Boxes, Array]:
        """Return the boxes that may hold readings, with what |w|² is at most in each."""
        boxes = Boxes(*boxes)
        values, off = self._limits.at(boxes.middles), self._limits.sizes(boxes).first
        low, high = self._within.T[:, :, None]
        kept = np.all((values + off >= low) & (values - off <= high), axis=0)
        boxes = boxes.some(kept)
        if not len(boxes.middles):
            return boxes, np.zeros(0)
        self._found.look(self._part.places(boxes.middles), self._sides)
        way, off = self._ways.at(boxes.middles), self._ways.sizes(boxes).first
        least = KNOWN * np.array([axis.overrun for axis in self._machine.axes])[:, None]
        comes = {1.0: way + off >= least, -1.0: way - off <= -least, 0.0: (way - off < least) & (way + off > -least)}
        lengths = np.zeros(len(boxes.middles))
        for signs in product((1.0, -1.0), repeat=len(self._reversing)):
            side = np.zeros((len(lengths), len(self._machine.axes)))
            side[:, self._reversing] = signs
            may = np.ones(len(lengths), dtype=bool)
            for k, sign in zip(self._reversing, signs, strict=True):
                may &= comes[sign][k] | comes[0.0][k]
            if may.any():
                lengths[may] = np.maximum(
                    lengths[may], self._rows.longest(boxes.some(may), side[may]) ** 2 * (1 + _ROUNDING)
                )
        return boxes, lengths


def _grid(part: _Slice, sides: Array) -> Boxes:
    """Return the boxes to begin with, of all that can be come to within the chart."""
    edges = []
    for number, span in zip(part.free, _spans(part), strict=True):
        end = part.chart.bounds(number)
        way = 0.0 if end.endless else sides[number] * end.overrun
        low, high = end.low + max(way, 0.0), end.high + min(way, 0.0)
        count = max(1, round(_PIECES * (high - low) / (2 * np.pi))) if span.around else _PIECES
        edges.append(np.linspace(low, max(high, low), count + 1))
    middles = np.stack([g.ravel() for g in np.meshgrid(*((e[1:] + e[:-1]) / 2 for e in edges), indexing="ij")], axis=1)
    halves = np.array([(each[1] - each[0]) / 2 for each in edges])
    return Boxes(middles, np.tile(halves, (len(middles), 1)))


def _limits(part: _Slice, before: Callable[[Array], Array], machine: Machine) -> tuple[TravellingWaves, Array]:
    """Return what must stay within limits at a place and where its way begins, and these limits, (limits, 2).

    before : places (m, free) -> where their ways begin, (m, size)
    """
    chart, travels = part.chart, [axis.travel for axis in machine.axes]
    ball = chart.each[round(float(part.held[0]))] if isinstance(chart, Balls) else chart

    def limited(values: Array) -> Array:
        both = [chart.poses(places) for places in (part.places(values), before(values))]
        if not isinstance(ball, Held):
            return np.concatenate(both, axis=1)
        back = [drawn_back(machine, poses, ball.back) for poses in both]
        along = [(frames(machine, poses).stem @ ball.free)[:, None] for poses in both]
        return np.concatenate([*both, *back, *along], axis=1)

    ends = travels * 2
    if isinstance(ball, Held):
        ends = [*travels * 4, *[(float(np.cos(min(ball.cone, np.pi))), 1.0)] * 2]
    return TravellingWaves.of(limited, _spans(part)), np.array(ends) + _SLACK * np.array([-1.0, 1.0])


def _matches(observation: Observation, setup: int, part: _Slice) -> bool:
    """Return whether the sums are the rows, at places all over the chart."""
    spans = _spans(part)
    rng = np.random.default_rng(0)
    low, high = np.array([[span.low, span.high] for span in spans]).T
    values = low + (high - low) * rng.uniform(size=(_LOOKS, len(spans)))
    poses = part.poses(values)
    if not np.isfinite(poses).all():
        return False
    signs = np.ones(poses.shape)
    seen = observation.rows_each(setup, poses, signs)
    reach = rng.standard_normal((observation.size, 3))
    rows = ChartRows(observation, setup, part.poses, spans, reach)
    found = rows.at(values, signs)
    true = np.concatenate([each.rows @ reach for each in seen], axis=1)
    return bool(np.all(np.abs(found - true) <= _EXACT * np.abs(true).max(axis=0)))


def _chart(observation: Observation, setup: int) -> Chart:
    chart = observation.setups[setup].chart
    assert chart is not None
    return chart


def _free(chart: Chart) -> tuple[int, ...]:
    return tuple(number for number in range(chart.size) if not chart.bounds(number).step > 0)


def _values(chart: Chart) -> list[Array]:
    return [chart.bounds(number).values for number in range(chart.size)]


def _slices(chart: Chart) -> list[_Slice]:
    """Return the chart with every combination of the coordinates that have steps."""
    free = _free(chart)
    each = [
        np.array([chart.bounds(number).low]) if number in free else chart.bounds(number).values
        for number in range(chart.size)
    ]
    return [_Slice(chart, np.array(held), free) for held in product(*each)]


def _spans(part: _Slice) -> tuple[Span, ...]:
    ends = [part.chart.bounds(number) for number in part.free]
    return tuple(Span(e.low, e.high, _turns(part.chart, n)) for n, e in zip(part.free, ends, strict=True))


def _turns(chart: Chart, number: int) -> bool:
    """Whether a coordinate is an angle."""
    if isinstance(chart, Box):
        return chart.room.machine.axes[chart.moves[number]].rotary
    return not isinstance(chart, Line)
