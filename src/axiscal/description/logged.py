"""Readings of the log that a measuring program has written, by the lists that stand beside the program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import placed_pose
from axiscal.exceptions import Faults, InputError, ReadingError
from axiscal.measurement.readers.axes import read_approach, read_position
from axiscal.measurement.readers.csv_readings import RawReading
from axiscal.measurement.readers.csv_table import parse_table, unshielded
from axiscal.measurement.readers.text import read_text
from axiscal.measurement.readers.touch_log import LISTS, LoggedTouch, TouchLog, plan_code, read_touch_log
from axiscal.measurement.touched import TOUCHES, all_round, read_as


@dataclass(frozen=True, slots=True)
class ListedPlace:
    """A reading of a list: its set-up, its coordinates (m or rad) and sides by axis."""

    setup: str
    position: Mapping[str, float]
    approach: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class Logged:
    """The readings of a log in its order, and what is to be said of it."""

    readings: tuple[RawReading, ...]
    said: tuple[str, ...]


def logged_readings(file: Path, folder: Path, campaign: CampaignDescription) -> Logged:
    """Return the readings of a log.  folder : where the programs were written, with their lists

    Raises ReadingError for a log of another plan, for lines missing, doubled or out of order, and for touches off the
    ball.
    """
    log = read_touch_log(file)
    planned = _planned(log, file, folder)
    runs = [(number, tuple(each)) for number, each in groupby(log.touches, key=lambda touch: touch.reading)]
    faults, readings, said = Faults(), list[RawReading](), list(log.said)
    _refuse_doubled(runs, file)
    for number, touched in runs:
        with faults.noted():
            if number not in planned:
                what = "the plan has no reading {number}"
                raise ReadingError(what, _AS_WRITTEN, file, touched[0].line, number=number)
            if _whole(number, touched, bool(log.said), file):
                readings.append(_reading(number, touched, planned[number], campaign, file))
            else:
                said.append(f"reading {number} has {len(touched)} of {TOUCHES} touches and is left out")
    faults.refuse()
    begun, there = {reading.setup for reading in readings}, {reading.number for reading in readings}
    lacking = [number for number, each in planned.items() if each.setup in begun and number not in there]
    if lacking:
        said.append(f"of the readings that are planned {_numbers(lacking)} do not stand in the log")
    return Logged(tuple(readings), tuple(f"{file}: {each}." for each in said))


_AS_WRITTEN = "Give the file as the control wrote it"


def _planned(log: TouchLog, file: Path, folder: Path) -> dict[int, ListedPlace]:
    """Return the readings of the lists in a folder by number; raises ReadingError unless they are of the log's plan."""
    names = folder / LISTS.format(log.code)
    if not names.is_file():
        what = "this is the log of plan {code}, and {folder} has no programs of that plan ({list})"
        remedy = "Say by --programs into which folder plan --log wrote the programs"
        raise ReadingError(what, remedy, file, code=log.code, folder=folder, list=names.name)
    lists = [folder / Path(name).name for name in read_text(names).lines if name.strip()]
    texts = {path: "\n".join(read_text(path).lines) for path in lists}
    code = plan_code(list(texts.values()))
    if code != log.code:
        what = "the lists of plan {code} have been changed, or written anew for another plan"
        raise ReadingError(what, "Write the programs of that plan into a folder of their own", names, code=log.code)
    return {number: each for path, text in texts.items() for number, each in _rows(text, str(path))}


def _rows(text: str, name: str) -> list[tuple[int, ListedPlace]]:
    table = parse_table(text, name)
    number, setup = table.one_of("reading", "reading"), table.one_of("setup", "setup")
    rows = []
    for row in table.rows:
        planned = ListedPlace(unshielded(row.text(setup)), read_position(table, row), read_approach(table, row))
        rows.append((int(row.text(number)), planned))
    return rows


def _refuse_doubled(runs: Sequence[tuple[int, Sequence[LoggedTouch]]], file: Path) -> None:
    first: dict[int, int] = {}
    for number, touched in runs:
        if number in first:
            what = "reading {number} was touched in the lines from {earlier} on, and here again"
            remedy = "Take out the lines of the run that does not count"
            raise ReadingError(what, remedy, file, touched[0].line, number=number, earlier=first[number])
        first[number] = touched[0].line


def _whole(number: int, touched: Sequence[LoggedTouch], broken: bool, file: Path) -> bool:
    """Return whether all touches of a reading are there, in their order; raises ReadingError if nothing explains a gap.

    broken : the log says of itself that a run ended early
    """
    numbers = [touch.touch for touch in touched]
    if numbers == list(range(1, TOUCHES + 1)):
        return True
    if broken and numbers == list(range(1, len(numbers) + 1)) and len(numbers) < TOUCHES:
        return False
    seen = ", ".join(map(str, numbers[:12]))
    what = "reading {number} has the touches {seen} where 1 to {most} were expected"
    remedy = "Lines are missing, doubled or moved. Give the file as the control wrote it"
    raise ReadingError(what, remedy, file, touched[0].line, number=number, seen=seen, most=TOUCHES)


def _reading(
    number: int, touched: Sequence[LoggedTouch], planned: ListedPlace, campaign: CampaignDescription, file: Path
) -> RawReading:
    machine, line = campaign.machine, touched[0].line
    try:
        setup = campaign.setup(planned.setup)
        pose = np.array(placed_pose(setup, machine, planned.position))
        hits = []
        for touch in touched:
            hit = pose.copy()
            hit[[machine.index(axis) for axis in "XYZ"]] = touch.at
            hits.append(hit)
        value, *others = read_as(machine, setup, pose, hits, all_round(machine, pose))
    except InputError as failure:
        what = "reading {number}: {fault}"
        raise ReadingError(what, failure.remedy, file, line, number=number, fault=failure.what) from None
    moving = {machine.axes[k].name for k in setup.moves}
    sides = {name: side for name, side in planned.approach.items() if name in moving}
    return RawReading(
        setup.name, planned.position, sides, value, None, "length", line, others=tuple(others), number=number
    )


def _numbers(numbers: Sequence[int]) -> str:
    shown = ", ".join(map(str, numbers[:12]))
    return f"{shown} and {len(numbers) - 12} more" if len(numbers) > 12 else shown
