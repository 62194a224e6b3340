"""From the campaign and the guide to the documents of the API."""

from __future__ import annotations

from datetime import datetime, timedelta
from pathlib import Path
from typing import NamedTuple

import numpy as np

from axiscal.accuracy.yardstick import Accuracy
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ended_words import because_text
from axiscal.guide.axis_places import axis_places
from axiscal.guide.due import Due, due
from axiscal.guide.expectation import BAND, Expectation
from axiscal.guide.mounting import mount_sentence, mount_steps
from axiscal.guide.picture import Dot, Picture, picture
from axiscal.guide.progress import Progress, goals_text
from axiscal.guide.question import Question
from axiscal.guide.sign import ways
from axiscal.guide.taking_back import last_step
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.place_texts import reading_unit, shown_coordinate, value_names
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.record.events import Asked
from axiscal.units import to_unit
from axiscal.web.shapes import (
    AccuracyShape,
    CoordinateShape,
    DotShape,
    DueShape,
    ExpectedShape,
    MomentShape,
    NoteShape,
    PictureShape,
    ProgressShape,
    QuestionShape,
    ReadingShape,
    StateShape,
    StepShape,
)

_LATEST = 3
"""Readings that are listed; a person looks back at no more."""


class Shown(NamedTuple):
    """What the desk knows beside the campaign: question, end, trouble, sentences to mind, verdict, course, version."""

    question: Question | None
    ended: str | None
    trouble: str
    minds: list[str]
    verdict: list[str]
    course: list[MomentShape]
    version: int


def state_shape(campaign: Campaign, shown: Shown, results: Path) -> StateShape:
    """Return all that a page shows."""
    state = campaign.state
    asked = state.pending if shown.question is not None else None
    return StateShape(
        version=shown.version,
        last=state.last,
        machine=campaign.description.machine.name,
        record=campaign.path.name,
        progress=_progress(campaign),
        question=None if asked is None or shown.question is None else _question(campaign, asked, shown.question),
        ended=None if shown.ended is None else because_text(shown.ended),
        finished=None if state.finished is None else because_text(state.finished),
        trouble=shown.trouble,
        readings=_latest(campaign),
        notes=[NoteShape(text=note.text, at=note.at, after=note.after) for note in state.notes],
        due=_due(due(campaign)),
        undo=last_step(campaign)[0],
        minds=shown.minds,
        picture=None if asked is None else _picture(picture(campaign, asked)),
        history=shown.course,
        verdict=shown.verdict,
        results=results.name if state.finished is not None and (results / "report.html").is_file() else "",
    )


def _question(campaign: Campaign, asked: Asked, question: Question) -> QuestionShape:
    """Return the question as the page shows it."""
    return QuestionShape(
        number=question.number,
        setup=question.setup.name,
        instrument=question.setup.instrument,
        mount=question.mount,
        mount_sentence=mount_sentence(question),
        mounting=[StepShape(name=name, what=what) for name, what in mount_steps(question)],
        places=[
            CoordinateShape(axis=c.axis, value=c.value, unit=c.unit, moves=c.moves, changed=c.changed, side=c.side)
            for c in axis_places(campaign, asked)
        ],
        touch=question.touch,
        again=question.again,
        ways=list(ways(question.setup)),
        turns=INSTRUMENTS[question.setup.instrument].reads == "angle",
        sign=question.sign,
        unit=question.unit,
        expected=_expected(question.expected, question.unit),
        names=list(value_names(question.setup)),
    )


def _expected(expected: Expectation, unit: str) -> list[ExpectedShape]:
    means, halves = to_unit(expected.mean, unit), to_unit(BAND * expected.std, unit)
    return [ExpectedShape(mean=float(m), half=float(h)) for m, h in zip(means, halves, strict=True)]


