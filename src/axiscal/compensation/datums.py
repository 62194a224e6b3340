"""What set-ups bring to readings themselves: datums that are taken off, and the rest, which is uncertainty.

A zero is a datum: a length is judged against the others of its set-up. So is a slope that is not known to the
tolerance: what is left is judged against its own line. A slope that is known well enough, and a growth always, is not
fitted, for that could swallow an error of the machine: it adds U diag(std²) Uᵀ to the covariance of the readings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import ReadingError
from axiscal.machine.description import Machine
from axiscal.measurement.instrument import model_of
from axiscal.measurement.instruments.model import Place
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

GUARD = 1.645
"""Expanded uncertainty in standard deviations: one side, 95 %."""
_FAR = 3.0


@dataclass(frozen=True, eq=False, slots=True)
class Datum:
    """One unknown that is taken off.  row : (m,) gives its value from the readings; reach : the most it adds to one."""

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
        """Names of the set-ups that are judged against their own line."""
        return tuple(datum.setup for datum in self.taken if datum.unknown == "slope")

    def strained(self, values: Array, noise: Array, tolerance: float) -> tuple[Datum, ...]:
        """Return datums that would have to be far larger than stated, the tolerance on top, for these readings (m,)."""
        covariance = self.spread + np.diag(noise**2)
        return tuple(
            datum
            for datum in self.taken
            if abs(datum.row @ values)
            > _FAR * np.sqrt(datum.std**2 + datum.row @ covariance @ datum.row) + tolerance / datum.reach
        )


def datums_of(
    machine: Machine, setups: Sequence[Setup], indices: NDArray[np.intp], poses: Array, tolerance: float
) -> Datums:
    """Return what the set-ups bring; raises ReadingError when readings are too few for the datums of their set-up.

    indices : (m,) of the set-ups; poses : (m, q) m or rad; tolerance : m
    """
    count = len(indices)
    free, spread, taken = np.eye(count), np.zeros((count, count)), list[Datum]()
    for index in np.unique(indices):
        mine, setup = np.flatnonzero(indices == index), setups[index]
        own, stds = _own_rows(machine, setup, poses[mine]), np.array([unknown.std for unknown in setup.unknowns])
        off = _are_datums(setup, own, stds, tolerance)
        _refuse_few(setup, len(mine), int(off.sum()))
        inverse = np.linalg.pinv(own[:, off])
        free[np.ix_(mine, mine)] -= own[:, off] @ inverse
        spread[np.ix_(mine, mine)] = own[:, ~off] @ np.diag(stds[~off] ** 2) @ own[:, ~off].T
        for column, part in zip(np.flatnonzero(off).tolist(), inverse, strict=True):
            row = np.zeros(count)
            row[mine] = part
            unknown, reach = setup.unknowns[column], max(float(np.max(np.abs(own[:, column]))), 1e-12)
            taken.append(Datum(setup.name, unknown.name, unknown.std, row, reach))
    return Datums(free, spread, tuple(taken))


def _own_rows(machine: Machine, setup: Setup, poses: Array) -> Array:
    """Return how the unknowns of a set-up show in its readings, (m, unknowns)."""
    model, place = model_of(setup), Place(machine, poses, setup.moves)
    direction = np.array(setup.direction)
    columns = [model.own(setup, unknown.name, direction, place) for unknown in setup.unknowns]
    return np.array(columns).reshape(len(columns), len(poses)).T


def _are_datums(setup: Setup, own: Array, stds: Array, tolerance: float) -> NDArray[np.bool_]:
    """Return which unknowns are taken off, (unknowns,): zeros, and slopes that may hide the tolerance."""
    names = [unknown.name for unknown in setup.unknowns]
    wide = GUARD * stds * np.max(np.abs(own), axis=0, initial=0.0) > tolerance
    return np.array([n == "zero" or (n == "slope" and bool(w)) for n, w in zip(names, wide, strict=True)], dtype=bool)


def _refuse_few(setup: Setup, readings: int, datums: int) -> None:
    if readings <= datums:
        what = f'{readings} reading(s) with "{setup.name}" cannot tell the machine from the set-up'
        raise ReadingError(what, f"Take {datums + 1} or more with it, or leave it out")
