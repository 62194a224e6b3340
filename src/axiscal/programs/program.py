"""From planned readings to programs: one for each set-up, in the order of the plan, with the list of its readings."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.document import shown
from axiscal.document.ports import rendered
from axiscal.exceptions import ProgramError
from axiscal.machine.kinematics import drawn_back
from axiscal.measurement.readers.csv_readings import heading
from axiscal.measurement.readers.csv_table import csv_text
from axiscal.measurement.readers.touch_log import plan_code
from axiscal.measurement.reading import Place, approach_text, columns_of
from axiscal.measurement.setup import Setup
from axiscal.programs import steps
from axiscal.programs.dialect import Dialect, filled, head
from axiscal.programs.kept_out import refuse_kept_out
from axiscal.programs.scale import ReadingTarget, target
from axiscal.programs.sphere_cycle import SphereCycle
from axiscal.programs.standing import standing
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

LONGEST = 60
"""Characters of a remark that every control shows."""


@dataclass(frozen=True, slots=True)
class Listed:
    """A reading as the program has it: coordinates as written there, mm or deg.

    number : in the plan; seconds : from the start at the first reading until the axes stand, stops not counted
    """

    number: int
    seconds: float
    setup: Setup
    axes: tuple[Axis, ...]
    coordinates: tuple[str, ...]
    approach: tuple[int, ...]

    @property
    def sides(self) -> str:
        """The approach as readings files write it: "X+ Y-"."""
        return approach_text(self.axes, self.approach)


def listing(readings: Sequence[Listed]) -> str:
    """Return the list that goes with a program: number, time, set-up, every coordinate, approach."""
    header = ["reading", "time_s", *heading(readings[0].axes, ())]
    rows = [[str(r.number), f"{r.seconds:.1f}", r.setup.name, *r.coordinates, r.sides] for r in readings]
    return csv_text([header, *rows])


def form(readings: Sequence[Listed]) -> str:
    """Return readings.csv, the last columns to be filled in for `axiscal data estimate`; parked axes stay empty."""
    values = columns_of([reading.setup for reading in readings])
    rows = [["reading", *heading(readings[0].axes, values)]]
    for each in readings:
        moving = {each.axes[k].name for k in each.setup.moves}
        at = [text if axis.name in moving else "" for axis, text in zip(each.axes, each.coordinates, strict=True)]
        sides = " ".join(side for side in each.sides.split() if side[:-1] in moving)
        rows.append([str(each.number), each.setup.name, *at, sides, *[""] * len(values)])
    return csv_text(rows)


@dataclass(frozen=True, slots=True)
class Program:
    """The program of one set-up.

    name, file_name : what the control calls it; text : ASCII; readings : its list, with where each is and when
    notes : what whoever runs it must know
    """

    name: str
    file_name: str
    text: str
    readings: tuple[Listed, ...]
    notes: tuple[str, ...]

    @property
    def listing(self) -> str:
        """The readings as CSV."""
        return listing(self.readings)


def programs(
    machine: Machine, setups: Sequence[Setup], places: Sequence[Place], dialect: Dialect, log: bool = False
) -> tuple[Program, ...]:
    """Return a program for each set-up, in the order in which the plan first uses them.

    log : programs of spheres touch them by themselves and write a log, which says by a code of which plan it is.
    Readings keep their number in the plan, from 1; set-ups say how they are driven to.  Raises ProgramError before
    anything is written.
    """
    if not places:
        raise ProgramError("the plan has no readings", "Plan at least one")
    known = {setup.name: setup for setup in setups}
    used = dict.fromkeys(place.setup for place in places)
    numbered = list(enumerate(places, start=1))
    own = {name: [each for each in numbered if each[1].setup == name] for name in used}
    writers = [_Writer(machine, dialect, _named(known, name), places, log) for name, places in own.items()]
    drafts = [writer.draft() for writer in writers]
    if log and not any(writer.touches for writer in writers):
        what = "no set-up of this plan is one that a control reads by itself"
        raise ProgramError(what, 'Leave --log out, or plan a set-up of instrument = "sphere"')
    code = plan_code([listing(readings) for _, readings in drafts])
    return tuple(
        writer.program(number, *draft, code)
        for number, (writer, draft) in enumerate(zip(writers, drafts, strict=True), start=1)
    )


def _named(known: Mapping[str, Setup], name: str) -> Setup:
    if name not in known:
        remedy = "Known are {known}"
        raise ProgramError("the plan has a set-up {name}", remedy, name=shown(name), known=", ".join(map(shown, known)))
    return known[name]


class _Writer:
    """Writes the program of one set-up in one dialect.  places : with the numbers of the readings"""

    def __init__(
        self, machine: Machine, dialect: Dialect, setup: Setup, places: Sequence[tuple[int, Place]], log: bool
    ) -> None:
        dialect.check_axes(machine.axes)
        if setup.contact == "held":
            what = "the instrument of {setup} stays in touch between readings, and a program draws the tool back"
            remedy = "Drive it with a program of your own, and give the readings to axiscal data estimate"
            raise ProgramError(what, remedy, setup=shown(setup.name))
        self._machine, self._dialect, self._setup, self._places = machine, dialect, setup, places
        self._axes = steps.ProgramAxes.from_setup(machine, setup, [dialect.decimals] * len(machine.axes))
        self.touches = log and setup.contact == "retracted" and setup.all_round

    def draft(self) -> tuple[tuple[steps.Step, ...], tuple[Listed, ...]]:
        """Return the actions of the program, and its readings."""
        run = tuple(self._steps())
        if self._setup.artefact is not None:
            refuse_kept_out(self._machine, self._setup, self._touched(), self._axes.scales, run)
        return run, tuple(self._listed(run))

    def _touched(self) -> dict[int, int]:
        """Return the ball of each reading by its number; none where no ball is read."""
        if self._setup.artefact is None or not self._setup.balls:
            return {}
        tips = self._machine.frames(np.array([place.pose for _, place in self._places])).tcp
        balls = self._setup.artefact.nearest(tips, self._setup.balls).tolist()
        return {number: ball for (number, _), ball in zip(self._places, balls, strict=True)}

    def program(self, number: int, run: Sequence[steps.Step], readings: tuple[Listed, ...], code: str) -> Program:
        setup, dialect = self._setup, self._dialect
        name = program_name(number, setup.name, dialect.longest_name)
        lines = [self._comment(text) for text in self._head()]
        told, log = {"code": code, "head": head(code)}, dialect.logging() if self.touches else None
        lines += log.opened(self._machine.axes, **told) if log else []
        lines += [line for step in run for line in self._lines(step)]
        lines += filled(log.off, readings=len(readings), **told) if log else []
        text = dialect.framed(name, number, self._machine.axes, lines)
        return Program(name, f"{name}.{dialect.suffix}", text, readings, self._notes())

    def _steps(self) -> Iterator[steps.Step]:
        setup, places = self._setup, self._places
        reading = setup.reading_time if setup.driving.dwell else None
        poses = [self._stood_at(place) for _, place in places]
        numbered = zip(places, poses, strict=True)
        targets = [target(self._axes.scales, setup.name, k, pose, place.approach) for (k, place), pose in numbered]
        read = self._cycle(dict(places)) if self.touches else None
        yield from self._axes.run_through(targets, setup, reading, read)

    def _cycle(self, places: Mapping[int, Place]) -> Callable[[ReadingTarget], Iterator[steps.Step]]:
        cycle = SphereCycle(self._machine, self._setup, self._axes)
        return lambda reached: cycle.steps(reached, places[reached.number])

    def _stood_at(self, place: Place) -> Sequence[float]:
        """Return where the axes stand at a reading: off its ball, where the probe begins."""
        setup = self._setup
        if setup.contact != "retracted":
            return place.pose
        pose: list[float] = drawn_back(self._machine, np.array([place.pose]), setup.retract)[0].tolist()
        return pose

    def _head(self) -> list[str]:
        artefact = self._setup.artefact
        put = [artefact.standing] if artefact is not None and artefact.standing != artefact.name else []
        return [
            "AXISCAL MEASURING PROGRAM",
            f"MACHINE {self._machine.name}",
            f"SET-UP {self._setup.name}",
            *put,
            f"READINGS {self._places[0][0]} TO {self._places[-1][0]}",
            "MACHINE COORDINATES IN MM AND DEG",
            *(f"{axis.name} IS THE RADIUS" for axis in self._machine.axes if axis.diameters),
            f"ORDER OF MOVES {self._axes.order}",
            *standing(self._machine, self._setup),
            *(_BY_ITSELF if self.touches else _AT_BALL if self._setup.contact == "retracted" else ()),
        ]

    def _lines(self, step: steps.Step) -> list[str]:
        match step:
            case steps.Touched():
                return self._dialect.touched(step)
            case steps.Move():
                words = [(self._machine.axes[k].name, self._axes.scales[k].written(v)) for k, v in step.to.items()]
                return [self._dialect.straight_move(words, step.feed)]
            case steps.Dwell():
                return filled(self._dialect.dwell, s=step.seconds, ms=round(step.seconds * 1000))
            case steps.Halt():
                stop = self._dialect.stopped(self._machine.axes)
                seen = (self._dialect.screen or self._dialect.comment).format(text=plain(step.text))
                return [*([seen] if step.text else []), *stop]
            case steps.Remark():
                return [self._comment(step.text)]
        assert isinstance(step, steps.Arrival)  # for the list of readings alone
        return []

    def _comment(self, text: str) -> str:
        """Return a comment; it begins with our own words, so that no name becomes a command such as (PROBEOPEN x)."""
        return self._dialect.comment.format(text=plain(text))

    def _listed(self, run: Sequence[steps.Step]) -> Iterator[Listed]:
        """Yield the readings with the time from the start at the first one, stops not counted."""
        seconds, asked = 0.0, dict(self._places)
        for step in run:
            if isinstance(step, steps.Move | steps.Dwell | steps.Touched):
                seconds += step.seconds
            elif isinstance(step, steps.Arrival):
                reached, at = step.target, step.target.position
                if self._setup.contact == "retracted":  # the pose that is read has the tool point at the ball
                    pose = zip(self._axes.scales, asked[reached.number].pose, strict=True)
                    at = tuple(number for scale, value in pose if (number := scale.nearest(value)) is not None)
                texts = tuple(scale.written(value) for scale, value in zip(self._axes.scales, at, strict=True))
                yield Listed(reached.number, seconds, self._setup, self._machine.axes, texts, reached.approach)

    def _notes(self) -> tuple[str, ...]:
        scales, clearance = self._axes.scales, self._axes.clearance
        far = [(scale, scale.above(scale.axis.overrun).quantize(scale.step)) for scale in scales]
        values = {
            "touches": self.touches,
            "retracted": self._setup.contact == "retracted",
            "order": self._axes.order,
            "clear": None if clearance is None else (scales[clearance[0]], clearance[1]),
            "overruns": ", ".join(f"{each.normalize():f} {scale.unit} on {scale.axis.name}" for scale, each in far),
        }
        return (
            *self._dialect.notes,
            *(self._dialect.logging().notes if self.touches else ()),
            *rendered("axiscal.programs", "notes.jinja", **values).splitlines(),
        )


_AT_BALL = ("AT A READING THE TOOL IS DRAWN BACK FROM ITS BALL", "RUN THE SPHERE CYCLE THEN PRESS START")
_BY_ITSELF = ("THE PROGRAM TOUCHES EACH BALL AND WRITES A LOG", "PROBE IN THE SPINDLE - SPINDLE OFF")


def plain(text: str) -> str:
    """Return at most 60 characters of A-Z 0-9 blank _ . + - ; any other character becomes _."""
    bare = unicodedata.normalize("NFKD", text.upper()).upper()
    ascii_only = "".join(c for c in bare if not unicodedata.combining(c))
    return re.sub(r"[^A-Z0-9 _.+-]", "_", ascii_only)[:LONGEST].strip()


def program_name(number: int, setup: str, longest: int) -> str:
    """Return the name of a program, which is its file's too: letters, digits, single underscores."""
    words = re.sub(r"[^A-Z0-9]+", "_", plain(setup)).strip("_")
    return f"AXISCAL_{number:02d}_{words}"[:longest].rstrip("_")
