"""From what is known to the answer: rows, what was asked for, and what is missing.

An accuracy of which endless readings leave F is known to U and wanted to L. What readings take away falls with their
number n, so about n (U² − F²)/(L² − F²) of them reach it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from axiscal.answer.line import Line
from axiscal.answer.rows import Answered, answered
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import known_to
from axiscal.compensation.effect import Control
from axiscal.estimation.estimation import Estimation
from axiscal.machine.axis import Axis
from axiscal.measurement.place_texts import shown_pose
from axiscal.planning.promise import asked
from axiscal.report.answer import Aim, Answer, AnswerLine, AnswerRow, Verdict
from axiscal.units import to_unit

_TARGETS = 5
"""Readings that a line asks for of which there are none: ISO 230-2 wants five targets at least."""


def answer_of(campaign: Campaign, known: Estimation, controls: Mapping[str, Control]) -> Answer:
    """Return the answer.  controls : what the tables of each control that is offered do"""
    rows = answered(known, controls)
    volume = [
        Aim(each.name, *(to_unit(size, "um") for size in (known_to(each.name, known), each.limit, each.floor)), "um")
        for each in asked(known.stated.description.target, known.case.yardstick)
    ]
    lines = [_aim(row) for row in rows if row.limit is not None and row.row.kind != "volume"]
    coming = campaign.state.plan if campaign.state.finished is None else ()
    verdict = _verdict(known, volume, lines)
    if verdict == "measured" and coming:
        verdict = "more"
    more, minutes = (0, 0.0) if verdict != "more" else _planned(campaign) if coming else _more(known, volume, lines)
    times = [reading.time for reading in campaign.state.readings if reading.time is not None]
    seconds = max(times) if times else known.seconds
    axes = known.stated.description.machine.axes
    shown = [_row(row, axes) for row in rows]
    return Answer(verdict, shown, [*volume, *lines], more, minutes, to_unit(seconds, "min"), bool(times))


def _verdict(known: Estimation, volume: Sequence[Aim], lines: Sequence[Aim]) -> Verdict:
    """Return how it stands: of several accuracies of the volume one is enough, of rows all are wanted."""
    if not known.readings:
        return "nothing"
    if known.agreement.contradicts:
        return "contradict"
    if not (volume or lines):
        return "measured"
    met = not volume or any(aim.reached for aim in volume)
    if met and all(aim.reached for aim in lines):
        return "reached"
    hopeless = not met and all(aim.floor > aim.limit for aim in volume)
    return "unreachable" if hopeless or any(aim.floor > aim.limit for aim in lines) else "more"


def _planned(campaign: Campaign) -> tuple[int, float]:
    """Return how many readings are planned yet, and their minutes."""
    coming = campaign.state.plan
    return len(coming), to_unit(campaign.seconds(coming) - campaign.seconds(), "min")


def _more(known: Estimation, volume: Sequence[Aim], lines: Sequence[Aim]) -> tuple[int, float]:
    """Return about how many readings are missing, and their minutes."""
    count = len(known.readings)
    left = [_share(aim) for aim in volume if aim.floor < aim.limit]
    shares = [min(left, default=0.0), *(_share(aim) for aim in lines if not aim.unread)]
    new = [aim.unread for aim in lines if aim.unread]
    readings = math.ceil(count * max(shares)) + _TARGETS * sum(new)
    each = float(np.median(np.diff([0.0, *known.stages.timed.ends])))
    mounting = np.mean([setup.setup_time for setup in known.stated.description.setups])
    return readings, to_unit(readings * each + float(mounting) * sum(new), "min")


def _share(aim: Aim) -> float:
    """Return by which share of the readings taken there have to be more."""
    if aim.reached:
        return 0.0
    return max((aim.now**2 - aim.floor**2) / (aim.limit**2 - aim.floor**2) - 1, 0.0)


def _aim(row: Answered) -> Aim:
    now, limit, floor = (to_unit(size, _unit(row)) for size in (row.known, row.limit or 0.0, row.floor))
    unread = sum(not line.read for line in row.lines)
    return Aim(row.row.name, now, limit, floor, _unit(row), row.measured, unread)


def _unit(row: Answered) -> str:
    return "urad" if row.angular else "um"


def _row(row: Answered, axes: Sequence[Axis]) -> AnswerRow:
    unit = _unit(row)
    sizes = (row.found, row.largest, row.known, row.before, row.floor)
    found, largest, known, before, floor = (to_unit(size, unit) for size in sizes)
    limit, then = (None if size is None else to_unit(size, unit) for size in (row.limit, row.then))
    left = {name: to_unit(size, unit) for name, size in row.left.items()}
    about = row.row.kind, row.row.axes, row.row.name, unit
    lines = list(_lines(row.lines, axes))
    figures = found, largest, known, before, floor, left, limit
    return AnswerRow(*about, *figures, row.reached, row.measured, lines, then)


def _lines(lines: Sequence[Line], axes: Sequence[Axis]) -> Iterator[AnswerLine]:
    for line in lines:
        ends = [shown_pose(axes, tuple(pose)) for pose in line.poses[[0, -1]].tolist()]
        name = axes[line.axis].name
        at = {other: value for other, value in ends[0].items() if other != name}
        read = len(line.plus), len(line.minus), len(line.both)
        yield AnswerLine(line.setup, name, ends[0][name], ends[1][name], at, *read)
