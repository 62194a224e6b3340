"""Set-ups, places and readings as somebody gives them in Python.

Set-ups have the keys of campaign.toml, whose quantities are texts with their units. Places and readings are arrays of
the core, lists, tables, files; a table of readings has the columns of a file of readings.
"""

from __future__ import annotations

import csv
import math
import re
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
from axiscal.language.spoken import joined, put
from axiscal.measurement.instruments.written import name_of
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Place, Reading, refuse_other_values, units_of
from axiscal_core.instrument import Instrument
from axiscal_core.places import Places, Readings
from axiscal_core.refusals import listed, one
from axiscal_core.units import METRES, RADIANS, quantities

GivenPlaces: TypeAlias = Places | Readings | Sequence[Place]
GivenReadings: TypeAlias = Readings | Iterable[Reading] | Mapping[str, Sequence[object]] | str | Path
"""Arrays, a list, a table such as a DataFrame, or a file that `axiscal data estimate` reads."""


SetupKeys = Mapping[str, Any]
"""A set-up before it stands on a machine: the keys of a [[setups]] table of campaign.toml."""


def setup(
    instrument: str | type[Instrument],
    direction: str | Sequence[float] | None = None,
    *,
    moves: Sequence[str] | None = None,
    name: str | None = None,
    **keys: Any,
) -> SetupKeys:
    """Return a set-up with the instrument's usual noise, unknowns and times.

    instrument : its name, or a class derived from `axiscal_core.Instrument`
    direction : "x", "-y" or a vector, for instruments that read along or about one
    moves : axes that move while it is read; one of your own, and most of those that read along a line, need them
    keys : of campaign.toml, quantities as text: noise="0.3 um", approach="both", park={"Y": "250 mm"}
    """
    one("setup", "instrument", instrument, (str, type), '"interferometer", or a class of your own')
    for axis in one("setup", "moves", moves or (), Sequence, 'such as ["X", "Y"]'):
        one("setup", "moves", axis, str, 'such as ["X", "Y"]')
    if isinstance(instrument, type):
        name, instrument = name or instrument.__name__.lower(), name_of(instrument)
    usual = " ".join([instrument, *([direction] if isinstance(direction, str) else []), *(moves or ())])
    stated = {"name": name or usual, "instrument": instrument, "direction": direction, "moves": moves, **keys}
    return {key: value for key, value in stated.items() if value is not None}


def mounted(instrument: Instrument) -> SetupKeys:
    """Return the set-up of an instrument that is mounted already, with its noise, unknowns and times."""
    made = type(instrument)

    def as_mounted(own: Instrument, *_: object) -> None:
        own.__dict__.update(instrument.__dict__)

    title = f"{made.__qualname__} {instrument.name}"
    own = {"__init__": as_mounted, "__qualname__": title, "__module__": made.__module__}
    name = name_of(type(made.__name__, (made,), own))
    return {"name": instrument.name, "instrument": name, "moves": [*instrument.moves]}


_OF_SETUP = re.compile(r" in \[setups\[(\d+)\]\]|setups\[(\d+)\]\.")
"""A key of a set-up, and a table of keys."""


def of_objects(fault: InputError, names: Sequence[str]) -> InputError:
    """Return a fault in the text of a case as one of the objects that were given.  names : of its set-ups"""
    told = _of_object(fault, names)
    told.beside = [[_of_object(each, names) for each in alike] for alike in fault.beside]
    return told


def _of_object(fault: InputError, names: Sequence[str]) -> InputError:
    text = str(fault.what)
    found = _OF_SETUP.search(text)
    told = fault.placed("Case" if found is None else f'Case: setup "{names[int(found[1] or found[2]) - 1]}"')
    told.what = put("{text}", text=_OF_SETUP.sub("", text))
    return told


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
    places = places.places if isinstance(places, Readings) else places
    if isinstance(places, Places):
        axes = [RADIANS if axis.rotary else METRES for axis in described.machine.axes]
        quantities(places.given, where, argument, (None, None), axes, posed=True)  # texts are of the axes' kinds
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
    taken = _of_arrays(readings, description, where) if isinstance(readings, Readings) else tuple(readings)
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


def _of_arrays(readings: Readings, description: CampaignDescription, where: str) -> tuple[Reading, ...]:
    """Return readings one by one; raises axiscal_core.InputError where numbers are too few, too many, or others."""
    places = places_of(readings.places, description, where, "places")
    each = [[METRES if unit == "um" else RADIANS for unit in units_of(description.setup(p.setup))] for p in places]
    every = [of for kinds in each for of in kinds]
    values = iter(quantities(readings.given, where, "values", (len(every),), every).tolist())
    if readings.given_std is not None:
        quantities(readings.given_std, where, "std", (len(each),), [kinds[0] for kinds in each], posed=True)
    found = []
    for i, (place, kinds) in enumerate(zip(places, each, strict=True)):
        first, *others = (next(values) for _ in kinds)
        std, time = (None if given is None else float(given[i]) for given in (readings.std, readings.time))
        found.append(Reading(place.setup, place.pose, place.approach, first, std, others=tuple(others), time=time))
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
