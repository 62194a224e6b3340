"""Where a set-up is read: at the balls of an artefact, at a bar's length from a centre, or along a line."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from axiscal.description.campaign_schema import SetupTable
from axiscal.description.sights import reached_arc, refuse_gap
from axiscal.document import Document, shown
from axiscal.document.quoting import meant
from axiscal.document.validation import Stated
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import listed, said
from axiscal.machine.axis import travel_text
from axiscal.machine.kinematics import linear_axes
from axiscal.measurement.artefact import Artefact
from axiscal.measurement.charts.kinds import Balls, Bar, Circle, Line
from axiscal.measurement.charts.room import Coordinate, Room, turns
from axiscal.measurement.instruments.displacement import Length
from axiscal.measurement.setup import Setup, Unknown, Vector
from axiscal.measurement.touched import Cycle, gone_to
from axiscal.numerics import Array
from axiscal.units import format_quantity
from axiscal_core.machine import Machine

OPEN_LENGTH = 1e-3
STROKE = 1e-3
RETRACT = 0.05
CUP = 1e-4
"""m, how far the centre of a bar may be from its station: it is set to within a tenth of a millimetre."""
_FREE_CONE = math.radians(100.0)
_DIAGONAL = 1 / math.sqrt(3)
"""Geometry: the space diagonal, along which readings are planned of an instrument that has no direction."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What set-ups are described in.

    artefacts : by name
    tool : what is not known of where the tool's point is, where something turns it
    asking : readings are to be asked for, so that every set-up must say where it can be read
    anew : it is a file that can be changed, and no record of it: keys of which nothing comes are refused
    usual_doubts : zeros of which nothing is stated may wander as those of their instrument do
    printer : the probe is that of a 3D printer
    at_20 : what is found refers to 20 °C
    whole_lengths : a length between two places is one reading; in records of before it was one at each end
    """

    machine: Machine
    document: Document
    artefacts: Mapping[str, Artefact]
    tool: tuple[Unknown, ...]
    asking: bool
    anew: bool
    usual_doubts: bool
    printer: bool = False
    at_20: bool = False
    whole_lengths: bool = True


@dataclass(frozen=True)
class SiteReader(Stated[SetupTable]):
    """Reads the keys of one table that say where; every failure is placed at the key it is about.

    around : what its set-up is described in; kind : its instrument, with what is usual of it there
    """

    around: Surroundings
    kind: type[Setup]

    def sited(self) -> Setup:
        """Return the set-up where it is read; without a chart where any pose of the axes that move will do.

        Its unknowns are those of the place. Raises DescriptionError or UnitError.
        """
        if self.table.along is not None:
            return self._line(self.table.along)
        if self.kind.site == "bar" and self.table.length is not None:
            return self._bar(self.table.length)
        if self.kind.usual.contact != "free" and self.table.artefact is not None:
            return self._held()
        return self._anywhere()

    def _standing(self, moves: Sequence[int], park: Sequence[float] | Array) -> Setup:
        """Return the set-up as far as neither its place nor its unknowns matter.  moves, park : as of `Setup`"""
        table, usual = self.table, self.kind.usual
        noise = usual.noise if table.noise is None else table.noise
        return self.kind(
            name=table.name,
            machine=self.around.machine,
            direction=table.direction or (_DIAGONAL, _DIAGONAL, _DIAGONAL),
            offset=table.offset,
            moves=tuple(moves),
            park=tuple(park),
            noise=math.hypot(noise, table.resolution / math.sqrt(12.0)),
            unknowns=(),
            setup_time=usual.setup_time if table.setup_time is None else table.setup_time,
            settle=usual.settle if table.settle is None else table.settle,
            reading_time=usual.reading_time if table.reading_time is None else table.reading_time,
            raster=(0.0,) * len(park),
            approach=table.approach or usual.approach,
            station=table.station,
            at_20=self.around.at_20,
            base=table.base,
            resolution=table.resolution,
        )

    def _anywhere(self) -> Setup:
        moves = self.table.moves
        if moves == ():
            known = ", ".join(f'"{axis.name}"' for axis in self.around.machine.axes)
            remedy = "Name axes, such as moves = [{known}], or leave it out"
            raise self.misstated("moves", "nothing moves", remedy, known=known)
        moves = tuple(range(len(self.around.machine.axes))) if moves is None else moves
        return self._standing(moves, self._parked(moves))

    def _line(self, ends: tuple[Vector, Vector]) -> Setup:
        step, park = self.table.raster.get("along", 0.0), self._park()
        # nobody says how the ends of a length are met
        overrun = 0.0 if self.kind.site == "length" else self._overrun()
        line = Line.between_ends(self._room(None), np.array(ends), park, step, overrun)
        poses = line.poses(np.array([[0.0], [line.coordinates[0].high]]))
        for end, there in enumerate(line.feasible(poses)):
            if not there:
                what = "the second end of the line is out of travel"
                what = what if end else "the first end of the line is out of travel"
                lacks = lacking(self.around.machine, poses[end])
                raise self.misstated("along", what, "Let it end within the travels: {lacking}", lacking=lacks)
        x, y, z = line.direction.tolist()
        given, start = self.table.direction, None
        if issubclass(self.kind, Length):
            line, start = line.at_its_end(), tuple(poses[0].tolist())
        return replace(
            self._standing(linear_axes(self.around.machine), park),
            chart=line,
            start=start,
            direction=given or (x, y, z),
        )

    def _bar(self, length: float) -> Setup:
        centre, owned, artefact, balls = self._centre()
        owner = f"bar of {format_quantity(length, 'mm', 6)}"
        zero = Unknown("zero", OPEN_LENGTH, owner)
        plane = self.table.plane
        machine, turning = self.around.machine, self.table.turning.items()
        chart = self._circle(centre, length, artefact, plane) if plane else self._sphere(centre, length, artefact)
        turned = [machine.index(name) for name, rate in turning if rate] if plane else self._turned_by_moves()
        moving = {*linear_axes(machine), *turned}
        setup = self._standing(sorted(moving), self._park([*moving]))
        unknowns = (zero, *owned, *self.around.tool)
        setup = replace(setup, chart=chart, contact="held", unknowns=unknowns, station=centre, length=length)
        return replace(setup, artefact=artefact, balls=balls)

    def _centre(self) -> tuple[Vector, tuple[Unknown, ...], Artefact | None, tuple[int, ...]]:
        table = self.table
        if table.artefact is not None:
            artefact, balls = self._artefact()
            if len(balls) != 1:
                what = "a bar turns about one ball, and {artefact} has {count} here"
                remedy, ball = 'Name one, such as ball = "{ball}"', artefact.balls[0].name
                raise self.misstated(
                    "ball" if table.ball else "artefact",
                    what,
                    remedy,
                    artefact=artefact.name,
                    count=len(balls),
                    ball=ball,
                )
            return artefact.balls[balls[0]].place, artefact.unknowns(balls), artefact, balls
        if table.station is None:
            remedy = 'Write station = ["0 mm", "0 mm", "100 mm"], in the workpiece frame, or artefact = "cup"'
            raise self.misstated("length", "it is not said about which place the bar turns", remedy)
        place = table.station
        owner = f"centre at {', '.join(format_quantity(value, 'mm', 6) for value in place)}"
        return place, tuple(Unknown(f"station_{axis}", CUP, owner) for axis in "xyz"), None, ()

    def _circle(self, centre: Vector, length: float, artefact: Artefact | None, plane: tuple[Vector, Vector]) -> Circle:
        rates = np.array([self.table.turning.get(axis.name, 0.0) for axis in self.around.machine.axes])
        arc = Coordinate(0.0, math.tau, self._step("arc"), self._overrun() / length, not np.any(rates))
        where = self._room(artefact), self._park(), (arc,), np.array(centre), length, *self._cone(artefact)
        return self._on_arc(Circle(*where, plane=np.array(plane), rates=rates))

    def _on_arc(self, circle: Circle) -> Circle:
        if self.table.arc is None:
            with self.at_key("plane"):
                return circle.over(*reached_arc(circle, self.table.name))
        with self.at_key("arc"):
            circle = circle.over(*self.table.arc)
            refuse_gap(circle, self.table.name)
        return circle

    def _sphere(self, centre: Vector, length: float, artefact: Artefact | None) -> Bar:
        turning = self._turned_by_moves()
        steps = tuple(self._step(self.around.machine.axes[k].name) for k in turning)
        overrun, quarter = self._overrun() / length, math.pi / 2
        coordinates = (
            Coordinate(0.0, math.tau, self._step("azimuth"), overrun, endless=True),
            Coordinate(-quarter, quarter, self._step("elevation"), overrun),
            *turns(self.around.machine, turning, steps),
        )
        where = self._room(artefact), self._park(), coordinates, np.array(centre), length, *self._cone(artefact)
        return Bar(*where, turning)

    def _overrun(self) -> float:
        return max(axis.overrun for axis in self.around.machine.axes if not axis.rotary)

    def _cone(self, artefact: Artefact | None) -> tuple[Array, float]:
        if artefact is None:
            return np.array([0.0, 0.0, 1.0]), _FREE_CONE
        return np.array(artefact.free), artefact.cone

    def _held(self) -> Setup:
        artefact, balls = self._artefact()
        turning = self._turned_by_moves(default_all=True)
        with self.at_key("artefact"):
            self._refuse_no_turn(turning, artefact)
        steps = tuple(self._step(self.around.machine.axes[k].name) for k in turning)
        self._refuse_one_place(turning, steps)
        number = (Coordinate(0.0, len(balls) - 1.0, 1.0),) if len(balls) > 1 or not turning else ()
        coordinates = *number, *turns(self.around.machine, turning, steps)
        park, contact = self._park(turning), self.kind.usual.contact
        back = 0.0 if contact == "held" else self.table.retract or RETRACT
        even = self.kind.all_round  # both sides of approach: none is come from
        coming = np.array([0.0 if axis.rotary or even else axis.overrun for axis in self.around.machine.axes])
        rooms, spots = tuple(self._room(artefact, ball) for ball in balls), artefact.points[list(balls)]
        where = rooms[0], park, coordinates, spots, rooms, *self._cone(artefact), turning
        chart = Balls(*where, back, coming, self._touching(artefact))
        unknowns = (*artefact.unknowns(balls), *self.around.tool)
        setup = self._standing(sorted({*turning, *linear_axes(self.around.machine)}), park)
        return replace(setup, chart=chart, contact=contact, unknowns=unknowns, artefact=artefact, balls=balls)

    def _touching(self, artefact: Artefact) -> Callable[[Array], Array] | None:
        """Return where the axes go to touch a ball from all sides; None where they do not, or a size is not known."""
        size = artefact.diameter
        if not self.kind.all_round or size is None or self.around.machine.nose.stylus <= 0:
            return None
        return partial(gone_to, self.around.machine, Cycle((size + self.around.machine.nose.stylus) / 2))

    def _refuse_no_turn(self, turning: tuple[int, ...], artefact: Artefact) -> None:
        if not turning and artefact.calibrated is None:
            what = (
                "a ball that stands alone is read in many poses of the rotary axes, and here none turns: it is one pose"
            )
            remedy = (
                "Put three or more on a board that is turned, with how well their places are known: "
                'calibrated = "0.3 mm"'
            )
            raise DescriptionError(what, remedy)

    def _named(self) -> Artefact:
        """Return the artefact that the table names; raises DescriptionError where there is none of that name."""
        name, known = self.table.artefact or "", self.around.artefacts
        if name not in known:
            names = ", ".join(f'"{each}"' for each in known) or said("none")
            remedy = meant(name, known, said("Known are {known}; add it under [[artefacts]]", known=names))
            raise self.misstated("artefact", "there is no artefact {artefact}", remedy, artefact=shown(name))
        return known[name]

    def _artefact(self) -> tuple[Artefact, tuple[int, ...]]:
        named = self._named()
        if not named.balls:
            remedy = 'Add balls = {{ one = ["0 mm", …] }}'
            raise self.misstated("artefact", "{name} has no ball to be read", remedy, name=shown(named.name))
        table = self.table
        artefact = named.put(table.at or (0.0, 0.0, 0.0), table.turn or 0.0, table.mounted)
        names = [ball.name for ball in artefact.balls]
        wanted = self.table.ball if self.table.ball is not None else names
        wanted = [wanted] if isinstance(wanted, str) else wanted
        with self.at_key("ball"):
            for ball in wanted:
                if ball not in names:
                    what = "{artefact} has no ball {ball}"
                    raise DescriptionError(
                        what, "It has {names}", artefact=artefact.name, ball=shown(ball), names=", ".join(names)
                    )
            if len(set(wanted)) < len(wanted) or not wanted:
                raise DescriptionError("{text} names no balls, or one twice", "Name each ball once", text=shown(wanted))
        return artefact, tuple(names.index(ball) for ball in wanted)

    def _turned_by_moves(self, default_all: bool = False) -> tuple[int, ...]:
        rotary = tuple(k for k, axis in enumerate(self.around.machine.axes) if axis.rotary)
        if self.table.moves is None:
            return rotary if default_all else ()
        with self.at_key("moves"):
            linear = [self.around.machine.axes[k].name for k in self.table.moves if k not in rotary]
            if linear:
                what = "{axes} follow where the tool point is held"
                what = what if len(linear) > 1 else "{axes} follows where the tool point is held"
                remedy = "Name the rotary axes that turn, or leave moves out"
                raise DescriptionError(what, remedy, axes=", ".join(linear))
        return self.table.moves

    def _park(self, turning: Sequence[int] = ()) -> Array:
        """Return where the axes stand that do not move, where the linear ones follow: rotary ones at 0, if they can."""
        linear = (k for k, axis in enumerate(self.around.machine.axes) if not axis.rotary)
        return np.array(self._parked({*turning, *linear}, at_zero=True))

    def _parked(self, moves: Collection[int], at_zero: bool = False) -> tuple[float, ...]:
        """Return where axes stand, amid their travels unless it is said.  at_zero : rotary ones at 0, if they can"""
        places = [sum(axis.travel) / 2 for axis in self.around.machine.axes]
        for k, axis in enumerate(self.around.machine.axes):
            if at_zero and axis.rotary and axis.travel[0] <= 0.0 <= axis.travel[1]:
                places[k] = 0.0
        usual = self.kind.usual.park.items()
        own = {name: place for name, place in usual if self.around.machine.index(name) not in moves}
        for name, place in (own | self.table.park).items():
            index = self.around.machine.index(name)
            if index in moves:
                what = "{axis} is parked, but it is one of the axes that move"
                raise self.misstated(("park", name), what, "Take it out here, or take {axis} out of moves", axis=name)
            axis = self.around.machine.axes[index]
            if not axis.travel[0] <= place <= axis.travel[1]:
                what, at = '"{text}" is outside the travel of {axis}', format_quantity(place, axis.unit)
                raise self.misstated(
                    ("park", name), what, "It goes from {travel}", text=at, axis=name, travel=travel_text(axis)
                )
            places[index] = place
        return tuple(places)

    def _step(self, key: str) -> float:
        return self.table.raster.get(key, 0.0)

    def _refuse_one_place(self, turning: tuple[int, ...], steps: tuple[float, ...]) -> None:
        """Raise DescriptionError for a raster by which an axis that is to turn has one place only, or none."""
        for axis, step in zip((self.around.machine.axes[k] for k in turning), steps, strict=True):
            low, high = axis.travel
            if step > 0 and len(Coordinate(low, high, step).values) < 2:
                what = "a raster of {text} has less than two places on {axis}"
                remedy = "Give a smaller step, or leave {axis} out of moves"
                raise self.misstated(
                    ("raster", axis.name), what, remedy, text=format_quantity(step, axis.unit), axis=axis.name
                )

    def _room(self, artefact: Artefact | None, *touching: int) -> Room:
        return Room.among(self.around.machine, artefact, touching)


def lacking(machine: Machine, pose: Array) -> str:
    """Say by how much the axes of a pose leave their travels."""
    lacks = []
    for axis, at in zip(machine.axes, pose, strict=True):
        low, high = axis.travel
        short = max(low - at, at - high)
        if short > 0:
            length = format_quantity(short, axis.unit, 3)
            lacks.append(said("{axis} lacks {length}", axis=axis.name, length=length))
    if lacks:
        return listed(", ", lacks)
    return said("every axis is within its travel, but the tool meets a stem or what is to be kept out")
