"""Places, questions and accuracies in the words and units of the workshop, and a campaign that a command changes.

After Ctrl-C the error says what was kept and what to call next.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Ended, because_text
from axiscal.description.target import Target
from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.exceptions import AxiscalError, InputError
from axiscal.language.spoken import ending, put, said
from axiscal.measurement.reading import asked_values, reading_unit, sense
from axiscal.present.guide.question import ACTIONS, axis_places, question_text, sign_on, touch_text
from axiscal.record.events import Asked, State
from axiscal.units import said_quantity


def asked_screen(campaign: Campaign, asked: Asked) -> str:
    """Return what the operator is to do."""
    setup = campaign.description.setup(asked.place.setup)
    values = asked_values(setup) if any(setup.names) else f"VALUE {reading_unit(setup)}"
    then = said("then"), f'axiscal step record {campaign.path} "{values}"'
    head = said(
        'Reading {number}: set-up "{setup}", {instrument}, reads {reads}',
        number=asked.reading,
        setup=setup.name,
        instrument=said(setup.title),
        reads=sense(setup).reads,
    )
    where = question_text(
        axis_places(campaign, asked), touch_text(campaign, asked), sign_on(campaign.description.machine, setup), then
    )
    return f"{head}\n{where}"


def next_text(campaign: Campaign, asked: Asked | Ended) -> str:
    """Return the question, or why there is none and what to do."""
    if isinstance(asked, Ended):
        ended = said("Nothing more to ask: {because}.", because=because_text(asked.because))
        record = shlex.quote(str(campaign.path))
        more = f"axiscal step next {record} --beyond    # {said('one reading more')}"
        return "\n".join([ended, *ending({said("Next"): [f"axiscal finish {record} --out results", more]})])
    return asked_screen(campaign, asked)


def question_document(campaign: Campaign, asked: Asked | Ended) -> dict[str, object]:
    """Return the question, or why there is none, as the document `axiscal-next/1`."""
    if isinstance(asked, Ended):
        return {"schema": "axiscal-next/1", "question": None, "stop": asked.because}
    return {"schema": "axiscal-next/1", "question": campaign.request(asked).message(), "stop": None}


def accuracy_text(known: Accuracy, aimed: Target) -> str:
    """Return the standard uncertainty with what is aimed at, where that is anything."""
    figures = (said_quantity(known.rms, "um"), aimed.rms), (said_quantity(known.worst, "um"), aimed.worst)
    found, largest = (
        text if target is None else said("{figure} (target {target})", figure=text, target=said_quantity(target, "um"))
        for text, target in figures
    )
    return said("RMS {rms}, worst {worst}", rms=found, worst=largest)


@contextmanager
def opened_to_write(record: Path, going_on: str = "next") -> Iterator[Campaign]:
    """Yield the campaign; raises AxiscalError in the place of KeyboardInterrupt.

    going_on : the command that goes on with it
    """
    try:
        with Campaign.open(record) as campaign:
            before = campaign.state
            try:
                yield campaign
            except KeyboardInterrupt:
                raise AxiscalError(
                    said("Stopped by Ctrl-C. {kept}", kept=_kept(before, campaign.looked_at_again(), record, going_on))
                ) from None
    except KeyboardInterrupt:
        raise AxiscalError(said("Stopped by Ctrl-C. {kept}", kept=_nothing(record))) from None


@contextmanager
def saying_what_is_kept(kept: Callable[[], str]) -> Iterator[None]:
    """Say behind each failure of a block, and after Ctrl-C, what is kept and how to go on: `kept` says it."""
    try:
        yield
    except InputError as failure:
        remedy = put("{remedy}. {kept}", remedy=failure.remedy, kept=kept())
        raise type(failure)(failure.what, remedy, failure.file, failure.line) from failure
    except KeyboardInterrupt:
        raise AxiscalError(said("Stopped by Ctrl-C. {kept}", kept=kept())) from None


def _kept(before: State, now: State, record: Path, going_on: str) -> str:
    """Return what has happened since, in words, and what to call next."""
    if now.last == before.last:
        return _nothing(record)
    what = "No reading was added; go on with: axiscal {going_on} {record}"
    if now.finished is not None and before.finished is None:
        what = "The end was kept; write the results: axiscal finish {record}"
    elif len(now.readings) > len(before.readings):
        what = "Reading {number} was kept; go on with: axiscal {going_on} {record}"
    elif len(now.skipped) > len(before.skipped):
        what = "The skip was kept; go on with: axiscal {going_on} {record}"
    elif len(now.undo) < len(before.undo):
        what = "What was to be taken back is taken back; go on with: axiscal {going_on} {record}"
    number = now.readings[-1].number if now.readings else None
    return said(what, number=number, going_on=going_on, record=record)


def _nothing(record: Path) -> str:
    return said("Nothing was added to {record}; give the command again.", record=record)


def help_text() -> str:
    """Return what can be typed at the prompt, in the language that is spoken."""
    undo, skip, note, leave, stop, pause, _, anew, *_ = (said(word) for word in ACTIONS)
    because, text = said("REASON"), said("TEXT")
    rows = (
        ("-1.7", said("keep a reading, in the unit that is shown; a decimal comma does as well")),
        ("0.0021 mm", said("keep a reading in another unit")),
        (said("found X Y Z"), said("where the axes stood with the ball found, in mm")),
        ("Enter", said("show the question again")),
        (undo, said("take back the last reading or skip")),
        (f"{skip} {because}", said("the reading cannot be taken")),
        (f"{leave} {because}", said("nothing more can be read with this set-up; the plan is made anew without it")),
        (f"{note} {text}", said("keep a sentence in the record, or how warm the scale is: {note} 21.4 °C", note=note)),
        (anew, said("the zero was set anew, bumped or mounted again: another one from this reading on")),
        (stop, said("end the campaign here: what would be left, and what the tables would reach, is said first")),
        (pause, said("stop for now; axiscal measure goes on here")),
    )
    return "\n".join(f"  {typed:<18} {does}" for typed, does in rows)
