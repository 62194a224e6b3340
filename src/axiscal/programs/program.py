"""From planned readings to programs: one for each set-up, in the order of the plan, with the list of its readings.

The files of a plan are these programs, their lists, the form for the values, and what must be known.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from axiscal.document import shown
from axiscal.document.durable import write_whole
from axiscal.document.ports import rendered
from axiscal.exceptions import ProgramError
from axiscal.machine.kinematics import drawn_back
from axiscal.measurement.bodies import parts
from axiscal.measurement.readers.csv_readings import heading
from axiscal.measurement.readers.csv_table import csv_text
from axiscal.measurement.readers.touch_log import LISTS, plan_code
from axiscal.measurement.reading import Place, approach_text, columns_of
from axiscal.measurement.setup import Setup
from axiscal.programs import steps
from axiscal.programs.dialects import Dialect, dialect, filled
from axiscal.programs.kept_out import refuse_kept_out
from axiscal.programs.scale import ReadingTarget, target
from axiscal.units import to_unit
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
    known, own = {setup.name: setup for setup in setups}, dict[str, dict[int, Place]]()
    for number, place in enumerate(places, start=1):
        own.setdefault(place.setup, {})[number] = place
    for name in own.keys() - known.keys():
        remedy, listed = "Known are {known}", ", ".join(map(shown, known))
        raise ProgramError("the plan has a set-up {name}", remedy, name=shown(name), known=listed)
    writers = [_Writer(machine, dialect, known[name], mine, log) for name, mine in own.items()]
    code = plan_code([listing(writer.readings) for writer in writers])
    if log and not any(writer.touches for writer in writers):
        what = "no set-up of this plan is one that a control reads by itself"
        raise ProgramError(what, 'Leave --log out, or plan a set-up of instrument = "sphere"')
    return tuple(writer.program(number, code) for number, writer in enumerate(writers, start=1))


class _Writer:
    """Writes the program of one set-up in one dialect.  places : by the numbers of the readings"""

    def __init__(
        self, machine: Machine, dialect: Dialect, setup: Setup, places: Mapping[int, Place], log: bool
    ) -> None:
        dialect.check_axes(machine.axes)
        if setup.contact == "held":
            what = "the instrument of {setup} stays in touch between readings, and a program draws the tool back"
            remedy = "Drive it with a program of your own, and give the readings to axiscal data estimate"
            raise ProgramError(what, remedy, setup=shown(setup.name))
        self._machine, self._dialect, self._setup, self._places = machine, dialect, setup, places
        self._axes = steps.ProgramAxes.from_setup(machine, setup, dialect.decimals)
        self._back = setup.retract if setup.contact == "retracted" else None
        self.touches = log and setup.all_round and self._back is not None

    def program(self, number: int, code: str) -> Program:
        """Return the program; number : from 1; code : of the plan."""
        setup, dialect, readings = self._setup, self._dialect, self.readings
        name, log = program_name(number, setup.name, dialect.longest_name), dialect.logging() if self.touches else None
        lines = [self._comment(text) for text in self._head()]
        lines += log.opened(self._machine.axes, code) if log else []
        lines += [line for step in self._run for line in self._lines(step)]
        lines += filled(log.off, readings=len(readings), code=code) if log else []
        text = dialect.framed(name, number, self._machine.axes, lines)
        notes = (*dialect.notes, *(log.notes if log else ()), *self._notes())
        return Program(name, f"{name}.{dialect.suffix}", text, readings, notes)

    @cached_property
    def _run(self) -> tuple[steps.Step, ...]:
        setup, scales = self._setup, self._axes.scales
        reading = setup.reading_time if setup.driving.dwell else None
        poses = np.array([place.pose for place in self._places.values()])
        stood = poses if self._back is None else drawn_back(self._machine, poses, self._back)  # where the probe begins
        targets = [
            target(scales, setup.name, number, pose, place.approach)
            for (number, place), pose in zip(self._places.items(), stood.tolist(), strict=True)
        ]
        touch = (lambda at: self._axes.touching(setup, at, self._places[at.number])) if self.touches else None
        run = tuple(self._axes.run_through(targets, setup, reading, touch))
        if setup.artefact is not None:
            balls = setup.artefact.nearest(self._machine.frames(poses).tcp, setup.balls).tolist() if setup.balls else []
            refuse_kept_out(self._machine, setup, dict(zip(self._places, balls, strict=False)), scales, run)
        return run

    @cached_property
    def readings(self) -> tuple[Listed, ...]:
        """The readings with the time from the start at the first one, stops not counted."""
        seconds, found, scales = 0.0, list[Listed](), self._axes.scales
        for step in self._run:
            if isinstance(step, steps.Move | steps.Dwell | steps.Touched):
                seconds += step.seconds
            elif isinstance(step, ReadingTarget):
                at = step.position
                if self._back is not None:  # the pose that is read has the tool point at the ball
                    pose = zip(scales, self._places[step.number].pose, strict=True)
                    at = tuple(number for scale, value in pose if (number := scale.nearest(value)) is not None)
                texts = tuple(scale.written(value) for scale, value in zip(scales, at, strict=True))
                known = self._setup, self._machine.axes, texts, step.approach
                found.append(Listed(step.number, seconds, *known))
        return tuple(found)

    def _head(self) -> Iterator[str]:
        artefact, numbers = self._setup.artefact, [*self._places]
        yield from ("AXISCAL MEASURING PROGRAM", f"MACHINE {self._machine.name}", f"SET-UP {self._setup.name}")
        if artefact is not None and artefact.standing != artefact.name:
            yield artefact.standing
        yield from (f"READINGS {numbers[0]} TO {numbers[-1]}", "MACHINE COORDINATES IN MM AND DEG")
        yield from (f"{axis.name} IS THE RADIUS" for axis in self._machine.axes if axis.diameters)
        yield f"ORDER OF MOVES {self._axes.order}"
        yield from standing(self._machine, self._setup)
        yield from _BY_ITSELF if self.touches else _AT_BALL if self._back is not None else ()

    def _lines(self, step: steps.Step) -> list[str]:
        axes = self._machine.axes
        match step:
            case steps.Touched():
                return self._dialect.touched(step)
            case steps.Move():
                words = [(axes[k].name, self._axes.scales[k].written(v)) for k, v in step.to.items()]
                return [self._dialect.straight_move(words, step.feed)]
            case steps.Dwell():
                return filled(self._dialect.dwell, s=step.seconds, ms=round(step.seconds * 1000))
            case steps.Halt():
                seen = (self._dialect.screen or self._dialect.comment).format(text=plain(step.text))
                return [*([seen] if step.text else []), *self._dialect.stopped(len(axes))]
            case steps.Remark():
                return [self._comment(step.text)]
            case ReadingTarget():  # for the list of readings alone
                return []

    def _comment(self, text: str) -> str:
        """Return a comment; it begins with our own words, so that no name becomes a command such as (PROBEOPEN x)."""
        return self._dialect.comment.format(text=plain(text))

    def _notes(self) -> list[str]:
        scales, clearance = self._axes.scales, self._axes.clearance
        far = [(scale, scale.above(scale.axis.overrun).quantize(scale.step)) for scale in scales]
        values = {
            "touches": self.touches,
            "retracted": self._back is not None,
            "order": self._axes.order,
            "clear": None if clearance is None else (scales[clearance[0]], clearance[1]),
            "overruns": ", ".join(f"{each.normalize():f} {scale.unit} on {scale.axis.name}" for scale, each in far),
        }
        return rendered("axiscal.programs", "notes.jinja", **values).splitlines()


_AT_BALL = ("AT A READING THE TOOL IS DRAWN BACK FROM ITS BALL", "RUN THE SPHERE CYCLE THEN PRESS START")
_BY_ITSELF = ("THE PROGRAM TOUCHES EACH BALL AND WRITES A LOG", "PROBE IN THE SPINDLE - SPINDLE OFF")


def standing(machine: Machine, setup: Setup) -> list[str]:
    """Return what is assumed to stand where, mm in the workpiece frame, and the size of what moves among it."""
    artefact = setup.artefact
    balls = artefact.balls if artefact is not None and artefact.diameter is not None else ()
    names = ("STYLUS", "HOLDER", "NOSE") if machine.nose.stylus > 0 else ("TOOL", "NOSE")
    values = {
        "machine": machine,
        "balls": balls,
        "boxes": () if artefact is None else artefact.keep_out,
        "unknown": artefact is not None and artefact.balls and not balls,
        "parts": [*zip(names, parts(machine), strict=False)],
        "mm": lambda lengths: " ".join(f"{to_unit(float(length), 'mm'):.1f}" for length in lengths),
    }
    return rendered("axiscal.programs", "standing.jinja", **values).splitlines()


def plain(text: str) -> str:
    """Return at most 60 characters of A-Z 0-9 blank _ . + - ; any other character becomes _."""
    bare = unicodedata.normalize("NFKD", text.upper()).upper()
    ascii_only = "".join(c for c in bare if not unicodedata.combining(c))
    return re.sub(r"[^A-Z0-9 _.+-]", "_", ascii_only)[:LONGEST].strip()


def program_name(number: int, setup: str, longest: int) -> str:
    """Return the name of a program, which is its file's too: letters, digits, single underscores."""
    words = re.sub(r"[^A-Z0-9]+", "_", plain(setup)).strip("_")
    return f"AXISCAL_{number:02d}_{words}"[:longest].rstrip("_")


