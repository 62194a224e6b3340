"""The place that a person states for a reading, checked against the set-up and the machine.

Readings of the log that a measuring program has written, by the lists that stand beside the program.

A file may say where the probe of a printer stands beside the nozzle, and where the printer has the zero of Z.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path

import numpy as np

from axiscal.description.campaign import CampaignDescription, with_offset, with_zero
from axiscal.description.setup_of_reading import setup_of
from axiscal.exceptions import Faults, InputError, ReadingError
from axiscal.language.spoken import joined, said
from axiscal.machine.axis import travel_text
from axiscal.measurement.charts.kinds import Balls, Circle
from axiscal.measurement.charts.room import Chart, arrivals
from axiscal.measurement.readers.csv_readings import RawReading, raw_pose
from axiscal.measurement.readers.csv_table import table_of
from axiscal.measurement.readers.text_file import read_text
from axiscal.measurement.readers.touch_log import LISTS, LoggedTouch, TouchLog, plan_code, read_touch_log
from axiscal.measurement.reading import Reading, in_radii, refuse_other_values
from axiscal.measurement.setup import Setup
from axiscal.measurement.touched import TOUCHES, met_from, off_ball, read_as
from axiscal.numerics import Array
from axiscal.units import format_quantity
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

_AS_WRITTEN = "Give the file as the control wrote it"


def logged_readings(
    file: Path, folder: Path, campaign: CampaignDescription
) -> tuple[tuple[RawReading, ...], tuple[str, ...]]:
    """Return the readings of a log in its order, and what is to be said of it.

    folder : where the programs were written, with their lists
    Raises ReadingError for a log of another plan, for lines missing, doubled or out of order, and for touches off the
    ball.
    """
    log, first = read_touch_log(file), dict[int, int]()
    planned, faults, readings, told = _planned(log, file, folder), Faults(), list[RawReading](), list(log.said)
    for number, run in groupby(log.touches, key=lambda touch: touch.reading):
        touched = list(run)
        line, numbers = touched[0].line, [touch.touch for touch in touched]
        if first.setdefault(number, line) < line:
            what = "reading {number} was touched in the lines from {earlier} on, and here again"
            remedy = "Take out the lines of the run that does not count"
            raise ReadingError(what, remedy, file, line, number=number, earlier=first[number])
        with faults.noted():
            if number not in planned:
                raise ReadingError("the plan has no reading {number}", _AS_WRITTEN, file, line, number=number)
            if numbers == [*range(1, TOUCHES + 1)]:
                readings.append(_logged(touched, planned[number], campaign, file))
            elif log.said and numbers == [*range(1, len(numbers) + 1)] and len(numbers) < TOUCHES:
                told.append(f"reading {number} has {len(numbers)} of {TOUCHES} touches and is left out")
            else:
                what = "reading {number} has the touches {seen} where 1 to {most} were expected"
                remedy = "Lines are missing, doubled or moved. Give the file as the control wrote it"
                seen = ", ".join(map(str, numbers[:12]))
                raise ReadingError(what, remedy, file, line, number=number, seen=seen, most=TOUCHES)
    faults.refuse()
    begun, there = {reading.setup for reading in readings}, {reading.number for reading in readings}
    lacking = [str(number) for number, each in planned.items() if each.setup in begun and number not in there]
    if lacking:
        what = "of the readings that are planned {numbers} do not stand in the log"
        told.append(said(what, numbers=joined(lacking, most=12)))
    return tuple(readings), tuple(f"{file}: {each}." for each in told)


def _planned(log: TouchLog, file: Path, folder: Path) -> dict[int, RawReading]:
    """Return the readings of the lists in a folder by number; raises ReadingError unless they are of the log's plan."""
    names = folder / LISTS.format(log.code)
    if not names.is_file():
        what = "this is the log of plan {code}, and {folder} has no programs of that plan ({list})"
        remedy = "Say by --programs into which folder plan --log wrote the programs"
        raise ReadingError(what, remedy, file, code=log.code, folder=folder, list=names.name)
    files = [read_text(folder / Path(name).name) for name in read_text(names).lines if name.strip()]
    if plan_code(["\n".join(each.lines) for each in files]) != log.code:
        what = "the lists of plan {code} have been changed, or written anew for another plan"
        raise ReadingError(what, "Write the programs of that plan into a folder of their own", names, code=log.code)
    rows = ((table, row) for table in map(table_of, files) for row in table.rows)
    return {int(row.of("reading").text): raw_pose(table, row) for table, row in rows}


