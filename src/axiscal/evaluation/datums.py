"""The share of set-ups in readings: datums that are taken off, and the rest, which is uncertainty.

A zero is a datum: a length is judged against the others of its set-up. So is the place of a ball that is not known to
the tolerance. The ball is judged against itself, at other angles of the table. So are such a tool, and such a slope:
residuals are judged against their own line. The legs of a square share its turn, so that together they show how square
the machine is. A well-known slope, and a growth always, is not fitted, for that could swallow an error of the machine.
It adds U diag(std²) Uᵀ to the covariance of the readings.

What was put down by eye is turned by milliradians: a tracker, a board of balls. That is not linear: 20 mrad over a
metre make 200 um. So `upright` solves the readings for turns and deviations together.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import ReadingError
from axiscal.machine.kinematics import turn_between
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array
from axiscal.tables.surface import Control
from axiscal_core.instrument import TOOL, At
from axiscal_core.machine import Machine

GUARD = 1.645
"""Expanded uncertainty in standard deviations: one side, 95 %."""
_FAR = 3.0
"""A reading this far off its datum is named; two or four would name few others, and the verdict does not hang on it."""
_LINES = ("slope", "turn", "square")


@dataclass(frozen=True, eq=False)
class Readout:
    """What set-ups show at places: all values of a reading, one reading after another."""

    machine: Machine
    setups: Sequence[Setup]
    places: Places

    @cached_property
    def of(self) -> NDArray[np.intp]:
        """The place of each value, (m,)."""
        return np.repeat(np.arange(len(self.places)), [len(self.setups[s].names) for s in self.places.setups])

    def each(self) -> Iterator[tuple[Setup, NDArray[np.intp], NDArray[np.bool_], At]]:
        """Yield each set-up with its places (n,), which of the values are its own (m,), and where it stands there."""
        for index, which in self.places.by_setup():
            mine = np.arange(len(self.places))[which]
            at = self.setups[index].places(self.places.poses[mine])
            yield self.setups[index], mine, np.isin(self.of, mine), at


@dataclass(frozen=True, eq=False, slots=True)
class Datum:
    """One unknown that is taken off.

    setup : the set-up that has it, or what several share; row : (m,) gives its value from the readings
    reach : the most it adds to one
    """

    setup: str
    unknown: str
    std: float
    row: Array
    reach: float


@dataclass(frozen=True, eq=False, slots=True)
class Datums:
    """What set-ups bring to m readings.

    free : (m, m) projection that takes the datums off; spread : (m, m) covariance by what is not taken off, m²
    """

    free: Array
    spread: Array
    taken: tuple[Datum, ...]

    @property
    def lines(self) -> tuple[str, ...]:
        """Names of the set-ups that are judged against their own line, or as they turn out to be turned."""
        return tuple(dict.fromkeys(datum.setup for datum in self.taken if _is_line(datum.unknown)))

    @property
    def tools(self) -> tuple[str, ...]:
        """Names of the set-ups that are judged with the tool where the readings put it."""
        return tuple(dict.fromkeys(datum.setup for datum in self.taken if datum.unknown in TOOL))

    def strained(self, values: Array, noise: Array, tolerance: float) -> tuple[Datum, ...]:
        """Return datums that would have to be far larger than stated, the tolerance on top, for these readings (m,)."""
        covariance = self.spread + np.diag(noise**2)
        return tuple(
            datum
            for datum in self.taken
            if abs(datum.row @ values)
            > _FAR * np.sqrt(datum.std**2 + datum.row @ covariance @ datum.row) + tolerance / datum.reach
        )


def lines_shared(setup: Setup) -> set[str]:
    """Return what else has the lines of a set-up, such as the square of a leg."""
    return {unknown.owner for unknown in setup.unknowns if unknown.owner and _is_line(unknown.name)}


def _is_line(unknown: str) -> bool:
    return unknown.partition("_")[0] in _LINES


def datums_of(readout: Readout, tolerance: float) -> Datums:
    """Return what the set-ups bring; raises ReadingError when readings are too few for the datums of their set-up.

    tolerance : m
    """
    found, count = dict[tuple[str, str], tuple[Unknown, Array, bool]](), len(readout.of)
    for setup, _, of, at in readout.each():
        own, mine = np.concatenate(list(setup.own_slopes(at))), np.flatnonzero(of)
        off = _are_datums(setup, own, tolerance)
        if len(mine) <= (taken_off := _count(setup, off)):
            what = '{readings} reading(s) with "{setup}" cannot tell the machine from the set-up'
            remedy = "Take {least} or more with it, or leave it out"
            raise ReadingError(what, remedy, readings=len(mine), setup=setup.name, least=taken_off + 1)
        for unknown, column, datum in zip(setup.unknowns, own.T, off.tolist(), strict=True):
            key = unknown.owner or setup.name, unknown.name
            _, whole, before = found.get(key, (unknown, np.zeros(count), False))
            whole[mine] = column
            found[key] = unknown, whole, before or datum
    datums = {key: column for key, (_, column, off) in found.items() if off}
    stays = [unknown.std * column for unknown, column, off in found.values() if not off]
    columns, rest = (np.array(part).reshape(-1, count).T for part in (list(datums.values()), stays))
    # several datums may do the same to readings: what they show goes to those that are known least
    stds = np.array([found[key][0].std for key in datums])
    inverse = stds[:, None] * np.linalg.pinv(columns * stds)
    if round(float(np.trace(columns @ inverse))) >= count:
        remedy = "Read the artefact where it lies another way as well"
        raise ReadingError("readings of one artefact cannot tell the machine from it", remedy)
    taken = tuple(
        Datum(*key, found[key][0].std, row, max(float(np.max(np.abs(column))), 1e-12))
        for (key, column), row in zip(datums.items(), inverse, strict=True)
    )
    return Datums(np.eye(count) - columns @ inverse, rest @ rest.T, taken)


def fewest(setup: Setup, poses: Array, tolerance: float) -> int:
    """Return how many places of a set-up tell the machine from it.

    poses : (m, q) at which it may be read, m or rad; tolerance : they are judged by, m; with 0 it is enough for any
    """
    off = _are_datums(setup, np.concatenate(list(setup.own_slopes(setup.places(poses)))), tolerance)
    return _count(setup, off) // len(setup.names) + 1


def _are_datums(setup: Setup, own: Array, tolerance: float) -> NDArray[np.bool_]:
    """Return which unknowns are taken off, (unknowns,): zeros, and lines, places and tools that may hide it.

    own : (values, unknowns) how they show
    """
    stds = np.array([unknown.std for unknown in setup.unknowns])
    wide = GUARD * stds * np.max(np.abs(own), axis=0, initial=0.0) > tolerance
    standing = ("place", *(ball.name for ball in setup.artefact.balls)) if setup.artefact else ()
    balls = {f"{name}_{axis}" for name in standing for axis in "xyz"}
    names = [unknown.name for unknown in setup.unknowns]
    zeros = np.array([name.partition("_")[0] == "zero" for name in names], dtype=bool)
    hiding = np.array([_is_line(name) or name in {*TOOL, *balls} for name in names], dtype=bool)
    off: NDArray[np.bool_] = zeros | (wide & hiding)
    return off


def _count(setup: Setup, off: NDArray[np.bool_]) -> int:
    """Return how many unknowns are taken off that no other placement of the artefact shares, such as balls' places."""
    balls = {ball.name for ball in setup.artefact.balls} if setup.artefact else set()
    shared = (bool(each.owner) and each.name.rpartition("_")[0] in balls for each in setup.unknowns)
    return sum(taken and not elsewhere for taken, elsewhere in zip(off.tolist(), shared, strict=True))


