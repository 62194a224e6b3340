"""Where a set-up is read: at the balls of an artefact, at a bar's length from a centre, or along a line."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.description.campaign_schema import SetupTable
from axiscal.description.reachable import reached_arc, refuse_gap
from axiscal.description.target import coordinate
from axiscal.description.vectors import At, unit_vector
from axiscal.document import nearest, shown
from axiscal.exceptions import DescriptionError
from axiscal.machine import Axis, Machine
from axiscal.machine.inverse import linear_axes
from axiscal.measurement.artefact import Artefact
from axiscal.measurement.charts.bar import Bar, Circle
from axiscal.measurement.charts.chart import Chart, Coordinate
from axiscal.measurement.charts.held import Balls, Held
from axiscal.measurement.charts.line import Line
from axiscal.measurement.charts.room import Room
from axiscal.measurement.instruments.kind import TOOL
from axiscal.measurement.instruments.nest import RADIUS
from axiscal.measurement.owners import unknowns_at
from axiscal.measurement.setup import Contact, Unknown, Vector
from axiscal.numerics import Array
from axiscal.units import format_quantity, parse_quantity

TOUCHING = ("rtest", "sphere", "probe")
OPEN_LENGTH = 1e-3
OPEN_RADIUS = 1e-4
"""m, std of the radius at which a stylus meets a sphere, where nobody measured it: that of a tool, see Setup."""
STROKE = 1e-3
RETRACT = 0.05
CUP = 1e-4
"""m, how far the centre of a bar may be from its station: it is set to within a tenth of a millimetre."""
_FREE_CONE = math.radians(100.0)
_PLANES = {"xy": ("x", "y"), "yz": ("y", "z"), "zx": ("z", "x")}
_SAME_WAY = 1e-6
"""Sine: rounding of two directions that are one."""


@dataclass(frozen=True, slots=True)
class Site:
    """The place where a set-up is read, and the unknowns of that; as in `Setup`."""

    chart: Chart
    moves: tuple[int, ...]
    park: tuple[float, ...]
    contact: Contact
    unknowns: tuple[Unknown, ...] = ()
    artefact: Artefact | None = None
    balls: tuple[int, ...] = ()
    station: Vector | None = None
    direction: Vector | None = None
    length: float | None = None


class SiteReader:
    """Reads the keys of one table that say where.

    tool : std of how far the tool's point is from where it is stated, along its x, y, z, m; 0 leaves one out
    """

    def __init__(
        self,
        table: SetupTable,
        machine: Machine,
        artefacts: Mapping[str, Artefact],
        tool: Vector,
        at: At,
    ) -> None:
        self._table, self._machine, self._artefacts, self._at = table, machine, artefacts, at
        turns = any(axis.rotary for axis in machine.axes)
        parts = zip(TOOL, tool, strict=True)
        self._tool = tuple(Unknown(name, std, "tool") for name, std in parts if turns and std > 0)

    def site(self) -> Site | None:
        """Return where the set-up is read; None where any pose of the axes that move will do.

        Raises DescriptionError or UnitError.
        """
        self._refuse_both()
        if self._table.along is not None:
            return self._line(self._table.along)
        if self._table.instrument == "ballbar":
            return None if self._table.length is None else self._bar(self._table.length)
        if self._table.instrument in TOUCHING and self._table.artefact is not None:
            return self._held()
        return None

    def _refuse_both(self) -> None:
        table = self._table
        given = {key for key in ("along", "length", "artefact", "reach") if getattr(table, key)}
        for pair in ({"along", "length"}, {"along", "artefact"}, {"along", "reach"}, {"artefact", "reach"}):
            if pair <= given and table.instrument != "straightedge":
                first, second = sorted(pair)
                with self._at(second):
                    raise DescriptionError(f"{first} and {second} exclude one another", "Give one of them")
        if table.touches and (table.instrument != "sphere" or table.sides == "mean"):
            what = "three touches are those of a sphere, and meet no side and its opposite: there is no mean of both"
            with self._at("touches"):
                raise DescriptionError(what, "Take sides out, or touches")
        for key in ("plane", "arc", "turning", "stroke", "at", "turn"):
            bar = key not in ("at", "turn")
            there = table.length is not None or table.instrument == "rtest" if bar else table.artefact is not None
            if getattr(table, key) is not None and not there:
                with self._at(key):
                    what = f"{key} belongs to {'a bar' if bar else 'an artefact'}, and the set-up has none"
                    raise DescriptionError(what, "Give its length, too" if bar else 'Give artefact = "board", too')

    def _line(self, ends: list[Vector]) -> Site:
        with self._at("along"):
            if len(ends) != 2:
                remedy = 'Give two places such as [["-300 mm", "-250 mm", "0 mm"], ["300 mm", "250 mm", "500 mm"]]'
                raise DescriptionError(f"a line has two ends, and here are {len(ends)}", remedy)
            points = np.array(ends)
            if np.linalg.norm(points[1] - points[0]) < 2e-3:
                raise DescriptionError("the ends of the line are one place", "Give two places that are apart")
            park = self._park()
            overrun = max(axis.overrun for axis in self._machine.axes if not axis.rotary)
            step = self._step("along", "length")
            line = Line(self._room(None), points, park, step, overrun)
            for name, end in (("first", 0.0), ("second", line.bounds(0).high)):
                if not line.feasible(line.poses(np.array([[end]])))[0]:
                    raise DescriptionError(f"the {name} end of the line is out of travel", self._lacking(line, end))
        x, y, z = line.direction.tolist()
        return Site(line, linear_axes(self._machine), tuple(park), "free", direction=(x, y, z))

    def _lacking(self, line: Line, end: float) -> str:
        """Say which axes lack how much at a place of a line."""
        pose = line.poses(np.array([[end]]))[0]
        return f"Let it end within the travels: {lacking(self._machine, pose)}"

    def _bar(self, length: float) -> Site:
        with self._at("stroke"):
            if not 0 < (STROKE if self._table.stroke is None else self._table.stroke) < length:
                raise DescriptionError("a stroke is above zero and below the length of the bar", 'Give "1 mm"')
        centre, owned, artefact, balls = self._centre()
        owner = f"bar of {format_quantity(length, 'mm', 6)}"
        zero = Unknown("zero", OPEN_LENGTH, owner)
        chart = self._circle(centre, length, artefact) if self._table.plane else self._sphere(centre, length, artefact)
        moving = set(linear_axes(self._machine)) | set(self._followers(chart))
        return Site(
            chart,
            tuple(sorted(moving)),
            tuple(self._park(moving)),
            "held",
            (zero, *owned, *self._tool),
            artefact,
            balls,
            centre,
            length=length,
        )

    def _followers(self, chart: Chart) -> Iterator[int]:
        if isinstance(chart, Bar):
            yield from chart.turning
        if isinstance(chart, Circle):
            yield from np.flatnonzero(chart.turning).tolist()

    def _centre(self) -> tuple[Vector, tuple[Unknown, ...], Artefact | None, tuple[int, ...]]:
        table = self._table
        if table.artefact is not None:
            artefact, balls = self._artefact()
            if len(balls) != 1:
                with self._at("ball" if table.ball else "artefact"):
                    what = f"a bar turns about one ball, and {artefact.name} has {len(balls)} here"
                    raise DescriptionError(what, f'Name one, such as ball = "{artefact.balls[0].name}"')
            return artefact.balls[balls[0]].place, unknowns_at(artefact, balls), artefact, balls
        if table.station is None:
            with self._at("length"):
                remedy = 'Write station = ["0 mm", "0 mm", "100 mm"], in the workpiece frame, or artefact = "cup"'
                raise DescriptionError("it is not said about which place the bar turns", remedy)
        place = table.station
        owner = f"centre at {', '.join(format_quantity(value, 'mm', 6) for value in place)}"
        return place, tuple(Unknown(f"station_{axis}", CUP, owner) for axis in "xyz"), None, ()

    def _circle(self, centre: Vector, length: float, artefact: Artefact | None) -> Circle:
        first, second = self._plane()
        free, cone = self._cone(artefact)
        turning = self._turning()
        whole = (0.0, math.tau)
        circle = Circle(
            self._room(artefact),
            np.array(centre),
            first,
            second,
            length,
            free,
            cone,
            whole,
            self._park(),
            turning,
            self._step("arc", "angle"),
            self._overrun(),
        )
        return self._on_arc(circle)

    def _on_arc(self, circle: Circle) -> Circle:
        if self._table.arc is None:
            with self._at("plane"):
                return replace(circle, arc=reached_arc(circle, self._table.name))
        with self._at("arc"):
            if len(self._table.arc) != 2:
                raise DescriptionError(f"{shown(self._table.arc)} has not two ends", 'Write ["0 deg", "360 deg"]')
            low, high = (parse_quantity(text, "angle") for text in self._table.arc)
            if not 0 < high - low <= 4 * math.tau:
                raise DescriptionError(f"{shown(self._table.arc)} is no arc", "Give the lower end first")
            circle = replace(circle, arc=(low, high))
            refuse_gap(circle, self._table.name)
        return circle

    def _sphere(self, centre: Vector, length: float, artefact: Artefact | None) -> Bar:
        free, cone = self._cone(artefact)
        turning = self._turned_by_moves()
        steps = (
            self._step("azimuth", "angle"),
            self._step("elevation", "angle"),
            *(self._step(self._machine.axes[k].name, "angle") for k in turning),
        )
        return Bar(
            self._room(artefact), np.array(centre), length, free, cone, turning, self._park(), steps, self._overrun()
        )

    def _overrun(self) -> float:
        return max(axis.overrun for axis in self._machine.axes if not axis.rotary)

    def _plane(self) -> tuple[Array, Array]:
        given = self._table.plane
        with self._at("plane"):
            if isinstance(given, str):
                if given not in _PLANES:
                    raise DescriptionError(f"{shown(given)} is not a plane", 'Write "xy", "yz", "zx" or two directions')
                return tuple(np.array(unit_vector(way)) for way in _PLANES[given])  # type: ignore[return-value]
            ways = [np.array(unit_vector(way)) for way in given or ()]
            if len(ways) != 2 or np.linalg.norm(np.cross(ways[0], ways[1])) < _SAME_WAY:
                raise DescriptionError(f"{shown(given)} is not a plane", "Give two directions that are not the same")
            second = ways[1] - (ways[1] @ ways[0]) * ways[0]
            return ways[0], second / np.linalg.norm(second)

    def _turning(self) -> Array:
        rates = np.zeros(len(self._machine.axes))
        for name, rate in (self._table.turning or {}).items():
            with self._at("turning", name):
                index = self._machine.index(name)
                if not self._machine.axes[index].rotary:
                    raise DescriptionError(f"{name} does not turn", "Name a rotary axis: the linear ones follow")
                rates[index] = rate
        return rates

    def _cone(self, artefact: Artefact | None) -> tuple[Array, float]:
        if artefact is None:
            return np.array([0.0, 0.0, 1.0]), _FREE_CONE
        return np.array(artefact.free), artefact.cone

    def _held(self) -> Site:
        artefact, balls = self._artefact()
        turning = self._turned_by_moves(default_all=True)
        with self._at("artefact"):
            self._refuse_no_turn(turning, artefact)
        steps = tuple(self._step(self._machine.axes[k].name, "angle") for k in turning)
        self._refuse_one_place(turning, steps)
        park, room = self._park(set(turning)), self._room(artefact)
        contact: Contact = "held" if self._table.instrument == "rtest" else "retracted"
        back = 0.0 if contact == "held" else self._table.retract or RETRACT
        free = np.array(artefact.free)
        each = tuple(
            Held(room, np.array(artefact.balls[i].place), free, artefact.cone, turning, park, steps, back)
            for i in balls
        )
        chart: Chart = each[0] if len(each) == 1 and turning else Balls(each)
        size = (Unknown(RADIUS, OPEN_RADIUS, artefact.name),) if self._table.touches else ()
        unknowns = (*unknowns_at(artefact, balls), *size, *self._tool)
        moves = tuple(sorted({*turning, *linear_axes(self._machine)}))
        return Site(chart, moves, tuple(park), contact, unknowns, artefact, balls)

    def _refuse_no_turn(self, turning: tuple[int, ...], artefact: Artefact) -> None:
        if not turning and artefact.calibrated is None:
            what = (
                "a ball that stands alone is read in many poses of the rotary axes, and here none turns: it is one pose"
            )
            remedy = "Put three or more on a board that is turned, and say how well their places on it are known"
            raise DescriptionError(what, f'{remedy}: calibrated = "0.3 mm"')

    def _artefact(self) -> tuple[Artefact, tuple[int, ...]]:
        name = self._table.artefact or ""
        with self._at("artefact"):
            if name not in self._artefacts:
                near = nearest(name, self._artefacts)
                known = ", ".join(f'"{each}"' for each in self._artefacts) or "none"
                remedy = f'Perhaps "{near}" is meant' if near else f"Known are {known}; add it under [[artefacts]]"
                raise DescriptionError(f"there is no artefact {shown(name)}", remedy)
            if not self._artefacts[name].balls:
                raise DescriptionError(f"{shown(name)} has no ball to be read", 'Add balls = { one = ["0 mm", …] }')
        table = self._table
        artefact = self._artefacts[name].put(table.at or (0.0, 0.0, 0.0), table.turn or 0.0, table.mounted)
        names = [ball.name for ball in artefact.balls]
        wanted = self._table.ball if self._table.ball is not None else names
        wanted = [wanted] if isinstance(wanted, str) else wanted
        with self._at("ball"):
            for ball in wanted:
                if ball not in names:
                    raise DescriptionError(f"{artefact.name} has no ball {shown(ball)}", f"It has {', '.join(names)}")
            if len(set(wanted)) < len(wanted) or not wanted:
                raise DescriptionError(f"{shown(wanted)} names no balls, or one twice", "Name each ball once")
        return artefact, tuple(names.index(ball) for ball in wanted)

    def _turned_by_moves(self, default_all: bool = False) -> tuple[int, ...]:
        rotary = tuple(k for k, axis in enumerate(self._machine.axes) if axis.rotary)
        if self._table.moves is None:
            return rotary if default_all else ()
        with self._at("moves"):
            indices = sorted({self._machine.index(name) for name in self._table.moves})
            linear = [self._machine.axes[k].name for k in indices if k not in rotary]
            if linear:
                what = f"{', '.join(linear)} follow{'s' if len(linear) == 1 else ''} where the tool point is held"
                raise DescriptionError(what, "Name the rotary axes that turn, or leave moves out")
            return tuple(indices)

    def _park(self, moving: Sequence[int] | set[int] = ()) -> Array:
        """Return where the axes stand that do not move: rotary ones at 0, if they can, the others in their middle."""

        def usual(axis: Axis) -> float:
            low, high = axis.travel
            return 0.0 if axis.rotary and low <= 0.0 <= high else (low + high) / 2

        places = np.array([usual(axis) for axis in self._machine.axes])
        for name, text in self._table.park.items():
            with self._at("park", name):
                index = self._machine.index(name)
                axis = self._machine.axes[index]
                if index in moving or not axis.rotary:
                    what = f"{name} is parked, but it {'turns' if axis.rotary else 'follows the tool point'} here"
                    raise DescriptionError(what, "Take it out")
                places[index] = coordinate(text, axis)
        return places

    def _step(self, key: str, dimension: str) -> float:
        text = self._table.raster.get(key)
        if text is None:
            return 0.0
        with self._at("raster", key):
            value = parse_quantity(text, "angle" if dimension == "angle" else "length")
            if value <= 0:
                raise DescriptionError(f"{shown(text)} is not above zero", "Give a step, or leave the raster out")
            return value

    def _refuse_one_place(self, turning: tuple[int, ...], steps: tuple[float, ...]) -> None:
        """Raise DescriptionError for a raster by which an axis that is to turn has one place only, or none."""
        for axis, step in zip((self._machine.axes[k] for k in turning), steps, strict=True):
            low, high = axis.travel
            if step > 0 and len(Coordinate(low, high, step).values) < 2:
                with self._at("raster", axis.name):
                    what = f"a raster of {shown(self._table.raster[axis.name])} has less than two places on {axis.name}"
                    raise DescriptionError(what, f"Give a smaller step, or leave {axis.name} out of moves")

    def _room(self, artefact: Artefact | None) -> Room:
        return Room.with_boxes(self._machine, () if artefact is None else artefact.keep_out)


def lacking(machine: Machine, pose: Array) -> str:
    """Say by how much the axes of a pose leave their travels."""
    said = []
    for axis, at in zip(machine.axes, pose, strict=True):
        low, high = axis.travel
        short = max(low - at, at - high)
        if short > 0:
            said.append(f"{axis.name} lacks {format_quantity(short, axis.unit, 3)}")
    return ", ".join(said) or "every axis is within its travel, but the tool meets a stem or what is to be kept out"