def _logged(
    touched: Sequence[LoggedTouch], planned: RawReading, campaign: CampaignDescription, file: Path
) -> RawReading:
    """Return the reading of all touches of a ball, where it was planned; raises ReadingError."""
    machine, number, line = campaign.machine, touched[0].reading, touched[0].line
    try:
        setup = campaign.setup(planned.setup)
        pose = np.array(placed_pose(setup, machine, in_radii(planned.position, machine.axes)))
        hits = np.tile(pose, (len(touched), 1))
        hits[:, [machine.index(axis) for axis in "XYZ"]] = [touch.at for touch in touched]
        value, *others = read_as(machine, setup, pose, list(hits), met_from(machine, pose))
    except InputError as failure:
        what = "reading {number}: {fault}"
        raise ReadingError(what, failure.remedy, file, line, number=number, fault=failure.what) from None
    moving = {machine.axes[k].name for k in setup.moves}
    sides = {name: side for name, side in planned.approach.items() if name in moving}
    return replace(planned, approach=sides, value=value, line=line, others=tuple(others), number=number, rounding={})


_OFF = 1e-4
"""m, how far from its place the tool point may be said to stand."""
_DIGIT = 1e-4
"""m or rad: a coordinate may lie outside by no more, however few digits it is written with."""
_ByAxis = Mapping[str, float]
_ROUND = 1e-9
"""rad, of an angle: rounding."""
_STILL = {False: 1e-6, True: math.radians(1e-5)}
"""How far from its park position an axis may be said to stand: 1 um, or 1e-5 deg."""


def placed_readings(
    raw: tuple[RawReading, ...], campaign: CampaignDescription, file: str | Path
) -> tuple[Reading, ...]:
    """Return readings of a file as readings of the campaign; raises ReadingError at the line that does not fit."""
    readings, faults = list[Reading](), Faults()
    for row in raw:
        try:
            readings.append(_of_length(row, campaign) if row.form == "length" else _placed(row, campaign))
        except InputError as failure:
            faults.found.append(ReadingError(failure.what, failure.remedy, file, row.line))
    faults.refuse()
    return tuple(readings)


def _of_length(row: RawReading, campaign: CampaignDescription) -> Reading:
    """Return what a length says: by how much it is longer than it should be.

    Raises ReadingError where its set-up has no two places.
    """
    setup = campaign.setup(row.setup)
    if setup.chart is None or setup.start is None:
        what = 'a length lies between two places, and "{setup}" names none'
        raise ReadingError(what, 'Give its deviation as value_um, or write instrument = "gauge"', setup=setup.name)
    long = setup.chart.coordinates[0].high
    pose, sides = tuple(setup.chart.poses(np.array([[long]]))[0].tolist()), (0,) * len(campaign.machine.axes)
    return Reading(setup.name, pose, sides, row.value - long, row.std, row.line, time=row.time)


def placed_pose(setup: Setup, machine: Machine, position: _ByAxis, rounded: _ByAxis | None = None) -> tuple[float, ...]:
    """Return the pose that a set-up and coordinates by axis (m or rad) mean; axes left out must be parked.

    Where one place is held the linear axes that are left out follow from the others.
    Raises InputError for an axis that is not there or is parked elsewhere, and for a position outside its travel. It
    does so for a place farther from the chart than what touches can follow.
    rounded : half of the last digit of each coordinate, by which it may lie outside
    """
    named, chart = {machine.index(name) for name in position}, setup.chart
    if isinstance(chart, Balls) and not chart.numbered and named >= set(chart.turning):
        places = np.array([[position[machine.axes[k].name] for k in chart.turning]])
        following = dict(zip((axis.name for axis in machine.axes), chart.poses(places)[0].tolist(), strict=True))
        position = {**following, **position}
    axes = enumerate(machine.axes)
    pose = tuple(_coordinate(setup, axis, index, position, rounded or {}) for index, axis in axes)
    if chart is None or (off := _off_chart(machine, chart, np.array(pose))) <= (setup.stroke or _OFF):
        return pose
    far = format_quantity(off, "mm", 3)
    what, ball = 'this place is {far} from the line or circle, where "{setup}" is read', ""
    if setup.artefact is not None:
        what = 'this place is {far} from ball {ball}, where "{setup}" is read'
        nearest = int(setup.artefact.nearest(machine.frames(np.array([pose])).tcp, setup.balls)[0])
        ball = setup.artefact.balls[nearest].name
    remedy = "Give the place where the tool point stood, or another set-up"
    raise ReadingError(what, remedy, far=far, ball=ball, setup=setup.name)


