"""What every kind of instrument answers: the numbers that it shows of a tool that is displaced and turned (`sees`).

Rows are derivatives of it by complex steps (`axiscal_core.instrument.slopes`); simulated readings are its values.

Instruments that read the rotation of the tool about one direction, electronic level and autocollimator: y = dᵀε + zero.

A level, or the mirror of an autocollimator, that is stepped along a way on feet a base apart.

y = atan( (d × a)ᵀ (w(t + L/2) − w(t − L/2)) / L ) + zero. Here w is the shape of the way and a its direction.
To first order y is the slope of a chord; as L goes to zero, the derivative of the straightness.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Literal, TypeAlias

import numpy as np

from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine.axis import travel_text
from axiscal.machine.kinematics import Deviation
from axiscal.measurement.setup import Figures, Setup
from axiscal.measurement.travel import across, slope_rows
from axiscal.numerics import Array
from axiscal.units import format_quantity
from axiscal_core import rigid
from axiscal_core.instrument import TOOL, At, Slopes, Unknowns, numbers, own_slopes, slopes
from axiscal_core.machine import Machine

Reads = Literal["length", "angle"]

CARRIED = 1e-4
"""m, std along each of `TOOL` where nothing is said (an assumption)."""
TRUED = 5e-6
"""m: what is set in the spindle to be read is made to run true with a dial (an assumption)."""
TOOL_READS: Mapping[str, Reads] = MappingProxyType(dict.fromkeys(TOOL, "length"))


class Kind:
    """A kind of instrument, as it is mounted on a machine.

    reads : lengths or angles; numbers : what those of a reading are told apart by
    scales : by what each number is multiplied so that all are as noisy as the first; none where they are
    directed : it reads along or about a direction that has to be stated
    unknown_reads : by name of each possible unknown of a set-up, whether it is a length or an angle
    """

    reads: Reads = "length"
    numbers: tuple[str, ...] = ("",)
    scales: tuple[float, ...] = ()
    directed = True
    unknown_reads: Mapping[str, Reads] = {}

    def __init__(self, setup: Setup, machine: Machine) -> None:
        self.setup, self.machine = setup, machine
        self.names = self.names_of(setup)
        self._nothing = dict.fromkeys((*self.unknown_reads, *(unknown.name for unknown in setup.unknowns)), 0.0)
        self._found = {**self._nothing, **self.found(setup)}

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return what it shows, nothing linearised, noise left out, (m,) each, m or rad.  u : all its unknowns"""
        raise NotImplementedError

    @classmethod
    def check_setup(cls, setup: Setup, machine: Machine) -> None:
        """Raise DescriptionError for a set-up that makes no sense on a machine; as a rule every one does."""

    @classmethod
    def names_of(cls, setup: Setup) -> tuple[str, ...]:
        """Return what the numbers of a set-up's readings are told apart by; "" of a single one."""
        return cls.numbers

    @classmethod
    def reads_each(cls, setup: Setup) -> tuple[Reads, ...]:
        """Return what each number of a set-up's readings is."""
        return (cls.reads,) * len(cls.names_of(setup))

    @classmethod
    def column(cls, name: str) -> str:
        """Return what a file of readings calls the column of a number, its unit left out."""
        return f"value_{name}" if name else "value"

    @staticmethod
    def located(setup: Setup) -> tuple[str, ...]:
        """Return the unknowns that say where a set-up stands, which `Setup.found` has values of; as a rule none."""
        curved = setup.written.curved if setup.written else ()
        return tuple(unknown.name for unknown in setup.unknowns if unknown.name in curved)

    @classmethod
    def found(cls, setup: Setup) -> dict[str, float]:
        """Return where these have been found so far: there its rows are taken, and at zero of all others."""
        return dict(zip(cls.located(setup), setup.found or (), strict=False))

    def places(
        self, poses: Array, sides: Array | None = None, actual: rigid.Motion | None = None,
        deviation: Deviation | None = None,
    ) -> At:  # fmt: skip
        """Return places of readings.

        poses : (m, q) m or rad; sides : (m, q) from which each axis came, +1 or −1, 0 where nobody said
        actual : where the tool is believed to be instead of where it is nominally; deviation : what it does there
        """
        come = np.zeros_like(poses) if sides is None else sides
        moved, turned = np.zeros((2, len(poses), 3)) if deviation is None else deviation
        if actual is not None:
            return At(poses, come, actual.translation, actual.rotation, moved, turned)
        nominal = self.machine.frames(poses)
        return At(poses, come, nominal.tcp, nominal.tool, moved, turned)

    def shown(self, at: At, own: Unknowns) -> Array:
        """Return all that it shows, (m, k).  own : values of its unknowns, zero where none is given"""
        return numbers(self, at, {**self._nothing, **own})

    def slopes(self, at: At) -> Slopes:
        """Return the derivatives of what it shows by what the tool does."""
        return slopes(self, at, self._found)

    def own_slopes(self, at: At, names: Sequence[str] | None = None) -> Array:
        """Return those by its own unknowns, (m, k, names).  names : None for those of the set-up"""
        own = [unknown.name for unknown in self.setup.unknowns] if names is None else names
        return own_slopes(self, at, self._found, own)

    def middle(self, at: At) -> Array:
        """Return from where its lengths count, (1, 3) m: the middle of what is read."""
        return np.asarray(at.tcp.mean(axis=0, keepdims=True))

    def travelled(self, poses: Array) -> Array:
        """Return how far the linear axis that moves is from the middle of its travel, (m,) m; zero where none does."""
        if self.slide is None:
            return np.zeros(len(poses))
        return poses[:, self.slide] - sum(self.machine.axes[self.slide].travel) / 2

    def ways(self, poses: Array) -> Array:
        """Return the way that this axis goes in the workpiece frame, (m, 3); zero where none moves."""
        if self.slide is None:
            return np.zeros((len(poses), 3))
        ways: Array = self.machine.frames(poses).rotations[self.slide] @ np.array(
            self.machine.axes[self.slide].direction
        )
        return ways

    @cached_property
    def slide(self) -> int | None:
        """The index of the linear axis that moves; None where none does."""
        return next((k for k in self.setup.moves if not self.machine.axes[k].rotary), None)

    def grown(self, at: At) -> Array:
        """Return how much farther a machine that is warmer than 20 °C takes the tool from the middle, (m, 3) m."""
        away: Array = self.setup.growth * (at.tcp - self.machine.frames(np.array([self.setup.park])).tcp)
        return away

    def tip(self, at: At, u: Unknowns) -> Array:
        """Return where the actual tool's point is from the nominal TCP, and from its ball, (m, 3) m."""
        tip = at.tip(u) + self.grown(at) if self.setup.growth else at.tip(u)
        artefact = self.setup.artefact
        return tip if artefact is None else tip - artefact.displacements(u, artefact.nearest(at.tcp, self.setup.balls))


