"""Readings of spheres by the probe of a machine that runs: the way, the touches, and what ends the run.

Before the first move of somebody's machine stand conditions, each a refusal in one sentence.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from typing import Any

import numpy as np

from axiscal.campaign.sources.source import Answer, Request, Skip, at_the_terminal
from axiscal.document import shown
from axiscal.exceptions import InputError, SourceError, TravelError
from axiscal.language.spoken import said
from axiscal.machine.axis import travel_text
from axiscal.machine.kinematics import drawn_back
from axiscal.measurement.reading import Place
from axiscal.measurement.touched import cycle_of, met_from, read_as
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.live.connection import Connection
from axiscal.ports.linuxcnc.live.in_force import InForce
from axiscal.programs.kept_out import refuse_kept_out
from axiscal.programs.scale import Decimals, ReadingTarget, exact, target
from axiscal.programs.steps import Move, ProgramAxes, Step, Touched
from axiscal.units import format_quantity, from_unit
from axiscal_core.machine import Machine

_DECIMALS = 6
"""Of mm and deg: a nanometre is nothing to any machine."""
_FASTEST = 2000
"""mm/min or deg/min, at most."""
_SLOWER = 4
"""The first run goes at a quarter of every feed."""
_STRAYED = 0.01
"""mm or deg by which axes may stand off where the last reading left them."""
_ABOVE = 20e-3
"""m over the ball, where everything is done once without touching."""
_BY_HAND = 120.0
"""s in which somebody presses the stylus."""
_SHORT = Decimal(1)
"""mm: LinuxCNC refuses to look for a contact on a way of 0.25 mm."""
_FAR = 3.0
"""mm from where a side is expected: a ball is set up nearer, and less than the 4 mm that a touch goes past."""


class LiveSource:
    """A LinuxCNC that runs, looked at before the first reading and before each.

    in_force : what is to compensate it; asked : asks whoever stands at the machine and returns the answer
    """

    def __init__(
        self, connection: Connection, machine: Machine, in_force: InForce, asked: Callable[[str], str] | None = None
    ) -> None:
        self._line, self._machine, self._in_force = connection, machine, in_force
        self._asked = asked or at_the_terminal
        self._placed, self._singly = "", True
        self._standing: tuple[str, Decimals] | None = None
        try:
            refuse(connection.status(), machine, in_force)
            self._refuse_untouched()
        except BaseException:
            self.close()
            raise

    def read(self, request: Request) -> Answer | Skip:
        """Go to the ball, touch it and return the three values; a ball that no way leads to and round is skipped.

        Raises SourceError, and then the machine stands.
        """
        try:
            return self._read(request)
        except BaseException as failure:
            self._line.stop()
            if isinstance(failure, InputError) and not isinstance(failure, SourceError):
                raise SourceError(failure.what, failure.remedy) from failure
            raise

    def close(self) -> None:
        """Let go of LinuxCNC: it stands where it is."""
        self._line.close()

    def _read(self, request: Request) -> Answer | Skip:
        setup = request.setup
        if not setup.all_round:
            what = "{setup} is of instrument {instrument}, and a probe in the spindle reads spheres"
            remedy = 'Let a campaign that LinuxCNC reads by itself have set-ups of instrument = "sphere"'
            raise SourceError(what, remedy, setup=shown(setup.name), instrument=setup.instrument)
        cycle_of(self._machine, setup)  # says what is not known of the ball
        self._refuse_unfit()
        placed = "" if setup.artefact is None else setup.artefact.standing
        anew = placed != self._placed
        standing = None if anew else self._standing
        try:
            way = _WayToBall(self._machine, request)
            to, touching = way.to(standing), [*way.touches()]
            way.refuse_bodies(to, standing, touching)
            trial = way.trial() if anew else []
        except TravelError as impossible:  # nothing has moved
            return Skip(impossible.what)
        if anew and self._standing:  # out of the way, until the artefact is put down at its next place
            here = self._standing[1]
            self._go([*way.axes.along(here, [way.axes.cleared(here)])])
            self._standing, self._singly = None, True
            self._confirm(said("Put it down: {artefact}. Enter goes on, stop ends: ", artefact=placed))
            self._refuse_unfit()
        self._try(trial)
        self._placed = placed
        self._go(to)
        hits = [self._touch(step, way) for step in self._between(way, touching)]
        self._in_force.refuse(self._line.status())  # what somebody switched meanwhile has spoilt the touches
        self._standing = setup.name, way.target.position
        pose = np.array(request.pose)
        value, *others = read_as(self._machine, setup, pose, hits, met_from(self._machine, pose))
        return Answer(value, others=tuple(others), live=True)

    def _between(self, way: _WayToBall, steps: Sequence[Step]) -> Iterator[Touched]:
        """Make the moves and yield the touches.  A move beside the ball ends, and the run, where it meets anything."""
        standing = dict(enumerate(way.target.position))
        for step in steps:
            if isinstance(step, Touched):
                yield step
                continue
            assert isinstance(step, Move)
            far = max(abs(standing[k] - value) for k, value in step.to.items())
            answer = self._moved("G53 G1" if far < _SHORT else "G38.3", step)
            if far >= _SHORT and answer["tripped"]:
                what = "beside the ball of reading {number} the probe met something"
                remedy = "Look where the ball stands: it is looked for within {most:g} mm"
                raise SourceError(what, remedy, number=way.target.number, most=_FAR)
            standing |= step.to

    def _go(self, steps: Sequence[Step], slow: int = 1) -> None:
        for step in steps:
            assert isinstance(step, Move)
            self._moved("G53 G1", step, slow)

    def _moved(self, kind: str, step: Move, slow: int = 1) -> dict[str, Any]:
        names = [self._machine.axes[k].name for k in step.to]
        return self._sent(kind, names, [f"{value:f}" for value in step.to.values()], min(step.feed, _FASTEST), slow)

    def _sent(self, kind: str, axes: Sequence[str], to: Sequence[str], feed: int, slow: int = 1) -> dict[str, Any]:
        words = " ".join(map("".join, zip(axes, to, strict=True)))
        return self._line.line(f"{kind} {words} F{max(1, feed // slow)}")

    def _touch(self, step: Touched, way: _WayToBall) -> Array:
        """Touch one side, fast and then slowly, and return the pose (q,) in which it was met."""
        expected = way.expected(step)
        told: dict[str, Any] = {"touch": step.touch, "reading": step.reading}
        for feed in (step.fast, step.slow):
            answer = self._sent("G38.3", step.letters, step.into, feed)
            if not answer["tripped"]:
                what = "at touch {touch} of reading {reading} the probe met nothing"
                remedy = "Look where the ball stands: it is looked for within {most:g} mm"
                raise SourceError(what, remedy, most=_FAR, **told)
            status = self._line.status()
            at = {a.name: v for a, v in zip(self._machine.axes, way.target.position, strict=True) if a.rotary}
            hit = np.array([from_unit(float((answer["probed"] | at)[a.name]), a.unit) for a in self._machine.axes])
            if (far := float(np.linalg.norm(hit - expected))) > from_unit(_FAR, "mm"):
                what = "touch {touch} of reading {reading} met something {far:.1f} mm from where the ball is stated"
                raise SourceError(what, "Look what stands there, and at the place of the ball", far=1e3 * far, **told)
            here = [Decimal(repr(round(status["position"][a], _DECIMALS))) for a in step.letters]
            back = [f"{at + Decimal(by):f}" for at, by in zip(here, step.back, strict=True)]
            if self._sent("G53 G1", step.letters, back, step.fast)["probe"]:
                what = "after touch {touch} of reading {reading} the stylus stays closed"
                raise SourceError(what, "Free it by hand, and look at the probe", **told)
        self._sent("G53 G1", step.letters, step.beside, step.travel)
        return hit

    def _try(self, trial: Sequence[Step]) -> None:
        """Do the first reading once above its ball, at a quarter of the feed, step by step with a person."""
        first = said("The first run goes 20 mm above the ball. Enter makes one step, go the rest of them, stop ends.")
        for number, step in enumerate(trial, start=1):
            self._confirm(f"{first} " * (number == 1) + said("Step {number}: ", number=number))
            if isinstance(step, Touched):
                if self._sent("G38.3", step.letters, step.into, step.fast, _SLOWER)["tripped"]:
                    raise SourceError("20 mm above the ball the probe met something", "Look what stands in the way")
                self._sent("G53 G1", step.letters, step.beside, step.travel, _SLOWER)
            else:
                self._go([step], slow=_SLOWER)

    def _confirm(self, text: str) -> None:
        answer = self._asked(text).strip().lower() if self._singly else ""
        if answer == "go":
            self._singly = False
        elif answer:
            remedy = "Give the command again when it is clear"
            raise SourceError("the first run was ended by {answer!r}", remedy, answer=answer[:20])

    def _refuse_untouched(self) -> None:
        sys.stderr.write(f"Press the stylus once by hand and let it go, within {_BY_HAND:g} s.\n")
        sys.stderr.flush()
        lacking = self._line.watched(_BY_HAND)
        if lacking:
            what = "the probe was not seen to close and open again"
            what = "the probe is closed before it was touched" if lacking == "closed" else what
            raise SourceError(what, "Look at its wire, its battery and motion.probe-input")

    def _refuse_unfit(self) -> None:
        """Raise SourceError where LinuxCNC cannot be led, or somebody has moved an axis since the last reading."""
        status = self._line.status()
        refuse(status, self._machine, self._in_force)
        for axis, left in zip(self._machine.axes, self._standing[1] if self._standing else (), strict=False):
            if abs((here := status["position"][axis.name]) - float(left)) > _STRAYED:
                what = "{axis} stands at {here:.3f} {unit} and not at {left:f}, where the last reading left it"
                remedy = "Nothing has moved since. Look at the machine"
                raise SourceError(what, remedy, axis=axis.name, here=here, unit=axis.unit, left=left)


class _WayToBall:
    """From where the axes stand to one reading, and its touches, in steps of the machine's own coordinates.

    Raises TravelError where these leave the travels.
    """

    def __init__(self, machine: Machine, request: Request, above: float = 0.0) -> None:
        self._machine, self._request = machine, request
        setup, pose = request.setup, np.array([request.pose])
        self.axes = ProgramAxes.from_setup(machine, setup, _DECIMALS)
        self._pose: Array = (drawn_back(machine, pose, above) if above else pose)[0]
        back = drawn_back(machine, pose, setup.retract)[0].tolist()
        self.target: ReadingTarget = target(self.axes.scales, setup.name, request.reading, back, request.approach)

    def to(self, standing: tuple[str, Decimals] | None) -> list[Step]:
        """Return the way from where the axes stand, from anywhere if nobody knows."""
        if standing is not None and standing[0] == self._request.setup.name:
            return list(self.axes.way_to(self.target, standing[1]))
        start = self.target.turning
        return [*self.axes.to_the_start(start), *self.axes.way_to(self.target, start, first=True)]

    def refuse_bodies(
        self, to: Sequence[Step], standing: tuple[str, Decimals] | None, touching: Sequence[Step]
    ) -> None:
        """Raise TravelError where nose, holder or tool would meet a ball or a post, going there or touching."""
        setup = self._request.setup
        if setup.artefact is None:
            return
        begun = [] if standing is None else [Move(dict(enumerate(standing[1])), 1)]
        (ball,) = setup.artefact.nearest(self._machine.frames(self._pose[None]).tcp, setup.balls).tolist()
        run, balls = [*begun, *to, self.target, *touching], {self._request.reading: ball}
        refuse_kept_out(self._machine, setup, balls, self.axes.scales, run)

    def trial(self) -> list[Step]:
        """Return all of it 20 mm higher over the ball along the tool, from anywhere; raises TravelError."""
        above = _WayToBall(self._machine, self._request, _ABOVE)
        return [*above.to(None), *above.touches()]

    def touches(self) -> Iterator[Step]:
        """Return the touches, with the moves between them."""
        setup = self._request.setup
        place = Place(setup.name, tuple(self._pose.tolist()), self._request.approach)
        return self.axes.touching(setup, self.target, place)

    def expected(self, step: Touched) -> Array:
        """Return the pose (q,) in which a side is expected: between where a touch begins and where it ends."""
        pose, cycle = self._pose.copy(), cycle_of(self._machine, self._request.setup)
        share = cycle.clear / (cycle.clear + cycle.past)
        for axis, beside, into in zip(step.letters, step.beside, step.into, strict=True):
            at = float(exact((1 - share) * float(beside) + share * float(into)))
            pose[self._machine.index(axis)] = from_unit(at, "mm")
        return pose


_SAME = 1e-6
"""mm or deg: rounding of a position that is shown twice."""
_CLOSE = 1e-6
"""m or rad: a limit in inches has so many digits."""


def refuse(status: dict[str, Any], machine: Machine, in_force: InForce) -> None:
    """Raise SourceError for the first thing that is not as it has to be."""
    if amiss := next((each for each in _standing(status) if each[0]), None):
        raise SourceError(amiss[1], amiss[2])
    _refuse_other_machine(status, machine)
    in_force.refuse(status)
    if machine.tool_length <= 0:
        what = "the length of the tool is not known: [tool] length of machine.toml is 0"
        raise SourceError(what, "Write how far the middle of the stylus' ball is from the spindle nose")


def _standing(status: dict[str, Any]) -> Iterator[tuple[object, str, str]]:
    """Yield what may be amiss: whether it is, in words, and what to do then."""
    apart = any(abs(at - status["position"][axis]) > _SAME for axis, at in status["joints"])
    offsets = any(abs(each) > _SAME for each in status["offsets"])
    yield status["estop"], said("LinuxCNC is in emergency stop"), said("Release it")
    yield not status["enabled"], said("the machine is not switched on"), said("Switch it on")
    yield not status["homed"], said("not every joint is homed"), said("Home the machine")
    yield not status["idle"], said("a program is running or waiting"), said("Let it end, or stop it")
    yield status["spindle"], said("the spindle turns"), said("Stop it: a probe is to be in it")
    override = said("the feed override is switched off (M48, M49)")
    yield not status["feed_heeded"], override, said("Switch it on: a person must be able to slow down")
    yield status["feed"] > 1.0, said("the feed override is above 100 %"), said("Turn it down")
    yield offsets, said("a tool length offset is in force"), said("Give G49")
    turned = said("the coordinate system is turned (G10 R)")
    yield abs(status["rotation"]) > _SAME, turned, said("Set its rotation to zero")
    kinematics = said("the kinematics are not in their identity mode")
    yield apart or status["tip"], kinematics, said("Leave TCP mode, as by M429")
    yield status["probe"], said("the probe is closed"), said("Look at the stylus and at motion.probe-input")


def _refuse_other_machine(status: dict[str, Any], machine: Machine) -> None:
    """Raise SourceError where axes or limits are not those of machine.toml."""
    own, described = set(status["axes"]), {axis.name for axis in machine.axes}
    if own != described:
        what = "LinuxCNC has axes {own}, machine.toml {described}"
        remedy = "Describe the machine that runs: axiscal init DIR --from machine.ini"
        raise SourceError(what, remedy, own=" ".join(sorted(own)), described=" ".join(sorted(described)))
    for axis in machine.axes:
        low, high = (float(from_unit(end, axis.unit)) for end in status["axes"][axis.name])
        if axis.travel[0] < low - _CLOSE or axis.travel[1] > high + _CLOSE:
            low_text, high_text = (format_quantity(end, axis.unit) for end in (low, high))
            ends = said("{low} to {high}", low=low_text, high=high_text)
            what = "LinuxCNC lets {axis} go from {ends}, and machine.toml says {travel}"
            remedy = "Keep the travel within the limits of the INI file; or its units are others"
            raise SourceError(what, remedy, axis=axis.name, ends=ends, travel=travel_text(axis))