def placed_approach(setup: Setup, machine: Machine, approach: Mapping[str, int]) -> tuple[int, ...]:
    """Return the directions by axis as a tuple, 0 where not said; raises InputError for an axis that is parked.

    approach : {"": ±1} of the only axis that moves
    """
    if "" in approach:
        names = [machine.axes[k].name for k in setup.moves]
        if len(approach) > 1 or len(names) > 1:
            what = 'the approach names no axis, and "{setup}" moves {axes}'
            raise ReadingError(what, "Write each with its direction, as in X+", setup=setup.name, axes=joined(names))
        approach = {names[0]: approach[""]}
    for name in approach:
        if machine.index(name) not in setup.moves:
            what = '{name} is parked in the set-up "{setup}" and has no direction of approach'
            raise ReadingError(what, "Leave it out of the approach", name=name, setup=setup.name)
    return tuple(approach.get(axis.name, 0) for axis in machine.axes)


def _placed(row: RawReading, campaign: CampaignDescription) -> Reading:
    setup, sign = setup_of(row, campaign)
    named = len(setup.names) == 1 or (row.form == "stations") == bool(setup.stations)
    refuse_other_values(setup, 1 + len(row.others) if named else 0, row.dimension)
    if row.test == "circle":
        pose, directions = _on_circle(row, setup)
    else:
        only = campaign.machine.axes[setup.moves[0]].name if row.test else ""
        by_axis = ({axis or only: at for axis, at in each.items()} for each in (row.position, row.rounding))
        numbers = (in_radii(each, campaign.machine.axes) for each in by_axis)
        pose = placed_pose(setup, campaign.machine, *numbers)
        directions = placed_approach(setup, campaign.machine, row.approach)
    value, *others = sign * row.value, *row.others
    if row.form == "found":
        value, *others = off_ball(campaign.machine, setup, np.array(pose), (value, *others))
    reading = Reading(setup.name, pose, directions, value, row.std, row.line, others=tuple(others), time=row.time)
    return replace(reading, number=row.number, check=row.check)


def _on_circle(row: RawReading, setup: Setup) -> tuple[tuple[float, ...], tuple[int, ...]]:
    """Return where the axes stand at an angle of a circular test, and from which sides they come.

    Raises ReadingError where the set-up reads no circle, and for an angle that is off its arc.
    """
    chart = setup.chart
    if not isinstance(chart, Circle):
        what = '"{setup}" reads no circle'
        raise ReadingError(what, "Name the set-up of a ball bar that has a plane", setup=setup.name)
    pose = chart.poses(np.array([[row.position[""]]]))
    place, (low, high, *_) = chart.places(pose), chart.coordinates[0]
    if not low - _ROUND <= place[0, 0] <= high + _ROUND:
        low_text, high_text = (format_quantity(each, "deg", 6) for each in (low, high))
        what, remedy = "the angle lies outside the arc of the set-up", 'That of "{setup}" goes from {low} to {high}'
        raise ReadingError(what, remedy, setup=setup.name, low=low_text, high=high_text)
    sides = setup.coming(arrivals(chart, place, np.array([[float(row.approach[""])]])))
    return tuple(pose[0].tolist()), tuple(sides[0].astype(int).tolist())