Instrument: TypeAlias = Figures[Kind]
"""A kind of instrument with its usual figures."""


def need_station(setup: Setup, what: str) -> None:
    """Raise DescriptionError for a set-up that does not say where it stands."""
    if setup.station is None:
        remedy = 'Write station = ["0 mm", "0 mm", "-300 mm"], in the workpiece frame'
        raise DescriptionError("it is not said where {thing} is", remedy, thing=said(what, instrument=setup.instrument))


def levers_of(errors: Machine, seen: Slopes, poses: Array) -> Array:
    """Return what a unit of each error adds to each number of readings, sides apart, (k, terms, m).  poses : (m, q)"""
    result = np.zeros((seen.moved.shape[1], len(errors.terms), len(poses)))
    for angular, ways in enumerate(seen):
        if ways.any():
            field = errors.levers(poses, bool(angular))
            for number, lever in enumerate(result):
                lever += np.einsum("fmc,mc->fm", field, ways[:, number])
    return result


_ALONG = 1e-6
"""Rounding of a unit vector."""
_UNSEEN = 1e-9
"""Rounding of a row, 1/m or 1."""


class Rotation(Kind):
    """One angle about the set-up's direction: of the tool, or of feet that are stepped along a way."""

    reads: Reads = "angle"
    unknown_reads: Mapping[str, Reads] = MappingProxyType({"zero": "angle"})

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return dᵀε + zero, or the angle of the chord; at.moved : of one foot against the other, per length."""
        if self.setup.base is None:
            return [at.turned @ np.array(self.setup.direction) + u["zero"]]
        return [np.arctan(np.sum(across(self.machine, self.setup, at.poses) * at.moved, axis=1)) + u["zero"]]

    @classmethod
    def check_setup(cls, setup: Setup, machine: Machine) -> None:
        """Raise DescriptionError where feet have no slope to read."""
        if setup.base is None:
            return
        _refuse_other_moves(setup, machine)
        base, axis = setup.base, machine.axes[setup.moves[0]]
        if base >= axis.length:
            what = "a base of {base} is not shorter than the travel of {axis}"
            remedy, travel = "Both feet stand within the travel, which is {travel}", travel_text(axis)
            raise DescriptionError(what, remedy, base=format_quantity(base, "mm", 6), axis=axis.name, travel=travel)
        slope_seen = across(machine, setup, np.array([setup.park]))[0]
        if abs(np.linalg.norm(slope_seen) - 1) > _ALONG:
            what = "feet that are stepped along {axis} show its slope, and that is no turn about this direction"
            remedy = "Give a direction across the way; for the roll of a carriage take base out: the level rides on it"
            raise DescriptionError(what, remedy, axis=axis.name)
        _refuse_unseen(setup, machine)


def _refuse_other_moves(setup: Setup, machine: Machine) -> None:
    moving = [machine.axes[index] for index in setup.moves]
    if len(moving) != 1 or moving[0].rotary:
        named = ", ".join(axis.name for axis in moving)
        what = "a base is stepped along one straight way, and here {axes} moves"
        what = what if len(moving) == 1 else "a base is stepped along one straight way, and here {axes} move"
        raise DescriptionError(what, 'Name the linear axis whose way it is, such as moves = ["X"]', axes=named)


def _refuse_unseen(setup: Setup, machine: Machine) -> None:
    """Raise DescriptionError where the way has no shape, or a rest whose slope over such a short base nobody knows."""
    errors, base = machine, setup.base or 0.0
    (seen,) = np.abs(slope_rows(errors, setup, np.array([setup.park])))
    levelled = any(unknown.name == "zero" for unknown in setup.unknowns)
    shown = [term for term in errors.terms if seen[term.columns].max(initial=0.0) > _UNSEEN]
    axis = machine.axes[setup.moves[0]].name
    if all(function.kind == "location" and levelled for function in shown):
        what = "the machine states no straightness error of {axis} that a slope about this direction could show"
        error = f"E{'X' if axis[0] == 'Z' else 'Z'}{axis}"
        raise DescriptionError(what, "Add one under [errors], such as {error}", axis=axis, error=error)
    for function in shown:
        cell = np.ptp(function.edges(0, setup.moves[0])[0])
        if function.rest > 0 and base < cell * (1 - 1e-9):
            short, long = format_quantity(base, "mm", 6), format_quantity(cell, "mm", 4)
            what = "a base of {short} is shorter than {long}, within which the rest of {function} has no known slope"
            remedy = "Use a longer base, give that error more knots, or take its rest out"
            raise DescriptionError(what, remedy, short=short, long=long, function=function.name)
