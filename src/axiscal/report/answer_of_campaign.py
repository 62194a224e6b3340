"""From what is known to the answer: rows, what was asked for, and what is missing.

An accuracy of which endless readings leave F is known to U and wanted to L. What readings take away falls with their
number n, so about n (U² − F²)/(L² − F²) of them reach it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from axiscal.answer.axis_line import AxisLine
from axiscal.answer.rows import AnsweredRow, answered
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import known_to
from axiscal.compensation.effect import Control
from axiscal.estimation.agreement_words import agreement_words, mistake_words
from axiscal.estimation.estimation import Estimation
from axiscal.machine.axis import Axis
from axiscal.measurement.place_texts import shown_pose
from axiscal.planning.promise import WantedAccuracy, asked
from axiscal.report.answer import Aim, AnswerLine, AnswerRow, ResultAnswer, Verdict
from axiscal.report.promises import NamedMistake, ReadingAgreement
from axiscal.units import to_unit

_TARGETS = 5
"""Readings that a line asks for of which there are none: ISO 230-2 wants five targets at least."""


def answer_of(campaign: Campaign, known: Estimation, controls: Mapping[str, Control]) -> ResultAnswer:
    """Return the answer.  controls : what the tables of each control that is offered do"""
    rows = answered(known, controls)
    wanted = asked(known.stated.description.target, known.case.yardstick)
    volume = [_accuracy(each, known_to(each.name, known)) for each in wanted]
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
    return ResultAnswer(verdict, shown, [*volume, *lines], more, minutes, to_unit(seconds, "min"), bool(times))


def agreement_of(estimation: Estimation) -> ReadingAgreement:
    """Return whether the readings agree with each other."""
    found, setups = estimation.agreement, estimation.stated.description.setups
    named = [
        NamedMistake(
            each.mistake, each.odds, [setups[index].name for index in each.setups], mistake_words(each, estimation)
        )
        for each in found.explained
    ]
    words = agreement_words(estimation) if found.count else ""
    return ReadingAgreement(found.count, found.agreeing, found.c2, found.p, found.contradicts, named, words)


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
    hopeless = not met and not any(aim.reachable for aim in volume)
    return "more" if not hopeless and all(aim.reachable for aim in lines) else "unreachable"


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


def _accuracy(wanted: WantedAccuracy, now: float) -> Aim:
    now, limit, floor = (to_unit(size, "um") for size in (now, wanted.limit, wanted.floor))
    return Aim(wanted.name, now, limit, floor, reachable=floor <= limit)


def _aim(row: AnsweredRow) -> Aim:
    now, limit, floor = (to_unit(size, _unit(row)) for size in (row.known, row.limit or 0.0, row.floor))
    unread = sum(not line.read for line in row.lines)
    return Aim(row.row.name, now, limit, floor, row.measured, row.reachable, unread, _unit(row))


def _unit(row: AnsweredRow) -> str:
    return "urad" if row.angular else "um"


def _row(row: AnsweredRow, axes: Sequence[Axis]) -> AnswerRow:
    unit = _unit(row)

    def shown(size: float) -> float:
        return to_unit(size, unit)

    return AnswerRow(
        row.row.kind,
        row.row.axes,
        row.row.name,
        unit,
        found=shown(row.found),
        largest=shown(row.largest),
        known=shown(row.known),
        before=shown(row.before),
        floor=shown(row.floor),
        left={name: shown(size) for name, size in row.left.items()},
        limit=None if row.limit is None else shown(row.limit),
        reached=row.reached,
        measured=row.measured,
        lines=list(_lines(row.lines, axes)),
        then=None if row.then is None else shown(row.then),
    )


def _lines(lines: Sequence[AxisLine], axes: Sequence[Axis]) -> Iterator[AnswerLine]:
    for line in lines:
        ends = [shown_pose(axes, tuple(pose)) for pose in line.poses[[0, -1]].tolist()]
        name = axes[line.axis].name
        at = {other: value for other, value in ends[0].items() if other != name}
        read = len(line.plus), len(line.minus), len(line.both)
        yield AnswerLine(line.setup, name, ends[0][name], ends[1][name], at, *read)
