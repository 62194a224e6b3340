"""Random machines and plans as programs, and a judge who knows only the plan and what the machine would do."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from axiscal.machine.axis import iso_axis
from axiscal.machine.motion import Driving
from axiscal.measurement.instruments.displacement import Probe
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from axiscal.programs import Program, dialect, programs
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine
from tests.programs.readers import (
    READERS,
    Event,
    Halt,
    Mark,
    Move,
    Wait,
    canonical_calls,
    read_canonical,
)

HOSTILE = (
    "laser along X",
    ") G0 X99999 (",
    "a\nG0 Z-500\nM3 S9000",
    "PROBEOPEN stolen.txt",
    "msg, PRINT, DEBUG, LOGOPEN,x",
    "%\nO0001\nT1 M6",
    '"; M30 ~ L Z-999 FMAX',
    "µ-Taster № 3 ﬀ ß",
    "../../etc/passwd",
    "[#5021] o100 sub",
    "=cmd|' /C calc'!A0",
    "x" * 300,
    " ",
)


@dataclass(frozen=True)
class Plan:
    """A machine and what is to be measured on it."""

    machine: Machine
    setups: tuple[Setup, ...]
    places: tuple[Place, ...]

    def programs(self, controller: str) -> tuple[Program, ...]:
        """Return the plan as programs."""
        return programs(self.machine, self.setups, self.places, dialect(controller))


def random_plan(rng: np.random.Generator, letters: str = "XYZABC") -> Plan:
    """Return readings all over a random machine, some at the ends of its travel, with room for every approach."""
    return plan_on(random_machine(rng, letters), rng)


def random_machine(rng: np.random.Generator, letters: str = "XYZABC") -> Machine:
    """Return a machine of up to six of these axes."""
    count = int(rng.integers(1, min(len(letters), 6) + 1))
    axes = tuple(_axis(rng, str(name)) for name in rng.permutation(list(letters))[:count])
    return Machine(axes, tool=0.1, name=str(rng.choice(HOSTILE)))


def plan_on(machine: Machine, rng: np.random.Generator) -> Plan:
    """Return readings all over a machine."""
    axes = machine.axes
    driving = _driving(rng, axes)
    setups = [replace(_setup(rng, axes, number), driving=driving) for number in range(int(rng.integers(1, 3)))]
    places = [_place(rng, axes, setups[int(rng.integers(len(setups)))]) for _ in range(rng.integers(1, 13))]
    return Plan(machine, tuple(setups), tuple(places))


def _axis(rng: np.random.Generator, name: str) -> Axis:
    if name in "ABC":
        low, length = rng.choice([0.0, -math.pi, rng.uniform(-3, 1)]), rng.choice([math.tau, rng.uniform(0.2, 6)])
        speed = float(rng.uniform(0.1, 5))
        return iso_axis(name, True, (float(low), float(low + length)), speed, overrun=_overrun(rng, length))
    low, length = rng.uniform(-1, 0.3), 10 ** rng.uniform(-2, 0.5)
    low, length = (low, length) if rng.random() < 0.5 else (round(low, 3), round(length, 2))
    speed = float(rng.uniform(0.01, 3))
    return iso_axis(name, False, (float(low), float(low + length)), speed, overrun=_overrun(rng, length))


def _overrun(rng: np.random.Generator, length: float) -> float | None:
    return None if rng.random() < 0.5 else float(length * rng.uniform(0.001, 0.2))


def _driving(rng: np.random.Generator, axes: tuple[Axis, ...]) -> Driving:
    clear = axes[int(rng.integers(len(axes)))]
    return Driving(
        clearance=None if rng.random() < 0.5 else (clear.name, float(rng.uniform(*clear.travel))),
        dwell=bool(rng.random() < 0.5),
    )


def _setup(rng: np.random.Generator, axes: tuple[Axis, ...], number: int) -> Setup:
    park = tuple(sum(axis.travel) / 2 for axis in axes)
    settle, reading = float(rng.choice([0.001, 0.5, 1.2345, 60, 75])), float(rng.choice([0.0, 3.0, 200.0]))
    name = f"{rng.choice(HOSTILE)}{number or ''}"
    every = tuple(range(len(axes)))
    machine, still = Machine(axes, tool=0.0), (0.0,) * len(axes)
    return Probe(name, machine, (1, 0, 0), every, park, 1e-6, (), 0, settle, reading, still, "both")


def _place(rng: np.random.Generator, axes: tuple[Axis, ...], setup: Setup) -> Place:
    pose, approach = [], []
    for axis in axes:
        side = int(rng.integers(-1, 2))
        room = axis.overrun if side else 0.0
        low, high = axis.travel[0] + room * (side > 0), axis.travel[1] - room * (side < 0)
        value = float(rng.choice([rng.uniform(low, high), low, high]))
        if axis.cyclic and axis.travel[0] in (0.0, -math.pi) and rng.random() < 0.1:
            value = axis.travel[0 if side > 0 else 1]
        pose.append(value)
        approach.append(side)
    return Place(setup.name, tuple(pose), tuple(approach))


@dataclass
class Judge:
    """Follows one program and collects what it should not have done."""

    plan: Plan
    setup: Setup
    decimals: int
    faults: list[str] = field(default_factory=list)
    at: dict[str, float] = field(default_factory=dict)
    run: dict[str, float] = field(default_factory=dict)
    """How far each axis came without turning back, with its sign."""

    def follow(self, events: list[Event]) -> list[str]:
        """Return what is wrong with what a program does."""
        first, *rest = _pieces(events)
        wanted = [(k, place) for k, place in enumerate(self.plan.places, 1) if place.setup == self.setup.name]
        if [mark.number for mark, _ in rest if mark] != [k for k, _ in wanted]:
            return [f"readings {[mark for mark, _ in rest]}"]
        self._start(first[1])
        for (_, place), (_, piece) in zip(wanted, rest, strict=True):
            self._reading(place)
            self._pause(piece)
            self._moves(piece)
        return self.faults

    def _start(self, events: list[Event]) -> None:
        names = {axis.name for axis in self.plan.machine.axes}
        halts = [place for place, event in enumerate(events) if event == Halt()]
        between = [event for event in events[: halts[-1]] if isinstance(event, Move)]
        if len(halts) != 2 or halts[0] != 0 or not between or any(isinstance(event, Wait) for event in events):
            self.faults.append("the program does not begin with two stops and the way to the start")
        for move in between:
            self._within(move)
            self.at.update(move.to)
        if names != set(self.at):
            self.faults.append("an axis is not sent to the start")
        self._moves(events[halts[-1] :])

    def _reading(self, place: Place) -> None:
        for axis, value, side in zip(self.plan.machine.axes, place.pose, place.approach, strict=True):
            planned, low, high, overrun = (_written(axis, v) for v in (value, *axis.travel, self._overrun(axis)))
            here, step = self.at[axis.name], 10.0**-self.decimals
            off = abs(here - planned)
            off = min(off, abs(off - 360)) if axis.cyclic else off
            if off > step:
                self.faults.append(f"{axis.name} reads at {here} instead of {planned}")
            room = here - low if side > 0 else high - here
            if side and self.run.get(axis.name, 0.0) * side < min(overrun, room) - 2 * step:
                self.faults.append(f"{axis.name} comes to {here} over {self.run.get(axis.name)} instead of {overrun}")

    def _overrun(self, axis: Axis) -> float:
        asked = axis.overrun
        return min(math.radians(1) if axis.rotary else 1e-3, axis.length / 100) if asked is None else asked

    def _pause(self, events: list[Event]) -> None:
        waits = [event.seconds for event in events if isinstance(event, Wait)]
        stop = not self.setup.driving.dwell
        wanted = self.setup.settle + (0 if stop else self.setup.reading_time)
        if abs(sum(waits) - wanted) > 1e-3 * len(waits) or any(not 0 <= w <= 60 for w in waits):
            self.faults.append(f"waits {waits} instead of {wanted}")
        still = [event for event in events if not isinstance(event, Move)]
        if events[: len(still)] != still or still[len(waits) :] != [Halt()] * stop:
            self.faults.append(f"at a reading: {events}")

    def _moves(self, events: list[Event]) -> None:
        for event in events:
            if isinstance(event, Move):
                self._move(event)

    def _within(self, move: Move) -> None:
        for axis in self.plan.machine.axes:
            low, high = (_written(axis, end) for end in axis.travel)
            if not low - 1e-9 <= move.to.get(axis.name, low) <= high + 1e-9:
                self.faults.append(f"{axis.name} goes to {move.to[axis.name]}, travel {low} to {high}")

    def _move(self, move: Move) -> None:
        ways = {name: to - self.at[name] for name, to in move.to.items() if name in self.at}
        ways = {name: way for name, way in ways.items() if way}
        known = [axis for axis in self.plan.machine.axes if axis.name in move.to]
        self._within(move)
        length = math.hypot(*ways.values())
        moving = [axis for axis in known if axis.name in ways]
        if len({_family(axis) for axis in moving}) > 1:
            self.faults.append(f"{[axis.name for axis in moving]} move together")
        for axis in moving:
            speed = move.feed * abs(ways[axis.name]) / length / 60
            if not 0 < speed <= _written(axis, axis.speed) * (1 + 1e-9):
                self.faults.append(f"{axis.name} moves at {speed}")
            if axis.rotary and abs(ways[axis.name]) > 150:
                self.faults.append(f"{axis.name} turns by {ways[axis.name]} at once")
        for name, way in ways.items():
            self.run[name] = way + (self.run.get(name, 0.0) if self.run.get(name, 0.0) * way > 0 else 0.0)
        self.at.update(move.to)


def _pieces(events: list[Event]) -> list[tuple[Mark | None, list[Event]]]:
    """Return the events before the first reading, then those from each reading to the next."""
    pieces: list[tuple[Mark | None, list[Event]]] = [(None, [])]
    for event in events:
        if isinstance(event, Mark):
            pieces.append((event, []))
        else:
            pieces[-1][1].append(event)
    return pieces


def _family(axis: Axis) -> int:
    return next(k for k, letters in enumerate(("XYZ", "UVW", "ABC")) if axis.letter in letters)


def _written(axis: Axis, value: float) -> float:
    return math.degrees(value) if axis.rotary else value * 1000


def setups_of(plan: Plan) -> list[Setup]:
    """Return the set-ups in the order of their programs."""
    known = {setup.name: setup for setup in plan.setups}
    return [known[name] for name in dict.fromkeys(place.setup for place in plan.places)]


def interpreted(plan: Plan, folder: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield for each program how many moves LinuxCNC's interpreter makes of it, and what is wrong with them."""
    at = {axis.name: 0.0 for axis in plan.machine.axes}
    for setup, program in zip(setups_of(plan), plan.programs("linuxcnc"), strict=True):
        judge = Judge(plan, setup, 4, at=dict(at))
        yield judged(program.text, lambda text: read_canonical(canonical_calls(text, folder)), judge)


def read_back(plan: Plan, controller: str) -> Iterator[tuple[int, list[str]]]:
    """Yield for each program how many moves the reader of its dialect finds, and what is wrong with them."""
    decimals = 3 if controller == "fanuc" else 4
    for setup, program in zip(setups_of(plan), plan.programs(controller), strict=True):
        yield judged(program.text, READERS[controller], Judge(plan, setup, decimals))


def judged(text: str, read: Callable[[str], list[Event]], judge: Judge) -> tuple[int, list[str]]:
    """Return how many moves a reader finds in a program, and what is wrong with it."""
    try:
        events = read(text)
    except AssertionError as refused:
        return 0, [f"refused: {refused}"]
    return sum(isinstance(event, Move) for event in events), judge.follow(events)