_ROUNDS = 6
"""Rounds in which turns are found: each leaves a few hundredths of what the last one left, of turns of 20 mrad."""


def upright(readout: Readout, datums: Datums, shown: Array) -> Array:
    """Return readings as if they were linear in the datums, (m,), m.

    A reading shows f(δ, u) of a deviation δ and the datums u. The result is δ + U u, where f(δ, u) is what was shown
    and no datum is left in δ.  shown : (m,) m
    """
    values = shown
    for _ in range(_ROUNDS):
        free, beyond = datums.free @ values, np.zeros_like(values)
        found = {(datum.setup, datum.unknown): float(datum.row @ values) for datum in datums.taken}
        for setup, mine, of, at in readout.each():
            keys = {unknown.name: (unknown.owner or setup.name, unknown.name) for unknown in setup.unknowns}
            own = {name: found[key] for name, key in keys.items() if key in found}
            linear = free[of].reshape(len(mine), -1)
            moved = np.einsum("mk,mkc->mc", linear, setup.slopes(at).moved)
            linear = linear + setup.own_slopes(at, [*own]) @ np.array([*own.values()])
            beyond[of] = (setup.shown(at._replace(moved=moved), own) - linear).ravel()
        values = shown - beyond
    return values


def taken_away(readout: Readout, control: Control) -> Array:
    """Return what a control takes away from each value, (m,), m."""
    taken, places = np.zeros(len(readout.of)), readout.places
    for setup, mine, of, _ in readout.each():
        added = added_to_values(readout.machine, setup, places.poses[mine], places.approaches[mine], control)
        taken[of] = -added.ravel()
    return taken


def added_to_values(machine: Machine, setup: Setup, poses: Array, approaches: Array, control: Control) -> Array:
    """Return what a control adds to each number of readings of a set-up, (m, k), m or rad.  poses, approaches : (m, q)

    What stands on a way shows the way's own shape, wherever the control sends the axes.
    """
    if setup.base is not None:
        return np.zeros((len(poses), len(setup.names)))
    before, after = machine.frames(poses), machine.frames(poses + control(poses, approaches))
    seen = setup.slopes(setup.places(poses, approaches))
    pairs = (seen.moved, after.tcp - before.tcp), (seen.turned, turn_between(before.tool, after.tool))
    added: Array = sum(np.einsum("mkc,mc->mk", ways, moved) for ways, moved in pairs)
    if setup.start is not None:  # what is added at its first end as well is no part of a length
        there = np.array([setup.start])
        added = added - added_to_values(machine, replace(setup, start=None), there, approaches[:1], control)
    return added / setup.scales
