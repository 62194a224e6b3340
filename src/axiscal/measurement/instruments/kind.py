"""What every kind of instrument answers: the numbers that it shows of a tool that is displaced and turned (`sees`).

Rows are derivatives of it by complex steps (`axiscal_core.instrument.slopes`); simulated readings are its values.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Literal, TypeAlias

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import Deviation, frames
from axiscal.measurement.setup import Figures, Setup
from axiscal.numerics import Array
from axiscal_core import rigid
from axiscal_core.instrument import TOOL, At, Slopes, Unknowns, numbers, own_slopes, slopes

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
        nominal = frames(self.machine, poses)
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

    def travelled(self, poses: Array) -> Array:
        """Return how far the linear axis that moves is from the middle of its travel, (m,) m; zero where none does."""
        if self.slide is None:
            return np.zeros(len(poses))
        return poses[:, self.slide] - sum(self.machine.axes[self.slide].travel) / 2

    def ways(self, poses: Array) -> Array:
        """Return the way that this axis goes in the workpiece frame, (m, 3); zero where none moves."""
        if self.slide is None:
            return np.zeros((len(poses), 3))
        ways: Array = frames(self.machine, poses).rotations[self.slide] @ np.array(
            self.machine.axes[self.slide].direction
        )
        return ways

    @cached_property
    def slide(self) -> int | None:
        """The index of the linear axis that moves; None where none does."""
        return next((k for k in self.setup.moves if not self.machine.axes[k].rotary), None)

    def grown(self, at: At) -> Array:
        """Return how much farther a machine that is warmer than 20 °C takes the tool from the middle, (m, 3) m."""
        away: Array = self.setup.growth * (at.tcp - frames(self.machine, np.array([self.setup.park])).tcp)
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


def levers_of(errors: ErrorModel, seen: Slopes, poses: Array) -> Array:
    """Return what a unit of each error adds to each number of readings, sides apart, (k, terms, m).  poses : (m, q)"""
    result = np.zeros((seen.moved.shape[1], len(errors.terms), len(poses)))
    for ways, levers in ((seen.moved, errors.levers), (seen.turned, errors.angular_levers)):
        if ways.any():
            field = levers(poses)
            for number, lever in enumerate(result):
                lever += np.einsum("fmc,mc->fm", field, ways[:, number])
    return result
