"""Places, questions and accuracies in the words and units of the workshop."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from axiscal.answers.answer_words import ending, um_text
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Ended, because_text
from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.language.spoken import counted, said
from axiscal.measurement.reading import reading_unit, value_names
from axiscal.present.guide.question import axis_places, coming_text, coordinates_text, reads_text, touch_text
from axiscal.record.events import Asked
from axiscal.units import to_unit


def micrometres(length: float) -> str:
    """Return a length in um with three significant digits.  length : m"""
    return um_text(to_unit(length, "um"))


def question_text(campaign: Campaign, asked: Asked) -> str:
    """Return what the operator is to do."""
    setup = campaign.description.setup(asked.place.setup)
    values = ", ".join(f"{name.upper() or 'VALUE'} {reading_unit(setup)}" for name in value_names(setup))
    places, touch = axis_places(campaign, asked), touch_text(campaign, asked)
    coming, parked = coming_text(places), coordinates_text(places, moves=False)
    lines = [
        (said("go to"), coordinates_text(places, moves=True)),
        (said("coming"), coming),
        (said("at") if setup.artefact else said("the way"), touch),
        (said("parked"), parked),
        (said("then"), f'axiscal step record {campaign.path} "{values}"'),
    ]
    head = said(
        'Reading {number}: set-up "{setup}", {instrument}, reads {reads}',
        number=asked.reading,
        setup=setup.name,
        instrument=said(setup.instrument),
        reads=reads_text(setup),
    )
    return "\n".join([head, *(f"  {name:<9} {what}" for name, what in lines if what)])


def next_text(campaign: Campaign, asked: Asked | Ended) -> str:
    """Return the question, or why there is none and what to do."""
    if isinstance(asked, Ended):
        ended = said("Nothing more to ask: {because}.", because=because_text(asked.because))
        return "\n".join([ended, *ending({said("Next"): [f"axiscal finish {campaign.path} --out results"]})])
    return question_text(campaign, asked)


def ask_next(record: Path) -> str:
    """Return how to ask for the next reading."""
    return said("Ask for the next one: axiscal step next {record}", record=record)


def question_document(campaign: Campaign, asked: Asked | Ended) -> dict[str, object]:
    """Return the question, or why there is none, as the document `axiscal-next/1`."""
    if isinstance(asked, Ended):
        return {"schema": "axiscal-next/1", "question": None, "stop": asked.because}
    return {"schema": "axiscal-next/1", "question": campaign.request(asked).message(), "stop": None}


def accuracy_text(known: Accuracy, rms: float | None, worst: float | None) -> str:
    """Return the standard uncertainty with the targets, where there are any."""
    figures = (micrometres(known.rms), rms), (micrometres(known.worst), worst)
    found, largest = (
        text if target is None else said("{figure} (target {target})", figure=text, target=micrometres(target))
        for text, target in figures
    )
    return said("RMS {rms}, worst {worst}", rms=found, worst=largest)


Noun = Literal["reading", "event", "record", "machine", "case", "pair", "way"]


def count_text(count: int, noun: Noun) -> str:
    """Return "1 reading", "3 readings"."""
    return {
        "reading": counted("{count} reading", "{count} readings", count),
        "event": counted("{count} event", "{count} events", count),
        "record": counted("{count} record", "{count} records", count),
        "machine": counted("{count} machine", "{count} machines", count),
        "case": counted("{count} case", "{count} cases", count),
        "pair": counted("{count} pair", "{count} pairs", count),
        "way": counted("{count} way", "{count} ways", count),
    }[noun]


def signed_text(campaign: Campaign) -> str:
    """Return who answers for how much of the record, in words."""
    found, last = campaign.signed(), campaign.state.last
    if found is None:
        return said("unsigned")
    signer = found.by
    by = said("{person} on {computer}, key {key}", person=signer.person, computer=signer.computer, key=signer.key[:16])
    if not found.holds:
        return said("not as it was signed at event {number} by {by}", number=found.number, by=by)
    signed = said("signed at event {number} by {by}", number=found.number, by=by)
    if found.number == last:
        return signed
    return said("{signed}; unsigned since: {events}", signed=signed, events=count_text(last - found.number, "event"))
