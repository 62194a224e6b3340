"""What every kind of instrument answers: which way it looks, what its own unknowns add, what it would show exactly.

Instruments that read the rotation of the tool about one direction: electronic level, autocollimator.

y = dᵀε + zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Literal, Protocol

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import Deviation, frames
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal_core import rigid

Reads = Literal["length", "angle"]

TOOL = ("tool_x", "tool_y", "tool_z")
"""By how much the tool in the spindle is another than the machine states: eccentricity, and less length along z."""
CARRIED = 1e-4
"""m, std along each of them where nothing is said (an assumption)."""
TRUED = 5e-6
"""m: what is set in the spindle to be read is made to run true with a dial (an assumption)."""
TOOL_READS: Mapping[str, Reads] = MappingProxyType(dict.fromkeys(TOOL, "length"))


@dataclass(frozen=True, eq=False)
class Nominal:
    """Nominal places of readings of one set-up.  poses : (m, q) m or rad; moves : axes that may move.

    actual : where the tool is believed to be instead, for rows that are taken there
    approaches : (m, q) from which side each axis came, +1 or −1, 0 where nobody said; None where it does not matter
    """

    machine: Machine
    poses: Array
    moves: tuple[int, ...]
    actual: rigid.Motion | None = None
    approaches: Array | None = None

    @property
    def count(self) -> int:
        """Number of readings."""
        return len(self.poses)

    @cached_property
    def tcp(self) -> Array:
        """The nominal TCP in the workpiece frame, (m, 3), m."""
        return frames(self.machine, self.poses).tcp if self.actual is None else self.actual.translation

    @cached_property
    def tool(self) -> Array:
        """The nominal orientation R_t of the tool in the workpiece frame, (m, 3, 3)."""
        return frames(self.machine, self.poses).tool if self.actual is None else self.actual.rotation

    def arm(self, setup: Setup) -> Array:
        """Return the way from the tool point to the point that a set-up looks at, workpiece frame, (m, 3) m."""
        if setup.offset is None:
            return np.zeros((self.count, 3))
        arm: Array = self.tool @ np.array(setup.offset)
        return arm

    @cached_property
    def travelled(self) -> Array:
        """How far the linear axis that moves is from the middle of its travel, (m,), m; zero where none moves."""
        if self.slide is None:
            return np.zeros(self.count)
        return self.poses[:, self.slide] - sum(self.machine.axes[self.slide].travel) / 2

    @cached_property
    def ways(self) -> Array:
        """The way that this axis goes in the workpiece frame, (m, 3); zero where none moves."""
        if self.slide is None:
            return np.zeros((self.count, 3))
        axis = self.machine.axes[self.slide]
        ways: Array = frames(self.machine, self.poses).rotations[self.slide] @ np.array(axis.direction)
        return ways

    @property
    def slide(self) -> int | None:
        """The index of the linear axis that moves; None where none does."""
        return next((k for k in self.moves if not self.machine.axes[k].rotary), None)


class Model(Protocol):
    """A kind of instrument.

    reads : lengths or angles; values : numbers in one reading, at most
    directed : it reads along or about a direction that has to be stated
    unknown_reads : by name of each possible unknown of a set-up, whether it is a length or an angle
    """

    reads: Reads
    values: int
    directed: bool
    unknown_reads: Mapping[str, Reads]

    def direction_of(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return what unit displacements (or rotations) along x, y, z add to a reading, (m, 3): as a rule d for each.

        direction : (3,) the set-up's, or that of one number of a reading that has three; (k,) of k stations, 1 for the
            one that is meant
        """
        return np.broadcast_to(direction, (nominal.count, 3))

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return what a unit of one of the set-up's unknowns adds to a reading, (m,): as a rule 1, for its zero."""
        return np.ones(nominal.count)

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Deviation, unknowns: Mapping[str, float]
    ) -> Array:
        """Return what it would show, nothing linearised, noise left out, (m,)."""

    def check_setup(self, setup: Setup, machine: Machine) -> None:
        """Raise DescriptionError for a set-up that makes no sense on a machine; as a rule every one does."""
        return


def moves(setup: Setup, unknown: str, nominal: Nominal) -> Array:
    """Return how a unit of `TOOL`, or of what an artefact leaves open, moves the tip against its ball, (m, 3)."""
    if unknown in TOOL:
        return nominal.tool[:, :, TOOL.index(unknown)]
    if setup.artefact is None:
        return np.zeros((nominal.count, 3))
    return -setup.artefact.moves(unknown, setup.artefact.nearest(nominal.tcp, setup.balls))


def moved(setup: Setup, nominal: Nominal, actual: Deviation) -> Array:
    """Return how far the point that a set-up looks at has moved, δp + (R(ε) − 1) R_t o, (m, 3) m."""
    arm = nominal.arm(setup)
    turned = rigid.rotation(actual.rotation) @ arm[:, :, None]
    found: Array = actual.displacement + turned[:, :, 0] - arm
    return found


def levers_at(errors: ErrorModel, poses: Array, arm: Array) -> Array:
    """Return what a unit of each error moves a point beside the tool point by, (terms, n, 3).

    poses : (n, q); arm : (n, 3) m from the tool point to that point
    """
    levers = errors.levers(poses)
    return levers + rigid.cross(errors.angular_levers(poses), arm) if np.any(arm) else levers


def grown(setup: Setup, nominal: Nominal) -> Array:
    """Return how much farther a machine that is warmer than 20 °C takes the tool from the middle, (m, 3) or (3,) m."""
    if not setup.growth:
        return np.zeros(3)
    middle = frames(nominal.machine, np.array([setup.park])).tcp
    away: Array = setup.growth * (nominal.tcp - middle)
    return away


def displaced(setup: Setup, nominal: Nominal, actual: Deviation, unknowns: Mapping[str, float]) -> Array:
    """Return where the actual tool's point is from the nominal TCP, and from its ball, nothing linearised, (m, 3) m."""
    tool = np.array([unknowns.get(name, 0.0) for name in TOOL])
    held = rigid.rotation(actual.rotation) @ (nominal.tool @ tool)[:, :, None]
    tip: Array = actual.displacement + grown(setup, nominal) + held[:, :, 0]
    if setup.artefact is None:
        return tip
    return tip - setup.artefact.displacements(unknowns, setup.artefact.nearest(nominal.tcp, setup.balls))


def need_station(setup: Setup, what: str) -> None:
    """Raise DescriptionError for a set-up that does not say where it stands."""
    if setup.station is None:
        remedy = 'Write station = ["0 mm", "0 mm", "-300 mm"], in the workpiece frame'
        raise DescriptionError("it is not said where {thing} is", remedy, thing=said(what, instrument=setup.instrument))


class Rotation(Model):
    """One angle about the set-up's direction."""

    reads: Reads = "angle"
    values = 1
    directed = True
    unknown_reads: Mapping[str, Reads] = MappingProxyType({"zero": "angle"})

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Deviation, unknowns: Mapping[str, float]
    ) -> Array:
        """Return dᵀε + zero, (m,)."""
        return actual.rotation @ direction + unknowns.get("zero", 0.0)
