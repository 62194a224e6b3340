"""A campaign that a command changes, and its questions in the words and units of the workshop."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Ended, because_text
from axiscal.cli.printing import tell
from axiscal.exceptions import AxiscalError
from axiscal.language.spoken import counted, ending, said
from axiscal.measurement.reading import asked_values, reading_unit, sense
from axiscal.present.guide.question import axis_places, question_text, sign_on, touch_text
from axiscal.present.plan_answer import reach_answer
from axiscal.present.plan_words import reach_text
from axiscal.record.events import Asked


def asked_screen(campaign: Campaign, asked: Asked) -> str:
    """Return what the operator is to do."""
    setup, machine = campaign.description.setup(asked.place.setup), campaign.description.machine
    values = asked_values(setup) if any(setup.names) else f"VALUE {reading_unit(setup)}"
    head = said(
        'Reading {number}: set-up "{setup}", {instrument}, reads {reads}',
        number=asked.reading,
        setup=setup.name,
        instrument=said(setup.title),
        reads=sense(setup).reads,
    )
    then = said("then"), f'axiscal step record {campaign.path} "{values}"'
    where = axis_places(campaign, asked), touch_text(campaign, asked), sign_on(machine, setup)
    return f"{head}\n{question_text(*where, then)}"


def question_of(campaign: Campaign, asked: Asked | Ended) -> tuple[dict[str, object], str]:
    """Return the question, or why there is none and what to do, as the document `axiscal-next/1` and in words."""
    if isinstance(asked, Asked):
        return {"question": campaign.request(asked).message(), "stop": None}, asked_screen(campaign, asked)
    ended = said("Nothing more to ask: {because}.", because=because_text(asked.because))
    record = shlex.quote(str(campaign.path))
    more = f"axiscal step next {record} --beyond    # {said('one reading more')}"
    coming = ending({said("Next"): [f"axiscal finish {record} --out results", more]})
    return {"question": None, "stop": asked.because}, "\n".join([ended, *coming])


def tell_out_of_reach(campaign: Campaign) -> None:
    """Say on stderr before the first reading if the target cannot be reached with the set-ups."""
    reach = None if campaign.state.readings else reach_answer(campaign.estimate(ended=True).case)
    if reach is not None:
        tell(reach_text(reach))


@contextmanager
def opened_to_write(record: Path, going_on: str = "step next") -> Iterator[Campaign]:
    """Yield the campaign; raises as `stoppable`.  going_on : the command that goes on with it"""
    with Campaign.open(record) as campaign, stoppable(campaign, f"axiscal {going_on} {record}"):
        yield campaign


@contextmanager
def stoppable(campaign: Campaign, again: str) -> Iterator[None]:
    """Raise AxiscalError after Ctrl-C, which says what is kept.  again : the command that goes on"""
    try:
        yield
    except KeyboardInterrupt:
        raise AxiscalError(said("Stopped by Ctrl-C. {kept}", kept=kept_text(campaign, again))) from None


def kept_text(campaign: Campaign, again: str) -> str:
    """Return how many readings the record has now, and the command that goes on."""
    one, many = "{count} reading is kept in {record}", "{count} readings are kept in {record}"
    kept = counted(one, many, len(campaign.looked_at_again().readings), record=campaign.path)
    return said("{kept}; go on with: {again}", kept=kept, again=again)