def write_programs(
    machine: Machine,
    setups: Sequence[Setup],
    places: Sequence[Place],
    controller: str,
    folder: str | Path,
    log: bool = False,
) -> list[Path]:
    """Write the programs of a plan to a folder and return the files. These are a program and its list for each set-up,
    then readings.csv and README.txt.  log : the programs touch the spheres themselves and write a log.
    Raises ProgramError before the first file is touched, OSError.
    """
    made = programs(machine, setups, places, dialect(controller), log)
    own = [((each.file_name, each.text), (f"{each.name}.csv", each.listing)) for each in made]
    files = {name: text for pair in own for name, text in pair}
    lists = LISTS.format(plan_code([program.listing for program in made]))
    _refuse_other_plan(Path(folder), lists, files)
    files |= {lists: "".join(f"{program.name}.csv\n" for program in made)} if log else {}
    files["readings.csv"] = form([reading for program in made for reading in program.readings])
    files["README.txt"] = rendered("axiscal.programs", "readme.jinja", title=dialect(controller).title, made=made)
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        write_whole(Path(folder) / name, text.encode())
    return [Path(folder) / name for name in files]


def _refuse_other_plan(folder: Path, own: str, files: Collection[str]) -> None:
    """Raise ProgramError where lists of another plan would be overwritten: its logs could not be read any more."""
    for other in sorted(folder.glob(LISTS.format("*"))):
        lists = other.read_text(encoding="utf-8", errors="replace").split("\n")
        if other.name != own and (taken := next((name for name in lists if name in files), None)):
            what = "{folder} holds {taken} of another plan, whose logs are read with it"
            remedy = "Write to another folder; or take out {list} if it was never run"
            raise ProgramError(what, remedy, folder=folder, taken=shown(taken), list=other.name)