def _coordinate(setup: Setup, axis: Axis, index: int, position: _ByAxis, rounding: _ByAxis) -> float:
    """Return where an axis stands; raises ReadingError for a place that it has none of, or none in this set-up."""
    moves, park = index in setup.moves, setup.park[index]
    if axis.name not in position and not moves:
        return park
    value, (low, high) = position.get(axis.name, math.nan), setup.span(axis, index)
    slack = _STILL[False] if setup.base else 1e-9 * axis.length
    slack = max(slack, min(rounding.get(axis.name, 0.0), _DIGIT))
    reach = axis.travel if setup.reach is None else setup.reach[index]
    within = reach != axis.travel and axis.travel[0] <= value <= axis.travel[1]
    limit = reach if within else axis.travel
    texts = {name: format_quantity(each, axis.unit, 9) for name, each in (("shown", value), ("park", park))}
    told = texts | {"axis": axis.name, "setup": setup.name, "travel": travel_text(replace(axis, travel=limit))}
    if axis.name not in position:
        what = '{axis} moves in the set-up "{setup}", and its position is not given'
        raise ReadingError(what, "Say where it stood, anywhere from {travel}", None, None, **told)
    if not low - slack <= value <= high + slack:
        what, remedy = "{axis} = {shown} is outside the travel", "{axis} goes from {travel}"
        if within or limit[0] <= value <= limit[1]:
            what = 'at {axis} = {shown} the {instrument} of "{setup}" does not stand within its reach and the travel'
            remedy = "{axis} goes from {travel}: give where the tool point, or the middle of a base, stood"
        raise ReadingError(what, remedy, None, None, instrument=setup.instrument, **told)
    if not moves and abs(value - park) > _STILL[axis.rotary]:
        what = '{axis} = {shown}, but the set-up "{setup}" parks it at {park}'
        raise ReadingError(what, "Park it there in the description, or add {axis} to its moves", None, None, **told)
    return min(max(value, low), high)


def _off_chart(machine: Machine, chart: Chart, pose: Array) -> float:
    """Return how far the tool point of a pose (q,) is from where the chart has it with the same coordinates, m."""
    nearest = chart.poses(chart.places(pose[None]))
    if not np.all(np.isfinite(nearest)):
        return float("inf")
    here, there = machine.frames(np.concatenate([pose[None], nearest])).tcp
    return float(np.linalg.norm(here - there))


_SAME = 1e-4
"""m, to which a probe may stand elsewhere than stated: nobody measures it better."""


def file_readings(
    raw: tuple[RawReading, ...], campaign: CampaignDescription, file: str | Path
) -> tuple[CampaignDescription, tuple[Reading, ...]]:
    """Return a campaign that says where its probe and its zero stand, and its readings as of `placed_readings`.

    Raises ReadingError at the line that does not fit.
    """
    told = raw[0]  # all readings of a file are by one probe of one printer
    try:
        if told.beside is not None:
            setup = setup_of(told, campaign)[0]
            what = 'the probe stands {said} beside the nozzle along x and y by this file, and {stated} by "{setup}"'
            if setup.offset is None:
                campaign = with_offset(campaign, setup.name, told.beside)
            else:
                _refuse_other(told.beside, setup.offset[:2], what, "Correct offset in campaign.toml", setup.name)
        if told.zero is not None:
            what = "the printer has the zero of Z at {said} by this file, and at {stated} by campaign.toml"
            if campaign.zero_at is None:
                campaign = with_zero(campaign, told.zero)
            else:
                _refuse_other(told.zero, campaign.zero_at, what, "Correct zero_at in campaign.toml")
    except InputError as failure:
        raise ReadingError(failure.what, failure.remedy, file, told.line) from None
    return campaign, placed_readings(raw, campaign, file)


def _refuse_other(
    by_file: Sequence[float], by_campaign: Sequence[float], what: str, remedy: str, name: str = ""
) -> None:
    """Raise ReadingError for a place that a file states other than campaign.toml."""
    if math.dist(by_file, by_campaign) > _SAME:
        said, stated = (" ".join(format_quantity(each, "mm", 6) for each in pair) for pair in (by_file, by_campaign))
        raise ReadingError(what, remedy, said=said, setup=name, stated=stated)
