"""The columns of type B causes, for readings as they came; see `type_b`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.description.type_b import TYPE_B, Read, TypeB
from axiscal.estimation.promise.passing import Passing
from axiscal.measurement.instrument import model_of
from axiscal.measurement.instruments.kind import Nominal
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False)
class Contribution:
    """One cause that is there.

    owner : the set-up or instrument whose readings share it, "" for all; stated : whether its size is no default
    effects : what one standard deviation does to each number of the readings of a set-up, (k, r) m or rad, by its index
    """

    row: TypeB
    owner: str
    stated: bool
    effects: Mapping[int, Array]


def contributions(
    observation: Observation, places: Places, values: Sequence[tuple[float, ...]] | None = None, usual: bool = True
) -> list[Contribution]:
    """Return the type B contributions, causes without effect left out.

    values : of each reading, m or rad; None before they are read; usual : with sizes that nobody stated
    """
    found = dict[tuple[str, str], Contribution]()
    for index, read in _by_setup(observation, places, values):
        for row in TYPE_B:
            stated = row.name in dict(read.setup.stated)
            if not row.met(read.setup) or not (usual or stated):
                continue
            owner, effect = _owner(row, read.setup), row.column(read)
            before = found.get((row.name, owner), Contribution(row, owner, True, {}))
            effects = {**before.effects, index: effect + before.effects.get(index, 0.0)}
            found[row.name, owner] = Contribution(row, owner, stated and before.stated, effects)
    return [each for each in found.values() if any(np.any(effect) for effect in each.effects.values())]


def _owner(row: TypeB, setup: Setup) -> str:
    return {"set-up": setup.name, "instrument": setup.instrument, "machine": ""}[row.shared]


def _by_setup(
    observation: Observation, places: Places, values: Sequence[tuple[float, ...]] | None
) -> Iterator[tuple[int, Read]]:
    """Yield the readings of each set-up, with its index."""
    for index, chosen in places.by_setup():
        setup, model = observation.setups[index], model_of(observation.setups[index])
        nominal = Nominal(observation.machine, places.poses[chosen], setup.moves, None, places.approaches[chosen])
        own = np.array(setup.direction)
        each = [own if along is None else along for along in directions_of(setup)]
        ways = np.stack([model.direction_of(setup, along, nominal) for along in each])
        mine = [] if values is None else [values[i] for i in np.arange(len(places))[chosen]]
        yield index, Read(setup, nominal, ways, np.array(mine, dtype=float).T if mine else np.zeros(ways.shape[:2]))


def columns_of(causes: Sequence[Contribution], places: Places, reading: NDArray[np.intp]) -> Array:
    """Return what one standard deviation of each cause does to each number, (m, causes) m or rad.

    reading : (m,) the place that each number belongs to, ascending
    """
    columns, at = np.zeros((len(reading), len(causes))), dict(places.by_setup())
    for number, each in enumerate(causes):
        for index, effect in each.effects.items():
            first = np.searchsorted(reading, np.arange(len(places))[at[index]])
            for k, one in enumerate(effect):
                columns[first + k, number] = one
    return columns


def type_b_columns(
    observation: Observation,
    readings: Sequence[Reading],
    places: Places,
    reading: NDArray[np.intp],
    usual: bool = True,
) -> tuple[Passing, Array]:
    """Return the columns of `contributions`, and apart from them those that follow from what was read, (m, h).

    reading : as for `columns_of`. No reading teaches their sizes.
    """
    found = contributions(observation, places, [each.values for each in readings], usual)
    common, held = ([each for each in found if each.row.of_values == apart] for apart in (False, True))
    sizes = np.full(len(common), -1, dtype=np.intp)
    return Passing(columns_of(common, places, reading), sizes), columns_of(held, places, reading)
