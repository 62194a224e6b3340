"""Slips at a display: the test of sign, unit and scale with which a mounting begins, and the causes of a surprise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal, Self

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.evidence import OVERRULED, TESTED
from axiscal.campaign.sources import virtual_machine
from axiscal.campaign.sources.source import SimulatedSource
from axiscal.exceptions import AxiscalError, ReadingError
from axiscal.language.spoken import WORDS, decimals, put, said
from axiscal.measurement.reading import reading_unit, units_of
from axiscal.measurement.setup import Setup
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.present.answer import AnswerDocument
from axiscal.present.guide.actions import Short, zero_before
from axiscal.present.guide.question import SURPRISING, Question, measured, typed
from axiscal.present.sentences import spelt
from axiscal.units import digits, to_unit

_STEP = 1e-4
"""m: far beyond backlash and the resolution of a dial, and no dial has less range."""
_ALONG = 0.9
"""Of the step that an instrument has to look along: askew a sign shows, but no scale."""
_ABOUT = 1.6
"""Of what it should show, up or down: backlash of a home-made machine takes as much; units are farther apart."""
_PER_UM = {"mm": 1e-3, "in": 1e-3 / 25.4, "thou": 1 / 25.4}
"""What a display shows for a micrometre in other units."""
_STILL = 0.01
"""Of what it should show: a display that moves by less stands still, in whatever unit."""
_FINEST = 0.2
"""Of the noise of one reading: where no jog has shown the unit, a value below it is likelier one in mm."""

Cause = Literal["sign", "mm", "inch", "anew", "bumped", "really", "keep"]
CAUSES: dict[Cause, str] = WORDS["slips"]
"""What may be behind a surprise, in words."""
_FACTORS: dict[Cause, float] = {"sign": -1.0, "mm": 1000.0, "inch": 25400.0}
"""By definition: what a value is multiplied by, mm or inches for um."""


class Jog(AnswerDocument):
    """The test of a mounting: what to do in words, and what the display shows after it in the unit of readings.

    far : which axis how far, such as "Z +0.100 mm"
    """

    far: str
    sentence: str
    shows: float
    unit: str


def display_text(values: Sequence[float], setup: Setup) -> str:
    """Return what a display shows of a reading, each number in its unit.  values : m or rad"""
    shown = (to_unit(each, unit) for each, unit in zip(values, units_of(setup), strict=True))
    return " ".join(decimals(f"{each:.2f}") for each in shown)


class SurprisingError(ReadingError):
    """A reading that is asked about before it is kept.  causes : what may be behind it"""

    def __init__(self, what: str, causes: Sequence[Cause]) -> None:
        self.causes = causes
        super().__init__(what, said("Read again, or say what it was"))


class Meant(AnswerDocument):
    """What a typed text means: its values in the unit of the question, and what there is to say of it.

    causes : what may be behind a surprise, in words
    """

    values: Sequence[float] = ()
    surprising: bool = False
    sentence: str = ""
    causes: Mapping[Cause, str] = {}

    @classmethod
    def of_text(cls, campaign: Campaign, question: Question | None, text: str) -> Self:
        """Return what a text would mean for a question, nothing where there is none."""
        if question is None or not text.strip():
            return cls()
        try:
            values = typed(campaign, text)
        except AxiscalError as failure:
            return cls(sentence=str(failure))
        shown = [float(to_unit(float(each), question.unit)) for each in values]
        try:
            refuse_surprising(campaign, question, values)
        except SurprisingError as strange:
            words = {cause: said(CAUSES[cause]) for cause in strange.causes}
            return cls(values=shown, surprising=True, sentence=spelt(str(strange)), causes=words)
        return cls(values=shown)


def refuse_surprising(campaign: Campaign, question: Question, values: Array) -> None:
    """Raise SurprisingError for a reading far from what is expected.  values : (k,) m or rad"""
    if question.surprise(values) >= SURPRISING:
        raise SurprisingError(surprise_text(question, values), causes(question, values))
    setup = campaign.description.setup(question.setup)
    tiny = question.unit == "um" and 0 < np.max(np.abs(values)) < _FINEST * setup.noise
    if tiny and not setup.display and question.surprise(_FACTORS["mm"] * values) < SURPRISING:
        raise SurprisingError(said("It is less than the instrument can tell"), causes(question, values))


def shown_on(campaign: Campaign, virtual: str) -> str:
    """Return what the instrument on a virtual machine shows at the reading that is asked for, "" where there is none.

    virtual : the source of the machine, "" of a real one
    """
    asked, description = campaign.state.pending, campaign.description
    if not virtual or asked is None:
        return ""
    if (test := jog(campaign)) is not None:
        return decimals(f"{test.shows:.2f}")
    simulator = Simulator(description.machine, description.setups)
    answer = SimulatedSource(*virtual_machine(virtual, simulator)).read(campaign.request(asked))
    return display_text([answer.value, *answer.others], description.setup(asked.place.setup))


def surprise_text(question: Question, values: Array) -> str:
    """Return how far the most surprising number is from what was expected.  values : (k,) m or rad"""
    means, halves = np.array([(each.mean, each.half) for each in question.expected]).T
    away = np.abs(to_unit(values, question.unit) - means)
    most = int(np.argmax(away / halves))
    what = "It is about {away} {unit} away from what is expected, ± {half}"
    return said(what, away=digits(float(away[most])), unit=question.units[most], half=digits(float(halves[most])))


def causes(question: Question, values: Array) -> list[Cause]:
    """Return what may be behind a surprise; another sign or unit only where the value is none with it."""
    away = {cause: question.surprise(factor * values) for cause, factor in _FACTORS.items()}
    return [cause for cause in CAUSES if away.get(cause, 0.0) < SURPRISING]


def keep(campaign: Campaign, text: Short, cause: Cause | None = None) -> str:
    """Keep a reading of what is asked; raises SurprisingError where nobody has said the cause of a strange one.

    text : as it is typed, "-1,7", "0.0021 mm", three numbers in one line; by default in the unit of the question
    cause : puts it right.  Raises ReadingError for one that does not explain it
    """
    question, values = Question.from_campaign(campaign, campaign.open_question()), typed(campaign, text)
    if cause is None:
        refuse_surprising(campaign, question, values)
    elif cause not in causes(question, values):
        raise ReadingError(said("It would be a surprise all the same"), said("Read again, or name another cause"))
    factor = 1.0 if cause is None else _FACTORS.get(cause, 1.0)
    value, *others = (factor * float(each) for each in values)
    kept = campaign.record(value, accepted=cause == "really", others=tuple(others))
    told = zero_before(campaign, question.setup, kept.number) if cause in ("anew", "bumped") else ""
    if cause in (*_FACTORS, "bumped"):
        told = told or said("It is put right, and that is noted.")
        campaign.note(put("reading {number}: {cause}", number=kept.number or 0, cause=said(CAUSES[cause])))
    return f"{said('Kept reading {number}; it is on the disk.', number=kept.number)} {told}".rstrip()


def jog(campaign: Campaign) -> Jog | None:
    """Return the test that the set-up asked for begins with; None where it needs none, or has passed it."""
    found = _jog(campaign)
    return None if found is None or _passed(campaign) else found


def _jog(campaign: Campaign) -> Jog | None:
    """Return the test of a set-up that is mounted now; None for a display that no axis alone moves."""
    asked, readings, machine = campaign.state.pending, campaign.state.readings, campaign.description.machine
    if asked is None or (readings and readings[-1].setup == asked.place.setup):
        return None
    setup, pose = campaign.description.setup(asked.place.setup), np.array(asked.place.pose)
    if not setup.display or setup.base is not None:
        return None
    ways = (1.0 if x + _STEP <= axis.travel[1] else -1.0 for axis, x in zip(machine.axes, pose, strict=True))
    steps = np.array([0.0 if axis.rotary else _STEP * way for axis, way in zip(machine.axes, ways, strict=True)])
    moved = machine.frames(pose + np.diag(steps)).tcp - machine.frames(pose[None]).tcp
    shows = moved @ np.array(setup.direction)
    axis = int(np.argmax(np.abs(shows)))
    if abs(shows[axis]) < _ALONG * _STEP:
        return None
    millimetres = to_unit(float(steps[axis]), "mm")
    far = put("{axis} {step:+.3f} mm", axis=machine.axes[axis].name, step=millimetres)
    if machine.axes[axis].diameters:
        far = said("{place} (the diameter {twice} mm)", place=far, twice=put("{step:+.3f}", step=2 * millimetres))
    words = said("Jog {far}; type by how much the display changes", far=far)
    unit = reading_unit(setup)
    return Jog(far=far, sentence=words, shows=float(to_unit(float(shows[axis]), unit)), unit=unit)


def _passed(campaign: Campaign) -> bool:
    asked, readings = campaign.state.pending, campaign.state.readings
    last = readings[-1].numbered(len(readings) - 1) if readings else 0
    found = [TESTED.fullmatch(note.text) for note in campaign.state.notes if note.after == last]
    passed = [each[1] for each in found if each is not None and each[2] in ("right", OVERRULED)]
    return asked is not None and asked.place.setup in passed


def try_jog(campaign: Campaign, text: Short, *, anyway: bool = False) -> str:
    """Keep what the display shows after the test in the record as a note, and return a sentence of it.

    anyway : go on although it is not as it should be
    Raises ReadingError for what shows a wrong sign, another unit or scale.
    """
    test, asked = _jog(campaign), campaign.state.pending
    if test is None or asked is None:
        raise ReadingError(said("There is nothing to test"), said("Go on with the readings"))
    setup = campaign.description.setup(asked.place.setup)
    ratio = float(to_unit(measured(text, setup)[0], test.unit)) / test.shows
    wrong = _wrong(ratio)
    verdict = OVERRULED if anyway and wrong else wrong[0] if wrong else "right"
    campaign.note(f'test of sign "{setup.name}": {test.far} shows {text.strip()} ({verdict})')
    if wrong and not anyway:
        raise ReadingError(wrong[1], wrong[2])
    return said("The display follows the tool.")


def _wrong(ratio: float) -> tuple[str, str, str] | None:
    """Return what is wrong with a display: in the record, in words, and what to do; None for nothing.

    ratio : of what it shows to what it should
    """
    size = abs(ratio)
    unit = next((unit for unit, per in _PER_UM.items() if per / _ABOUT <= size <= per * _ABOUT), None)
    kind = (
        "unit" if unit else "still" if size < _STILL else "scale" if not 1 / _ABOUT <= size <= _ABOUT else "wrong sign"
    )
    if kind == "wrong sign" and ratio > 0:
        return None
    words, named = WORDS["display"][kind], said("thousandths of an inch") if unit == "thou" else unit
    values = {"unit": named, "times": digits(size), "example": "0.012 mm" if unit == "mm" else "0.0005 in"}
    return f"in {unit}" if unit else kind, said(words["what"], **values), said(words["remedy"], **values)
