"""Causes of type B that are there, and what one standard deviation of each does to the readings; see `type_b`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.description.type_b import Read, TypeB, rows_of
from axiscal.measurement.instrument import instrument_of, model_of
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.reading_rows import numbers_of_setups
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False)
class Contribution:
    """One cause that is there.

    owner : the set-up or instrument whose readings share it, "" for all; stated : whether its size is no default
    effects : what one standard deviation does to each number of the readings, (m,) m or rad
    """

    row: TypeB
    owner: str
    stated: bool
    effects: Array


def contributions(
    observation: Observation, places: Places, values: Sequence[tuple[float, ...]] | None = None, usual: bool = True
) -> list[Contribution]:
    """Return the type B contributions, causes without effect left out.

    values : of each reading, m or rad; None before they are read; usual : with sizes that nobody stated
    """
    found, each = dict[tuple[str, str], Contribution](), numbers_of_setups(observation.setups)[places.setups]
    first = np.cumsum(each) - each
    for index, chosen in places.by_setup():
        setup, mine = observation.setups[index], np.arange(len(places))[chosen]
        kind = model_of(setup)(setup, observation.machine)
        at = kind.places(places.poses[chosen], places.approaches[chosen])
        ways = kind.slopes(at).moved.swapaxes(0, 1)
        shown = np.zeros(ways.shape[:2]) if values is None else np.array([values[i] for i in mine], dtype=float).T
        read = Read(kind, at, ways, shown)
        owners = {"set-up": setup.name, "instrument": setup.instrument, "machine": ""}
        for row in rows_of(instrument_of(setup)):
            stated, key = row.name in dict(setup.stated), (row.name, owners[row.shared])
            if not row.met(setup) or not (usual or stated):
                continue
            before = found.get(key, Contribution(row, key[1], True, np.zeros(each.sum())))
            for number, effect in enumerate(row.column(read)):
                before.effects[first[mine] + number] += effect
            found[key] = replace(before, stated=stated and before.stated)
    return [each for each in found.values() if np.any(each.effects)]
