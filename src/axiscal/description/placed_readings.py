"""The place that a person states for a reading, checked against the set-up and the machine.

Readings of the log that a measuring program has written, by the lists that stand beside the program.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import NoReturn

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.exceptions import DescriptionError, Faults, InputError, ReadingError
from axiscal.language.spoken import joined, later, said
from axiscal.machine import Axis, Machine
from axiscal.machine.axis import letter_direction
from axiscal.machine.entry import parse_error_name
from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.kinds import Held
from axiscal.measurement.charts.room import Chart
from axiscal.measurement.instrument import INSTRUMENTS, values_of
from axiscal.measurement.readers.csv_readings import RawReading
from axiscal.measurement.readers.csv_table import parse_table, read_approach, read_position
from axiscal.measurement.readers.text_file import read_text
from axiscal.measurement.readers.touch_log import LISTS, LoggedTouch, TouchLog, plan_code, read_touch_log
from axiscal.measurement.reading import Reading, refuse_other_values
from axiscal.measurement.setup import Setup
from axiscal.measurement.touched import TOUCHES, met_from, read_as
from axiscal.numerics import Array
from axiscal.units import format_quantity


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
    faults, readings, found = Faults(), list[RawReading](), list(log.said)
    _refuse_doubled(runs, file)
    for number, touched in runs:
        with faults.noted():
            if number not in planned:
                what = "the plan has no reading {number}"
                raise ReadingError(what, _AS_WRITTEN, file, touched[0].line, number=number)
            if _whole(number, touched, bool(log.said), file):
                readings.append(_reading(number, touched, planned[number], campaign, file))
            else:
                found.append(f"reading {number} has {len(touched)} of {TOUCHES} touches and is left out")
    faults.refuse()
    begun, there = {reading.setup for reading in readings}, {reading.number for reading in readings}
    lacking = [number for number, each in planned.items() if each.setup in begun and number not in there]
    if lacking:
        numbers = joined([str(number) for number in lacking], most=12)
        found.append(said("of the readings that are planned {numbers} do not stand in the log", numbers=numbers))
    return Logged(tuple(readings), tuple(f"{file}: {each}." for each in found))


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
        planned = ListedPlace(row.text(setup), read_position(table, row), read_approach(table, row))
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
        value, *others = read_as(machine, setup, pose, hits, met_from(machine, pose))
    except InputError as failure:
        what = "reading {number}: {fault}"
        raise ReadingError(what, failure.remedy, file, line, number=number, fault=failure.what) from None
    moving = {machine.axes[k].name for k in setup.moves}
    sides = {name: side for name, side in planned.approach.items() if name in moving}
    return RawReading(
        setup.name, planned.position, sides, value, None, "length", line, others=tuple(others), number=number
    )


_ALONG = 1 - 1e-9
"""Rounding of a unit vector that points along an axis."""
_OFF = 1e-4
"""m, how far from its place the tool point may be said to stand."""
_STILL = {False: 1e-6, True: math.radians(1e-5)}
"""How far from its park position an axis may be said to stand: 1 um, or 1e-5 deg."""


def placed_readings(
    raw: tuple[RawReading, ...], campaign: CampaignDescription, file: str | Path
) -> tuple[Reading, ...]:
    """Return readings of a file as readings of the campaign; raises ReadingError at the line that does not fit."""
    readings, faults = [], Faults()
    for row in raw:
        try:
            readings.append(_placed(row, campaign))
        except InputError as failure:
            faults.found.append(ReadingError(failure.what, failure.remedy, file, row.line))
    faults.refuse()
    return tuple(readings)


def placed_pose(setup: Setup, machine: Machine, position: Mapping[str, float]) -> tuple[float, ...]:
    """Return the pose that a set-up and coordinates by axis (m or rad) mean; axes left out must be parked.

    Raises ReadingError for an axis that is not there, that is parked elsewhere, or a position outside its travel.
    """
    _refuse_unknown_axis(position, machine)
    if setup.chart is not None:
        return _on_chart(setup, setup.chart, machine, position)
    return tuple(_coordinate(setup, axis, index, position) for index, axis in enumerate(machine.axes))


def _on_chart(setup: Setup, chart: Chart, machine: Machine, position: Mapping[str, float]) -> tuple[float, ...]:
    """Return the pose on a chart; the linear axes follow from the others where one place is held, if they are left out.

    Raises ReadingError for a place that is further from the chart than what touches can follow.
    """
    rotary = {axis.name: position[axis.name] for axis in machine.axes if axis.rotary and axis.name in position}
    if isinstance(chart, Held) and all(machine.axes[k].name in rotary for k in chart.turning):
        places = np.array([[position[machine.axes[k].name] for k in chart.turning]])
        following = dict(zip((axis.name for axis in machine.axes), chart.poses(places)[0].tolist(), strict=True))
        position = {**following, **position}
    pose = tuple(_coordinate(setup, axis, index, position) for index, axis in enumerate(machine.axes))
    off, allowed = off_chart(machine, chart, np.array(pose)), setup.stroke or _OFF
    if off > allowed:
        far = format_quantity(off, "mm", 3)
        what, ball = 'this place is {far} from the line or circle, where "{setup}" is read', ""
        if setup.artefact is not None:
            what = 'this place is {far} from ball {ball}, where "{setup}" is read'
            nearest = int(setup.artefact.nearest(frames(machine, np.array([pose])).tcp, setup.balls)[0])
            ball = setup.artefact.balls[nearest].name
        remedy = "Give the place where the tool point stood, or another set-up"
        raise ReadingError(what, remedy, far=far, ball=ball, setup=setup.name)
    return pose


def placed_approach(setup: Setup, machine: Machine, approach: Mapping[str, int]) -> tuple[int, ...]:
    """Return the directions by axis as a tuple, 0 where not said; raises ReadingError for an axis that is parked."""
    _refuse_unknown_axis(approach, machine)
    for name in approach:
        if machine.index(name) not in setup.moves:
            what = '{name} is parked in the set-up "{setup}" and has no direction of approach'
            raise ReadingError(what, "Leave it out of the approach", name=name, setup=setup.name)
    return tuple(approach.get(axis.name, 0) for axis in machine.axes)


def _placed(row: RawReading, campaign: CampaignDescription) -> Reading:
    setup, sign = _setup_of(row, campaign)
    named = values_of(setup) == 1 or row.by_station == bool(setup.stations)
    refuse_other_values(setup, 1 + len(row.others) if named else 0, row.dimension)
    _refuse_other_base(row, setup)
    position, approach = row.position, row.approach
    if row.test is not None:
        moving = campaign.machine.axes[setup.moves[0]].name
        position, approach = {moving: position[""]}, {moving: approach[""]}
    pose = placed_pose(setup, campaign.machine, position)
    directions = placed_approach(setup, campaign.machine, approach)
    value, others = sign * row.value, row.others
    reading = Reading(setup.name, pose, directions, value, row.std, row.line, others=others, time=row.time)
    return replace(reading, number=row.number, check=row.check)


def _setup_of(row: RawReading, campaign: CampaignDescription) -> tuple[Setup, int]:
    """Return the set-up of a reading, and −1 where it reads against the error that the file names."""
    if row.setup:
        return campaign.setup(row.setup), 1
    if row.test is not None:
        return _tested(row, campaign), 1
    if not row.error:
        return _only_setup(campaign), 1
    if row.error == "slope":
        return _levelled(row, campaign), 1
    component = 2 if row.error == "z" else parse_error_name(row.error).component % 3
    moving = {campaign.machine.index(name) for name in row.position}
    fitting = [
        setup
        for setup in campaign.setups
        if moving <= set(setup.moves)
        and INSTRUMENTS[setup.instrument].model.reads == row.dimension
        and abs(setup.direction[component]) > _ALONG
    ]
    if len(fitting) != 1:
        what = "no set-up reads a length along {axis} while {moving} moves"
        if row.dimension == "angle":
            what = "no set-up reads a rotation about {axis} while {moving} moves"
        if fitting:
            what = "several set-ups read a length along {axis} while {moving} moves"
            if row.dimension == "angle":
                what = "several set-ups read a rotation about {axis} while {moving} moves"
        remedy = "Describe exactly one set-up for it, or give READINGS.csv with a column setup"
        raise ReadingError(what, remedy, axis="xyz"[component], moving=", ".join(row.position))
    return fitting[0], 1 if fitting[0].direction[component] > 0 else -1


def _levelled(row: RawReading, campaign: CampaignDescription) -> Setup:
    """Return the set-up of a level survey that names none: the one whose level is moved along that axis."""
    (axis,) = row.position
    moving = (campaign.machine.index(axis),)
    fitting = [s for s in campaign.setups if s.moves == moving and INSTRUMENTS[s.instrument].model.reads == "angle"]
    fitting = [s for s in fitting if len(fitting) == 1 or _same_base(row, s)]
    if len(fitting) != 1:
        what = "several set-ups of this campaign read an angle while only {axis} moves"
        what = what if fitting else "no set-up of this campaign read an angle while only {axis} moves"
        raise ReadingError(what, "Say which it was, in a line # setup = name, or describe one", axis=axis)
    return fitting[0]


def _same_base(row: RawReading, setup: Setup) -> bool:
    if row.base is None or setup.base is None:
        return row.base is setup.base
    return abs(row.base - setup.base) <= _STILL[False]


def _refuse_other_base(row: RawReading, setup: Setup) -> None:
    if row.base is not None and not _same_base(row, setup):
        what = 'the level stood on a base of {base}, and that of "{setup}" has a base of {own}'
        if setup.base is None:
            what = 'the level stood on a base of {base}, and that of "{setup}" rides on what moves'
        base, own = (format_quantity(each or 0.0, "mm", 6) for each in (row.base, setup.base))
        remedy = "Let # base in the file and base in the campaign be the same"
        raise ReadingError(what, remedy, base=base, setup=setup.name, own=own)


_ASKS = {
    "positioning": later(
        "a test of positioning needs a set-up that moves one axis, linear for mm and rotary for deg, and reads along it"
    ),
    "angular": later("an angular test needs a set-up that moves one linear axis and reads an angle"),
    "straightness": later("a test of straightness needs a set-up that moves one linear axis and reads across it"),
    "circle": later("a circular test names no axes: its figures are those of `axiscal data iso230`"),
}
_ASIDE = 0.1
"""Of a direction, along an axis: less is across it."""


def _tested(row: RawReading, campaign: CampaignDescription) -> Setup:
    """Return the only set-up that reads what a test reads; raises ReadingError for none, and for several."""
    fitting = [setup for setup in campaign.setups if _reads_test(row, setup, campaign.machine)]
    if len(fitting) == 1:
        return fitting[0]
    what, names = _ASKS[row.test or "circle"], joined([each.name for each in fitting])
    what = "several set-ups read what this test reads: {names}" if fitting else what
    remedy = "Give the columns setup and X_mm, or a campaign of the one set-up that was tested"
    raise ReadingError(what, remedy, names=names)


def _reads_test(row: RawReading, setup: Setup, machine: Machine) -> bool:
    axis, reads = machine.axes[setup.moves[0]], INSTRUMENTS[setup.instrument].model.reads
    if len(setup.moves) != 1 or reads != row.dimension or row.test == "circle":
        return False
    across = abs(setup.direction[letter_direction(axis.letter)]) < _ASIDE
    fits = reads == "angle" or across == (row.test == "straightness")
    return fits and axis.rotary == (row.target_dimension == "angle")


def _only_setup(campaign: CampaignDescription) -> Setup:
    """Return the set-up of readings that name none."""
    setup = campaign.setups[0]
    if len(campaign.setups) > 1 or len(setup.moves) > 1:
        what = "the readings name neither set-up nor axis, and the campaign has more than one of them"
        raise ReadingError(what, "Give the columns setup and X_mm, or a campaign of one set-up with one moving axis")
    return setup


def _refuse_unknown_axis(names: Mapping[str, object], machine: Machine) -> None:
    try:
        for name in names:
            machine.index(name)
    except DescriptionError as failure:
        raise ReadingError(failure.what, failure.remedy) from None


def _coordinate(setup: Setup, axis: Axis, index: int, position: Mapping[str, float]) -> float:
    moves = index in setup.moves
    if axis.name not in position:
        if moves:
            what = '{axis} moves in the set-up "{setup}", and its position is not given'
            remedy = "Say where it stood, anywhere from {travel}"
            raise ReadingError(what, remedy, axis=axis.name, setup=setup.name, travel=axis.travel_text)
        return setup.park[index]
    value, unit = position[axis.name], axis.unit
    slack, (low, high) = _STILL[False] if setup.base else 1e-9 * axis.length, setup.span(axis, index)
    if not low - slack <= value <= high + slack:
        _refuse_outside(setup, axis, index, value)
    if not moves and abs(value - setup.park[index]) > _STILL[axis.rotary]:
        park = format_quantity(setup.park[index], unit, 9)
        what = '{axis} = {value}, but the set-up "{setup}" parks it at {park}'
        remedy = "Park it there in the description, or add {axis} to its moves"
        raise ReadingError(
            what, remedy, axis=axis.name, value=format_quantity(value, unit, 9), setup=setup.name, park=park
        )
    return min(max(value, low), high)


def _refuse_outside(setup: Setup, axis: Axis, index: int, value: float) -> NoReturn:
    """Raise ReadingError that names the limit: the travel, or the reach of the set-up."""
    reached = replace(axis, travel=axis.travel if setup.reach is None else setup.reach[index])
    limit = axis if reached.travel == axis.travel or not axis.travel[0] <= value <= axis.travel[1] else reached
    what, remedy = "{axis} = {shown} is outside the travel", "{axis} goes from {travel}"
    if limit.travel[0] <= value <= limit.travel[1]:
        what = "at {axis} = {shown} a foot of the {instrument} stands outside the travel"
        what = what if limit is axis else "at {axis} = {shown} a foot of the {instrument} stands outside the reach"
        remedy = "Give where the middle of its base of {base} stood; {axis} goes from {travel}"
    elif limit is reached:
        what = '{axis} = {shown} is within the travel and outside the reach of the set-up "{setup}"'
        remedy = "Its reach is {travel}: correct the reading, or the reach in campaign.toml"
    shown, base = (format_quantity(each, axis.unit, 9) for each in (value, setup.base or 0.0))
    whose = {"setup": setup.name, "instrument": setup.instrument, "base": base}
    raise ReadingError(what, remedy, None, None, axis=axis.name, shown=shown, travel=limit.travel_text, **whose)


def off_chart(machine: Machine, chart: Chart, pose: Array) -> float:
    """Return how far the tool point of a pose (q,) is from where the chart has it with the same coordinates, m."""
    nearest = chart.poses(chart.places(pose[None]))
    if not np.all(np.isfinite(nearest)):
        return float("inf")
    here, there = frames(machine, np.concatenate([pose[None], nearest])).tcp
    return float(np.linalg.norm(here - there))
