"""Where a set-up is read: at the balls of an artefact, at a bar's length from a centre, or along a line."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from axiscal.description.campaign_schema import SetupTable
from axiscal.description.fields import within_travel
from axiscal.description.sights import lacking, reached_arc, refuse_gap
from axiscal.document import Document, shown
from axiscal.document.quoting import meant
from axiscal.document.validation import Stated
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine.kinematics import linear_axes
from axiscal.measurement.artefact import CONE, Artefact
from axiscal.measurement.charts.kinds import FINEST_PLACE, Balls, Bar, Circle, Line
from axiscal.measurement.charts.room import Coordinate, Room
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
_DIAGONAL = (1 / math.sqrt(3),) * 3
"""Geometry: the space diagonal, along which readings are planned of an instrument that has no direction."""
_USUAL = "noise", "setup_time", "settle", "reading_time", "approach"
"""Figures of a set-up that its instrument has where they are not stated."""


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

    @property
    def machine(self) -> Machine:
        """The machine that the set-up stands on."""
        return self.around.machine

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

    def _standing(self, moves: Iterable[int], park: Iterable[float], **placed: Any) -> Setup:
        """Return the set-up but for its own unknowns.  moves, park, placed : fields of `Setup`"""
        table, usual = self.table, self.kind.usual
        said = ("name", "offset", "station", "stations", "base", "resolution")
        fields: dict[str, Any] = {key: getattr(table, key) for key in said}
        for key in _USUAL:
            fields[key] = getattr(usual if getattr(table, key) is None else table, key)
        fields["noise"] = math.hypot(fields["noise"], table.resolution / math.sqrt(12.0))
        fields |= {"direction": table.direction or _DIAGONAL, "unknowns": (), "raster": (0.0,) * len(self.machine.axes)}
        fields |= {"at_20": self.around.at_20, "retract": table.retract or RETRACT} | placed
        return self.kind(machine=self.machine, moves=tuple(moves), park=tuple(park), **fields)

    def _anywhere(self) -> Setup:
        moves = self.table.moves
        if moves == ():
            known = ", ".join(f'"{axis.name}"' for axis in self.machine.axes)
            remedy = "Name axes, such as moves = [{known}], or leave it out"
            raise self.misstated("moves", "nothing moves", remedy, known=known)
        moves = tuple(range(len(self.machine.axes))) if moves is None else moves
        return self._standing(moves, self._parked(moves))

    def _line(self, ends: tuple[Vector, Vector]) -> Setup:
        overrun = 0.0 if self.kind.site == "length" else self._overrun()  # nobody says how ends of a length are met
        far = math.dist(*ends)
        along = Coordinate(0.0, far, self._step("along"), overrun, finest=FINEST_PLACE)
        line = Line(Room.empty(self.machine), self._park(), (along,), np.array(ends))
        poses = line.poses(np.array([[0.0], [far]]))
        if len(out := poses[~line.feasible(poses)]):
            raise self.misstated("along", "an end of the line is out of travel", lacking(line, out))
        placed = {"chart": line, "direction": self.table.direction or tuple(line.direction.tolist())}
        if issubclass(self.kind, Length):
            second = replace(line, coordinates=(Coordinate(far, far, far),))
            placed |= {"chart": second, "start": tuple(poses[0].tolist())}
        return self._standing(linear_axes(self.machine), line.park, **placed)

    def _bar(self, length: float) -> Setup:
        centre, owned, artefact, balls = self._centre()
        zero, table = Unknown("zero", OPEN_LENGTH, f"bar of {format_quantity(length, 'mm', 6)}"), self.table
        rates = np.array([table.turning.get(axis.name, 0.0) for axis in self.machine.axes])
        turning = tuple(np.flatnonzero(rates).tolist()) if table.plane else self._turned_by_moves()
        where = Room.among(self.machine, artefact), self._park(turning)
        bar, overrun = (np.array(centre), length, *_free(artefact)), self._overrun() / length
        if table.plane:
            arc = Coordinate(0.0, math.tau, self._step("arc"), overrun)
            chart: Bar = self._on_arc(Circle(*where, (arc,), *bar, plane=np.array(table.plane), rates=rates))
        else:
            quarter = math.pi / 2
            azimuth = Coordinate(0.0, math.tau, self._step("azimuth"), overrun, endless=True)
            elevation = Coordinate(-quarter, quarter, self._step("elevation"), overrun)
            chart = Bar(*where, (azimuth, elevation, *self._turns(turning)), *bar, turning)
        placed = {"chart": chart, "contact": "held", "unknowns": (zero, *owned, *self.around.tool), "station": centre}
        placed |= {"length": length, "artefact": artefact, "balls": balls}
        return self._standing(sorted({*linear_axes(self.machine), *turning}), where[1], **placed)

    def _centre(self) -> tuple[Vector, tuple[Unknown, ...], Artefact | None, tuple[int, ...]]:
        place = self.table.station
        if self.table.artefact is not None:
            artefact, balls = self._artefact()
            if len(balls) != 1:
                what, key = "a bar turns about one ball, and {artefact} has {count} here", "artefact"
                named = {"artefact": artefact.name, "count": len(balls), "ball": artefact.balls[0].name}
                raise self.misstated(
                    "ball" if self.table.ball else key, what, 'Name one, such as ball = "{ball}"', **named
                )
            return artefact.balls[balls[0]].place, _unknowns_at(artefact, balls), artefact, balls
        if place is None:
            remedy = 'Write station = ["0 mm", "0 mm", "100 mm"], in the workpiece frame, or artefact = "cup"'
            raise self.misstated("length", "it is not said about which place the bar turns", remedy)
        owner = f"centre at {', '.join(format_quantity(value, 'mm', 6) for value in place)}"
        return place, tuple(Unknown(f"station_{axis}", CUP, owner) for axis in "xyz"), None, ()

    def _on_arc(self, circle: Circle) -> Circle:
        """Return a circle over the arc that is stated, else over the longest one that is reached."""
        asked = self.table.arc
        with self.at_key("plane" if asked is None else "arc"):
            if asked is None:
                return circle.over(*reached_arc(circle, self.table.name))
            refuse_gap(circle, asked, self.table.name)
            return circle.over(*asked)

    def _overrun(self) -> float:
        return max(axis.overrun for axis in self.machine.axes if not axis.rotary)

    def _held(self) -> Setup:
        artefact, balls = self._artefact()
        turning = self._turned_by_moves(default_all=True)
        if not turning and artefact.calibrated is None:
            what = "a ball alone is read in many poses of the rotary axes, and here none turns: it is one pose"
            remedy = 'Put three or more on a board, with how well their places are known: calibrated = "0.3 mm"'
            raise self.misstated("artefact", what, remedy)
        turns = self._turns(turning)
        for k, turn in zip(turning, turns, strict=True):
            if turn.step > 0 and len(turn.values) < 2:
                name, what = self.machine.axes[k].name, "{axis} has less than two places on its raster"
                raise self.misstated(("raster", name), what, "Give a smaller step, or take it out", axis=name)
        number = (Coordinate(0.0, len(balls) - 1.0, 1.0),) if len(balls) > 1 or not turning else ()
        park, contact = self._park(turning), self.kind.usual.contact
        back = 0.0 if contact == "held" else self.table.retract or RETRACT
        even = self.kind.all_round  # both sides of approach: none is come from
        coming = np.array([0.0 if axis.rotary or even else axis.overrun for axis in self.machine.axes])
        rooms = tuple(Room.among(self.machine, artefact, (ball,)) for ball in balls)
        spots = artefact.points[list(balls)]
        where = rooms[0], park, (*number, *turns), spots, rooms, *_free(artefact), turning
        chart, moves = Balls(*where, back, coming, self._touching(artefact)), {*turning, *linear_axes(self.machine)}
        unknowns = (*_unknowns_at(artefact, balls), *self.around.tool)
        placed = {"chart": chart, "contact": contact, "unknowns": unknowns, "artefact": artefact, "balls": balls}
        return self._standing(sorted(moves), park, **placed)

    def _turns(self, turning: Sequence[int]) -> tuple[Coordinate, ...]:
        """Return the coordinates of rotary axes, each over its travel."""
        axes = [self.machine.axes[k] for k in turning]
        return tuple(Coordinate(*axis.travel, self._step(axis.name), axis.overrun) for axis in axes)

    def _touching(self, artefact: Artefact) -> Callable[[Array], Array] | None:
        """Return where the axes go to touch a ball from all sides; None where they do not, or a size is not known."""
        size, stylus = artefact.diameter, self.machine.nose.stylus
        if not self.kind.all_round or size is None or stylus <= 0:
            return None
        return partial(gone_to, self.machine, Cycle((size + stylus) / 2))

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
        wanted = names if table.ball is None else [table.ball] if isinstance(table.ball, str) else table.ball
        with self.at_key("ball"):
            for ball in (each for each in wanted if each not in names):
                what, known = "{artefact} has no ball {ball}", ", ".join(names)
                raise DescriptionError(what, "It has {names}", artefact=artefact.name, ball=shown(ball), names=known)
            if len(set(wanted)) < len(wanted) or not wanted:
                raise DescriptionError("{text} names no balls, or one twice", "Name each ball once", text=shown(wanted))
        return artefact, tuple(names.index(ball) for ball in wanted)

    def _turned_by_moves(self, default_all: bool = False) -> tuple[int, ...]:
        rotary = tuple(k for k, axis in enumerate(self.machine.axes) if axis.rotary)
        if self.table.moves is None:
            return rotary if default_all else ()
        with self.at_key("moves"):
            linear = [self.machine.axes[k].name for k in self.table.moves if k not in rotary]
            if linear:
                what = "{axes} follow where the tool point is held"
                what = what if len(linear) > 1 else "{axes} follows where the tool point is held"
                remedy = "Name the rotary axes that turn, or leave moves out"
                raise DescriptionError(what, remedy, axes=", ".join(linear))
        return self.table.moves

    def _park(self, turning: Sequence[int] = ()) -> Array:
        """Return where the axes stand that do not move, where the linear ones follow: rotary ones at 0, if they can."""
        return np.array(self._parked({*turning, *linear_axes(self.machine)}, at_zero=True))

    def _parked(self, moves: Collection[int], at_zero: bool = False) -> tuple[float, ...]:
        """Return where axes stand, amid their travels unless it is said.  at_zero : rotary ones at 0, if they can"""
        axes, usual = self.machine.axes, self.kind.usual.park.items()
        near = [at_zero and axis.rotary and axis.travel[0] <= 0.0 <= axis.travel[1] for axis in axes]
        places = [0.0 if zero else sum(axis.travel) / 2 for axis, zero in zip(axes, near, strict=True)]
        own = {name: place for name, place in usual if self.machine.index(name) not in moves}
        for name, place in (own | self.table.park).items():
            index, axis = self.machine.index(name), self.machine.axis(name)
            if index in moves:
                what = "{axis} is parked, but it is one of the axes that move"
                raise self.misstated(("park", name), what, "Take it out here, or take {axis} out of moves", axis=name)
            with self.at_key("park", name):
                places[index] = within_travel(place, axis)
        return tuple(places)

    def _step(self, key: str) -> float:
        return self.table.raster.get(key, 0.0)


def _free(artefact: Artefact | None) -> tuple[Array, float]:
    """Return where balls are free, (3,), and the cone about it, rad; upwards where there is no artefact."""
    return (np.array([0.0, 0.0, 1.0]), CONE) if artefact is None else (np.array(artefact.free), artefact.cone)


def _unknowns_at(artefact: Artefact, balls: tuple[int, ...]) -> tuple[Unknown, ...]:
    """Return what set-ups at some balls of an artefact leave open of where these are."""
    each = [(artefact.balls[i].name, axis) for i in balls for axis in "xyz"]
    if artefact.calibrated is None:
        return tuple(Unknown(f"{ball}_{axis}", artefact.placed, artefact.standing) for ball, axis in each)
    whole = [Unknown(f"place_{axis}", artefact.placed, artefact.standing) for axis in "xyz"]
    whole += [Unknown(f"turn_{axis}", artefact.turned, artefact.standing) for axis in "xyz"]
    whole += [Unknown("scale", artefact.scale, artefact.name)] if artefact.scale > 0 else []
    return (*whole, *(Unknown(f"{ball}_{axis}", artefact.calibrated, artefact.name) for ball, axis in each))
