"""The share of set-ups in readings: datums that are taken off, and the rest, which is uncertainty.

A zero is a datum: a length is judged against the others of its set-up. So is the place of a ball that is not known to
the tolerance. The ball is judged against itself, at other angles of the table. So are such a tool, and such a slope:
residuals are judged against their own line. The legs of a square share its turn, so that together they show how square
the machine is. A well-known slope, and a growth always, is not fitted, for that could swallow an error of the machine.
It adds U diag(std²) Uᵀ to the covariance of the readings.

A tracker that was set down by eye is read as if it stood straight. It shows y = R(p + δ − s) + s + zero − p at a place
p from its station s. Its turn R is a datum of a check if it may hide the tolerance. Turns of 20 mrad are not linear:
over a metre the square is 200 um. So R is the turn after which no turn remains. It is taken back: Rᵀ(y + p − s) − (p −
s) = δ + Rᵀ zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import ReadingError
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.measurement.instrument import model_of
from axiscal.measurement.instruments.distance import TURNS
from axiscal.measurement.instruments.kind import TOOL, Nominal
from axiscal.measurement.observation import directions_of
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array, rigid

GUARD = 1.645
"""Expanded uncertainty in standard deviations: one side, 95 %."""
_FAR = 3.0
"""A reading this far off its datum is named; two or four would name few others, and the verdict does not hang on it."""
_LINES = ("slope", "turn", "square")


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


def is_zero(unknown: str) -> bool:
    """Return whether an unknown of a set-up is one of its zeros."""
    return unknown.partition("_")[0] == "zero"


def lines_shared(setup: Setup) -> set[str]:
    """Return what else has the lines of a set-up, such as the square of a leg."""
    return {unknown.owner for unknown in setup.unknowns if unknown.owner and _is_line(unknown.name)}


def _is_line(unknown: str) -> bool:
    return unknown.partition("_")[0] in _LINES


def datums_of(
    machine: Machine,
    setups: Sequence[Setup],
    indices: NDArray[np.intp],
    poses: Array,
    directions: Array,
    tolerance: float,
) -> Datums:
    """Return what the set-ups bring; raises ReadingError when readings are too few for the datums of their set-up.

    indices : (m,) of the set-ups; poses : (m, q) m or rad; directions : (m, 3) of the values; tolerance : m
    """
    found: dict[tuple[str, str], tuple[Unknown, Array, bool]] = {}
    for index in np.unique(indices).tolist():
        mine, setup = np.flatnonzero(indices == index), setups[index]
        own = _own_rows(machine, setup, poses[mine], directions[mine])
        off = _are_datums(setup, own, np.array([unknown.std for unknown in setup.unknowns]), tolerance)
        if len(mine) <= (taken_off := int(off.sum())):
            what = '{readings} reading(s) with "{setup}" cannot tell the machine from the set-up'
            remedy = "Take {least} or more with it, or leave it out"
            raise ReadingError(what, remedy, readings=len(mine), setup=setup.name, least=taken_off + 1)
        for unknown, column, datum in zip(setup.unknowns, own.T, off.tolist(), strict=True):
            key = unknown.owner or setup.name, unknown.name
            _, whole, before = found.get(key, (unknown, np.zeros(len(indices)), False))
            whole[mine] = column
            found[key] = unknown, whole, before or datum
    datums = {key: column for key, (_, column, off) in found.items() if off}
    stays = [unknown.std * column for unknown, column, off in found.values() if not off]
    columns, rest = (np.array(each).reshape(-1, len(indices)).T for each in (list(datums.values()), stays))
    inverse = np.linalg.pinv(columns)
    taken = tuple(
        Datum(*key, found[key][0].std, row, max(float(np.max(np.abs(column))), 1e-12))
        for (key, column), row in zip(datums.items(), inverse, strict=True)
    )
    return Datums(np.eye(len(indices)) - columns @ inverse, rest @ rest.T, taken)


def fewest(machine: Machine, setup: Setup, poses: Array, tolerance: float) -> int:
    """Return how many places of a set-up tell the machine from it.

    poses : (m, q) at which it may be read, m or rad; tolerance : they are judged by, m; with 0 it is enough for any
    """
    towards = [setup.direction if d is None else d for d in directions_of(setup)]
    directions = np.tile(np.array(towards, dtype=float), (len(poses), 1))
    own = _own_rows(machine, setup, np.repeat(poses, len(towards), axis=0), directions)
    datums = int(_are_datums(setup, own, np.array([unknown.std for unknown in setup.unknowns]), tolerance).sum())
    return datums // len(towards) + 1


def _own_rows(machine: Machine, setup: Setup, poses: Array, directions: Array) -> Array:
    """Return how the unknowns of a set-up show in its values, (m, unknowns)."""
    model, result = model_of(setup), np.zeros((len(poses), len(setup.unknowns)))
    for direction in np.unique(directions, axis=0):
        mine = np.all(directions == direction, axis=1)
        place = Nominal(machine, poses[mine], setup.moves)
        for column, unknown in enumerate(setup.unknowns):
            result[mine, column] = model.unknown_effect(setup, unknown.name, direction, place)
    return result


def _are_datums(setup: Setup, own: Array, stds: Array, tolerance: float) -> NDArray[np.bool_]:
    """Return which unknowns are taken off, (unknowns,): zeros, and lines, places and tools that may hide it."""
    wide = GUARD * stds * np.max(np.abs(own), axis=0, initial=0.0) > tolerance
    standing = ("place", *(ball.name for ball in setup.artefact.balls)) if setup.artefact else ()
    balls = {f"{name}_{axis}" for name in standing for axis in "xyz"}
    pairs = zip((unknown.name for unknown in setup.unknowns), wide, strict=True)
    return np.array(
        [is_zero(n) or (bool(w) and (_is_line(n) or n in TOOL or n in balls)) for n, w in pairs], dtype=bool
    )


_ROUNDS = 12
"""Rounds end where the turn stays; this only ends what would go round."""
_STAYS = 1e-10
"""rad; a tenth of a nanometre over a metre."""


def straightened(machine: Machine, setup: Setup, poses: Array, shown: Array, turns: Sequence[str]) -> Array:
    """Return the readings of one tracker without its turn, (m, 3), m.

    poses : (m, q) m or rad; shown : (m, 3) m; turns : the unknown turns that are datums, others are none
    """
    line = frames(machine, poses).tcp - (np.zeros(3) if setup.station is None else np.array(setup.station))
    free = [TURNS.index(name) for name in turns]
    zeros = np.tile(np.eye(3), (len(poses), 1))
    tilted = np.stack([np.cross(np.eye(3)[axis], line).ravel() for axis in free], axis=1)
    inverse, turn = np.linalg.pinv(np.hstack([tilted, zeros])), np.eye(3)
    for _ in range(_ROUNDS):
        step = np.zeros(3)
        step[free] = (inverse @ ((shown + line) @ turn - line).ravel())[: len(free)]
        turn = turn @ rigid.rotation(step[None])[0]
        if np.max(np.abs(step)) < _STAYS:
            break
    straight: Array = (shown + line) @ turn - line
    return straight