def _progress(campaign: Campaign) -> ProgressShape:
    now, target = Progress.of(campaign), campaign.description.target
    return ProgressShape(
        taken=now.taken,
        coming=now.coming,
        minutes=to_unit(now.seconds, "min"),
        left_minutes=to_unit(now.left, "min"),
        before=_accuracy(now.before),
        now=_accuracy(now.now),
        promised=_accuracy(now.promised),
        floor_um=to_unit(now.floor, "um"),
        goals=goals_text(target),
        target_rms_um=None if target.rms is None else to_unit(target.rms, "um"),
    )


def _accuracy(known: Accuracy) -> AccuracyShape:
    return AccuracyShape(rms_um=to_unit(known.rms, "um"), worst_um=to_unit(known.worst, "um"))


def _due(now: Due) -> DueShape:
    marker = None if now.marker is None else to_unit(now.marker, "min")
    return DueShape(temperature_degc=now.temperature, minutes_ago=now.minutes_ago, ask=now.ask, marker_minutes=marker)


def _latest(campaign: Campaign) -> list[ReadingShape]:
    """Return the last readings, the latest first."""
    doubted = {doubt.reading for doubt in campaign.known().outliers}
    readings = campaign.state.readings
    indices = range(len(readings) - 1, max(-1, len(readings) - 1 - _LATEST), -1)
    return [_reading(campaign, readings[n], n, n in doubted) for n in indices]


def _reading(campaign: Campaign, reading: Reading, index: int, doubted: bool) -> ReadingShape:
    setup = campaign.description.setup(reading.setup)
    unit = reading_unit(setup)
    return ReadingShape(
        number=reading.numbered(index),
        setup=reading.setup,
        place=_place(campaign, reading, setup),
        values=[float(each) for each in to_unit(np.array(reading.values), unit)],
        unit=unit,
        at=_moment_of(campaign, reading),
        doubted=doubted,
    )


def _place(campaign: Campaign, reading: Reading, setup: Setup) -> str:
    """Return where the axes stood that move, linear ones first, as short as it goes: "X 120.5, C 30"."""
    axes = campaign.description.machine.axes
    moved = sorted(((axes[k], reading.pose[k]) for k in setup.moves), key=lambda each: (each[0].rotary, each[0].name))
    return ", ".join(f"{axis.name} {round(shown_coordinate(at, axis), 3) + 0.0:.9g}" for axis, at in moved)


def _moment_of(campaign: Campaign, reading: Reading) -> str:
    if reading.time is None:
        return ""
    return (datetime.fromisoformat(campaign.begun) + timedelta(seconds=reading.time)).isoformat(timespec="milliseconds")


def _picture(drawn: Picture) -> PictureShape:
    unit, axis = reading_unit(drawn.setup), drawn.axis
    position_unit = "" if axis is None else axis.unit
    band = [_expected(each, unit)[0] for each in drawn.band]
    numbers = len(drawn.dots[0].values) if drawn.dots else 1
    return PictureShape(
        kind="order" if axis is None else "along",
        setup=drawn.setup.name,
        axis="" if axis is None else axis.name,
        axis_unit=position_unit,
        unit=unit,
        at=[_shown_at(each, position_unit) for each in drawn.at],
        mean=[each.mean for each in band],
        half=[each.half for each in band],
        dots=[[_dot(dot, number, unit, position_unit) for dot in drawn.dots] for number in range(numbers)],
        next=_shown_at(drawn.next, position_unit),
        names=list(value_names(drawn.setup)),
    )


def _shown_at(at: float, unit: str) -> float:
    return float(to_unit(float(at), unit)) if unit else float(at)


def _dot(dot: Dot, number: int, unit: str, position_unit: str) -> DotShape:
    expected = _expected(dot.expected, unit)[number]
    return DotShape(
        at=_shown_at(dot.at, position_unit),
        number=dot.number,
        value=float(to_unit(float(dot.values[number]), unit)),
        mean=expected.mean,
        half=expected.half,
        doubted=dot.doubted,
        same_side=dot.same_side,
    )
