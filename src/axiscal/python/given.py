"""Places and readings as somebody gives them in Python: arrays of the core, lists, tables, files."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence, Sized
from numbers import Real
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeAlias

import numpy as np

from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import file_readings, placed_pose
from axiscal.exceptions import InputError, ReadingError
from axiscal.language.spoken import joined
from axiscal.measurement.instrument import values_of
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Place, Reading, refuse_other_values
from axiscal_core.places import Places, Readings
from axiscal_core.refusals import finite, listed, one

GivenPlaces: TypeAlias = Places | Sequence[Place]
GivenReadings: TypeAlias = Readings | Iterable[Reading] | Mapping[str, Sequence[object]] | str | Path
"""Arrays, a list, a table such as a DataFrame, or a file that `axiscal data estimate` reads."""


class PlannedPlaces(Places):
    """Places of the core that are `Place`, one by one.  axes : how many a machine has"""

    def __init__(self, places: Sequence[Place], axes: int) -> None:
        shape = len(places), axes
        poses, sides = (np.reshape([getattr(each, of) for each in places], shape) for of in ("pose", "approach"))
        super().__init__([place.setup for place in places], poses, sides)
        self._each = tuple(places)

    def __getitem__(self, index: int) -> Place:
        return self._each[index]

    def __iter__(self) -> Iterator[Place]:
        return iter(self._each)


def places_of(places: GivenPlaces, described: CampaignDescription, where: str, argument: str) -> list[Place]:
    """Return places, one by one; raises ReadingError for one that no set-up can be read at."""
    if isinstance(places, Places):
        rows = zip(places.instruments, places.poses.tolist(), places.sides.astype(int).tolist(), strict=True)
        found = [Place(name, tuple(pose), tuple(sides)) for name, pose, sides in rows]
    else:
        listed(where, argument, places)
        found = [one(where, argument, each, Place, "Places(setup, poses)") for each in places]
    for number, place in enumerate(found, start=1):
        _refuse_foreign(place, described, f"{where}: {argument}", number)
    return found


def readings_of(
    readings: GivenReadings, description: CampaignDescription, where: str, argument: str
) -> tuple[CampaignDescription, tuple[Reading, ...]]:
    """Return readings one by one, and the description with what a file of them says."""
    one(where, argument, readings, (Readings, Iterable, str, Path), 'a list of Reading, or "readings.csv"')
    if isinstance(readings, str | Path):
        raw = read_any(Path(readings), description.machine.axes, description.setups)
        described, placed = file_readings(raw, description, readings)
        refuse_implausible(placed, description, readings)
        return described, tuple(placed)
    if isinstance(readings, Mapping) or hasattr(readings, "columns"):
        with TemporaryDirectory(prefix="axiscal-") as folder:
            try:
                return readings_of(_written(readings, Path(folder) / "table.csv"), description, where, argument)
            except InputError as failure:
                raise failure.placed(argument, failure.line) from None
    taken = _of_arrays(readings, description) if isinstance(readings, Readings) else tuple(readings)
    for number, reading in enumerate(taken, start=1):
        _refuse_foreign(one(where, argument, reading, Reading, "a list of Reading"), description, argument, number)
    refuse_implausible(taken, description, argument)
    return description, taken


def _written(table: Any, file: Path) -> Path:
    """Write a table to a file of readings, and return it.  table : columns by name"""
    columns = {name: table[name] for name in getattr(table, "columns", table)}
    listed = [isinstance(each, Sized) and not isinstance(each, str) for each in columns.values()]
    if not all(listed) or len({*map(len, columns.values())}) != 1:
        raise ReadingError("the table has columns of other lengths", "Give one value a reading in each")
    with file.open("w", encoding="utf-8", newline="") as out:
        csv.writer(out).writerows([[*columns], *zip(*columns.values(), strict=True)])
    return file


def _of_arrays(readings: Readings, description: CampaignDescription) -> tuple[Reading, ...]:
    """Return readings one by one; raises axiscal_core.InputError where numbers are too few or too many."""
    places = readings.places
    counts = [values_of(description.setup(name)) for name in places.instruments]
    values = iter(finite("Readings", "values", readings.values, (sum(counts),)).tolist())
    found = []
    for i, (name, count) in enumerate(zip(places.instruments, counts, strict=True)):
        pose, sides = tuple(places.poses[i].tolist()), tuple(places.sides[i].astype(int).tolist())
        first, *others = (next(values) for _ in range(count))
        std, time = (None if each is None else float(each[i]) for each in (readings.std, readings.time))
        found.append(Reading(name, pose, sides, first, std, others=tuple(others), time=time))
    return tuple(found)


def _numbers(given: Any) -> bool:
    """Return whether these are finite numbers, one after another."""
    return isinstance(given, Sequence | np.ndarray) and all(
        isinstance(each, Real) and math.isfinite(each) for each in given
    )


def _refuse_foreign(taken: Reading | Place, description: CampaignDescription, source: str, number: int) -> None:
    """Raise ReadingError, with its number from 1, for a place or a reading that no set-up of the campaign can have."""
    names, placing = [axis.name for axis in description.machine.axes], (taken.pose, taken.approach)
    try:
        setup = description.setup(taken.setup)
        if not all(_numbers(each) and len(each) == len(names) for each in placing) or {*taken.approach} - {-1, 0, 1}:
            remedy = "Give each of {axes} a coordinate and a side"
            raise ReadingError("pose and approach do not have one number an axis", remedy, axes=joined(names))
        if isinstance(taken, Reading):
            std, time = (1.0 if each is None else each for each in (taken.std, taken.time))
            if not (_numbers(taken.others) and _numbers([taken.value, std, time])) or std <= 0:
                raise ReadingError("its values or its std are no numbers", "Give finite ones, and a std above zero")
            refuse_other_values(setup, 1 + len(taken.others))
        placed_pose(setup, description.machine, dict(zip(names, taken.pose, strict=True)))
    except InputError as failure:
        raise ReadingError(failure.what, failure.remedy, source, number) from None
