"""From the campaign and the guide to the documents of the API."""

from __future__ import annotations

from datetime import datetime, timedelta
from pathlib import Path
from typing import NamedTuple

import numpy as np

from axiscal.answers.answer import PlannedAnswer, ResultAnswer
from axiscal.answers.answer_words import answer_text
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import because_text
from axiscal.estimation.agreement_words import agreement_words
from axiscal.measurement.place import Place
from axiscal.measurement.place_texts import reading_unit, shown_coordinate
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.present.guide.progress import Progress, due
from axiscal.present.guide.question import Question
from axiscal.present.guide.taking_back import last_step
from axiscal.present.machine_drawing.setup_picture import setup_picture, setup_scene
from axiscal.present.plan_words import plan_text
from axiscal.present.sentences import spelt
from axiscal.units import to_unit
from axiscal.web.shapes import (
    AnswerShape,
    NoteShape,
    ReadingShape,
    StateShape,
)

_LATEST = 3
"""Readings that are listed; a person looks back at no more."""


class Shown(NamedTuple):
    """What the desk knows beside the campaign: question, end, trouble, sentences to mind, answer, version."""

    question: Question | None
    ended: str | None
    trouble: str
    minds: list[str]
    answer: ResultAnswer | PlannedAnswer | None
    version: int


def state_shape(campaign: Campaign, shown: Shown, results: Path) -> StateShape:
    """Return all that a page shows."""
    state = campaign.state
    return StateShape(
        version=shown.version,
        last=state.last,
        machine=campaign.description.machine.name,
        record=campaign.path.name,
        progress=Progress.of(campaign),
        question=shown.question,
        ended=None if shown.ended is None else spelt(because_text(shown.ended)),
        finished=None if state.finished is None else spelt(because_text(state.finished)),
        trouble=shown.trouble,
        readings=_latest(campaign),
        notes=[NoteShape(text=note.text, at=note.at, after=note.after) for note in state.notes],
        due=due(campaign),
        undo=last_step(campaign)[0],
        minds=[spelt(each) for each in shown.minds],
        answer=None if shown.answer is None else _answer(campaign, shown.answer, results),
        results=results.name if state.finished is not None and (results / "report.html").is_file() else "",
    )


def _answer(campaign: Campaign, answer: ResultAnswer | PlannedAnswer, results: Path) -> AnswerShape:
    """Return what is known, in the words of every report; before the first reading, in those of the plan."""
    if isinstance(answer, PlannedAnswer):
        text = plan_text(answer, campaign.path.name)
    else:
        contradict = agreement_words(campaign.so_far()) if answer.verdict == "contradict" else ""
        text = answer_text(answer, contradict, campaign.path.name, results.name)
    return AnswerShape(
        first=[spelt(part) for part in text.first.parts],
        rows=[[spelt(cell) for cell in row] for row in text.rows],
        sentences=[spelt(sentence) for sentence in text.sentences],
        commands=text.commands,
        document=answer,
    )


def _latest(campaign: Campaign) -> list[ReadingShape]:
    """Return the last readings, the latest first."""
    doubted = {doubt.reading for doubt in campaign.estimate().outliers}
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


def picture_of_setup(campaign: Campaign, width: float) -> str:
    """Return the set-up of the next reading, on the machine as it then stands, as SVG; "" for none."""
    asked = campaign.state.pending
    if asked is None:
        return ""
    description = campaign.description
    taken = [Place(each.setup, each.pose, each.approach) for each in campaign.state.readings]
    scene = setup_scene(description, description.setup(asked.place.setup), taken, asked.place, campaign.state.coming)
    return setup_picture(scene, width)
