"""Places and readings as somebody gives them in Python: arrays of the core, lists, tables, files."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
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


def places_of(places: GivenPlaces, described: CampaignDescription, where: str, argument: str) -> list[Place]:
    """Return places, one by one; raises ReadingError for one that no set-up can be read at."""
    if isinstance(places, Places):
        rows = zip(places.instruments, places.poses.tolist(), places.sides.astype(int).tolist(), strict=True)
        found = [Place(name, tuple(pose), tuple(sides)) for name, pose, sides in rows]
    else:
        listed(where, argument, places)
        found = [one(where, argument, each, Place, "Places(setup, poses)") for each in places]
    for number, place in enumerate(found, start=1):
        _refuse_foreign(place, (), described, f"{where}: {argument}", number)
    return found


def readings_of(
    readings: GivenReadings, description: CampaignDescription, where: str, argument: str
) -> tuple[CampaignDescription, tuple[Reading, ...]]:
    """Return readings one by one, and the description with what a file of them says."""
    one(where, argument, readings, (Readings, Iterable, str, Path), 'a list of Reading, or "readings.csv"')
    if isinstance(readings, str | Path):
        found = file_readings(
            read_any(Path(readings), description.machine.axes, description.setups), description, readings
        )
        refuse_implausible(found[1], description, readings)
        return found[0], tuple(found[1])
    if isinstance(readings, Mapping) or hasattr(readings, "to_csv"):
        with TemporaryDirectory(prefix="axiscal-") as folder:
            try:
                return readings_of(_written(readings, Path(folder) / "table.csv"), description, where, argument)
            except InputError as failure:
                raise failure.placed(argument, failure.line) from None
    taken = _of_arrays(readings, description) if isinstance(readings, Readings) else tuple(readings)
    for number, reading in enumerate(taken, start=1):
        own = one(where, argument, reading, Reading, "a list of Reading")
        numbers = (*own.values, 1.0 if own.std is None else own.std)
        _refuse_foreign(own, numbers, description, argument, number)
    return description, taken


def _written(table: Any, file: Path) -> Path:
    """Write a table to a file of readings, and return it.  table : columns by name"""
    if len({len(table[name]) for name in table}) != 1:
        raise ReadingError("the table has columns of other lengths", "Give one value a reading in each")
    with file.open("w", encoding="utf-8", newline="") as out:
        csv.writer(out).writerows([[*table], *zip(*(table[name] for name in table), strict=True)])
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


def _refuse_foreign(
    taken: Reading | Place, numbers: Sequence[float], description: CampaignDescription, source: str, number: int
) -> None:
    """Raise ReadingError, with its number from 1, for a place or a reading that no set-up of the campaign can have.

    numbers : values of a reading, and its std; none of a place
    """
    names, sides = [axis.name for axis in description.machine.axes], taken.approach
    try:
        setup = description.setup(taken.setup)
        if numbers:
            refuse_other_values(setup, len(numbers) - 1)
        if len(taken.pose) != len(names) or len(sides) != len(names) or {*sides} - {-1, 0, 1}:
            remedy = "Give each of {axes} a coordinate and a side"
            raise ReadingError("pose and approach do not have one number an axis", remedy, axes=joined(names))
        if (
            not all(isinstance(each, Real) and np.isfinite(each) for each in numbers)
            or min(numbers[-1:], default=1) <= 0
        ):
            raise ReadingError("its values or its std are no numbers", "Give finite ones, and a std above zero")
        placed_pose(setup, description.machine, dict(zip(names, taken.pose, strict=True)))
    except InputError as failure:
        raise ReadingError(failure.what, failure.remedy, source, number) from None
