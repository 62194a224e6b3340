"""From planned readings to programs: one for each set-up, in the order of the plan."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal

from axiscal.document import shown
from axiscal.exceptions import ProgramError
from axiscal.gcode.dialect import Dialect
from axiscal.gcode.groups import Group, groups
from axiscal.gcode.listing import Listed, listing
from axiscal.gcode.plain_words import plain, program_name
from axiscal.gcode.program_options import ProgramOptions
from axiscal.gcode.scale import AxisScale
from axiscal.gcode.steps import Arrival, Clearance, Dwell, Halt, Move, Remark, Step, run_through
from axiscal.gcode.targets import ReadingTarget, target
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.measurement.place import Place
from axiscal.measurement.setup import Setup
from axiscal.units import format_quantity


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
    machine: Machine,
    setups: Sequence[Setup],
    places: Sequence[Place],
    dialect: Dialect,
    options: ProgramOptions | None = None,
) -> tuple[Program, ...]:
    """Return a program for each set-up, in the order in which the plan first uses them.

    Readings keep their number in the plan, from 1.  Raises ProgramError before anything is written.
    """
    if not places:
        raise ProgramError("the plan has no readings", "Plan at least one")
    writer = _Writer(machine, dialect, options or ProgramOptions())
    known = {setup.name: setup for setup in setups}
    used = dict.fromkeys(place.setup for place in places)
    numbered = list(enumerate(places, start=1))
    return tuple(
        writer.program(number, _named(known, name), [(k, place) for k, place in numbered if place.setup == name])
        for number, name in enumerate(used, start=1)
    )


def _named(known: Mapping[str, Setup], name: str) -> Setup:
    if name not in known:
        raise ProgramError(f"the plan has a set-up {shown(name)}", f"Known are {', '.join(map(shown, known))}")
    return known[name]


def _refuse_contact(setup: Setup) -> None:
    """Raise ProgramError for a set-up in touch: linear axes that go before rotary ones would tear it off."""
    if setup.contact != "free":
        what = f'"{setup.name}" reads in touch, and these programs move one family of axes after another'
        remedy = "Drive it in the control's tool centre point mode (TRAORI, TCPM or M128, G43.4, M428) from plan --json"
        raise ProgramError(what, remedy)


class _Writer:
    """Writes the programs of one machine in one dialect."""

    def __init__(self, machine: Machine, dialect: Dialect, options: ProgramOptions) -> None:
        dialect.check(machine.axes)
        self._machine, self._dialect, self._options = machine, dialect, options
        self._scales = tuple(AxisScale.of(axis, dialect.decimals) for axis in machine.axes)
        self._groups = groups(machine, options)
        self._clearance = _clearance(machine, self._scales, options)

    def program(self, number: int, setup: Setup, places: Sequence[tuple[int, Place]]) -> Program:
        _refuse_contact(setup)
        dialect = self._dialect
        name = program_name(number, setup.name, dialect.longest_name)
        run = list(self._steps(setup, places))
        lines = [self._comment(text) for text in self._head(setup, places)]
        lines += [line for step in run for line in self._lines(step)]
        text = dialect.framed(name, number, self._machine.axes, lines)
        readings = tuple(self._listed(setup, run))
        return Program(name, f"{name}.{dialect.suffix}", text, readings, self._notes())

    def _steps(self, setup: Setup, places: Sequence[tuple[int, Place]]) -> Iterator[Step]:
        targets = [target(self._scales, setup.name, number, place.pose, place.approach) for number, place in places]
        reading = setup.reading_time if self._options.wait == "dwell" else None
        return run_through(targets, self._scales, self._groups, setup.settle, reading, self._clearance)

    def _head(self, setup: Setup, places: Sequence[tuple[int, Place]]) -> list[str]:
        return [
            "AXISCAL MEASURING PROGRAM",
            f"MACHINE {self._machine.name}",
            f"SET-UP {setup.name}",
            f"READINGS {places[0][0]} TO {places[-1][0]}",
            "MACHINE COORDINATES IN MM AND DEG",
            f"ORDER OF MOVES {order_text(self._groups)}",
        ]

    def _lines(self, step: Step) -> list[str]:
        match step:
            case Move():
                words = [(self._machine.axes[k].name, self._scales[k].written(v)) for k, v in step.to.items()]
                return [self._dialect.move(words, step.feed)]
            case Dwell():
                return self._dialect.dwell_s(step.seconds)
            case Halt():
                return self._dialect.stop(self._machine.axes)
            case Remark():
                return [self._comment(step.text)]
            case Arrival():
                return []

    def _comment(self, text: str) -> str:
        """Return a comment; it begins with our own words, so that no name becomes a command such as (PROBEOPEN x)."""
        return self._dialect.comment(plain(text))

    def _listed(self, setup: Setup, run: Sequence[Step]) -> Iterator[Listed]:
        """Yield the readings with the time from the start at the first one, stops not counted."""
        seconds = 0.0
        for step in run:
            if isinstance(step, Move | Dwell):
                seconds += step.seconds
            elif isinstance(step, Arrival):
                yield self._row(setup, step.target, seconds)

    def _row(self, setup: Setup, reached: ReadingTarget, seconds: float) -> Listed:
        texts = [scale.written(value) for scale, value in zip(self._scales, reached.position, strict=True)]
        return Listed(reached.number, seconds, setup, self._machine.axes, tuple(texts), reached.approach)

    def _notes(self) -> tuple[str, ...]:
        return (
            *self._dialect.notes,
            "Coordinates are those of the machine description; its zeros and signs must be the control's own.",
            f"At every place the axes move in this order: {order_text(self._groups)}.{self._clear()} Nothing is known "
            "here of what stands in the way: watch the first run at reduced feed.",
            "Jog the axes only at the first two stops, before and at the mounting of the instrument; from there the "
            "program goes to its start again. At a reading nothing may be moved by hand.",
            f"The longest overrun is {self._overruns()}; no coordinate leaves the travel.",
        )

    def _clear(self) -> str:
        if self._clearance is None:
            return ""
        scale = self._scales[self._clearance[0]]
        return f" {scale.axis.name} goes to {self._clearance[1]} {scale.unit} before others move, and at the end."

    def _overruns(self) -> str:
        def text(axis: Axis, step: Decimal, scale: AxisScale) -> str:
            return f"{scale.above(axis.overrun).quantize(step).normalize():f} {scale.unit} on {axis.name}"

        return ", ".join(text(scale.axis, scale.step, scale) for scale in self._scales)


def _clearance(machine: Machine, scales: Sequence[AxisScale], options: ProgramOptions) -> Clearance | None:
    """Return the axis that goes clear and where; raises ProgramError for a place outside its travel."""
    if options.clearance is None:
        return None
    name, place = options.clearance
    index = machine.index(name)
    number = scales[index].nearest(place)
    if number is None:
        unit, travel = scales[index].unit, f"{scales[index].low} to {scales[index].high}"
        what = f"{name} is to go clear at {format_quantity(place, unit)}, outside its travel"
        raise ProgramError(what, f"Choose a place within {travel} {unit}")
    return index, number


def order_text(order: Sequence[Group]) -> str:
    """Return the groups as words: "X Y Z then A C"."""
    return " then ".join(" ".join(group.names) for group in order)
