"""The columns of what no reading shows, of readings as they were taken; see `type_b`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.instrument import model_of
from axiscal.measurement.instruments.kind import Nominal
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.promise.passing import Passing
from axiscal.promise.type_b import TYPE_B, Read, TypeB


@dataclass(frozen=True, eq=False)
class Contribution:
    """One cause that is there.

    owner : the set-up or instrument whose readings share it, "" for all; stated : whether its size is no default
    column : (m,) what one standard deviation does to each number, m or rad
    """

    row: TypeB
    owner: str
    stated: bool
    column: Array


def contributions(
    observation: Observation,
    readings: Sequence[Reading],
    places: Places,
    reading: NDArray[np.intp],
    usual: bool = True,
) -> list[Contribution]:
    """Return what no reading shows, causes without effect left out.

    reading : (m,) the reading of each number, ascending; usual : with sizes that nobody stated
    """
    found = dict[tuple[str, str], Contribution]()
    for read, first in _by_setup(observation, readings, places, reading):
        for row in TYPE_B:
            stated = row.name in dict(read.setup.stated)
            if not row.met(read.setup) or not (usual or stated):
                continue
            column, owner = np.zeros(len(reading)), _owner(row, read.setup)
            for number, each in enumerate(row.column(read)):
                column[first + number] = each
            before = found.get((row.name, owner))
            if before is not None:
                column, stated = column + before.column, stated and before.stated
            found[row.name, owner] = Contribution(row, owner, stated, column)
    return [each for each in found.values() if np.any(each.column)]


def _owner(row: TypeB, setup: Setup) -> str:
    return {"set-up": setup.name, "instrument": setup.instrument, "machine": ""}[row.shared]


def _by_setup(
    observation: Observation,
    readings: Sequence[Reading],
    places: Places,
    reading: NDArray[np.intp],
) -> Iterator[tuple[Read, NDArray[np.intp]]]:
    """Yield the readings of each set-up, and which number of all is the first of each of them, (r,)."""
    for index, chosen in places.by_setup():
        which = np.arange(len(places))[chosen]
        setup, model = observation.setups[index], model_of(observation.setups[index])
        nominal = Nominal(observation.machine, places.poses[which], setup.moves, None, places.approaches[which])
        own = np.array(setup.direction)
        each = [own if along is None else along for along in directions_of(setup)]
        ways = np.stack([model.direction_of(setup, along, nominal) for along in each])
        values = np.array([readings[i].values for i in which], dtype=float).T
        yield Read(setup, nominal, ways, values), np.searchsorted(reading, which)


def type_b_columns(
    observation: Observation,
    readings: Sequence[Reading],
    places: Places,
    reading: NDArray[np.intp],
    usual: bool = True,
) -> tuple[Passing, Array]:
    """Return the columns of `contributions`, and apart from them those that follow from what was read, (m, h)."""
    found = contributions(observation, readings, places, reading, usual)
    columns, held = (
        np.array([each.column for each in found if each.row.of_values == apart]).reshape(-1, len(reading)).T
        for apart in (False, True)
    )
    return Passing(columns, np.full(columns.shape[1], -1, dtype=np.intp)), held
