"""What the person at the machine may do, a function each, which keeps it in the record and returns a sentence of it.

Prompt, page and commands call these. Beside them stands what is to be minded of the last reading: which readings are
no longer believed since, what it contradicts, and what it makes likely.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from pydantic import Field

from axiscal.campaign.agreement_words import acceptance, agreement_words, change_words, question
from axiscal.campaign.basis import rejected
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Ended, because_text
from axiscal.campaign.possible import LONGEST_TEXT
from axiscal.estimation.judged import Doubt
from axiscal.estimation.promise.mistake import Explained, Mistake
from axiscal.exceptions import RecordError
from axiscal.language.spoken import counted, decimals, later, listed, said
from axiscal.measurement.reading import reading_text, reading_unit
from axiscal.present.guide.question import asked_text
from axiscal.record.accepted import Accepted
from axiscal.record.events import Recorded, Skipped, Warmed
from axiscal.units import format_quantity

Short = Annotated[str, Field(max_length=LONGEST_TEXT)]
"""What a person types."""


def undo(campaign: Campaign) -> str:
    """Take back the last reading, skip, accepted mistake, temperature or end; raises RecordError for none."""
    what, _ = last_step(campaign)
    campaign.undo()
    kept = counted("{count} reading is kept", "{count} readings are kept", len(campaign.state.readings))
    return said("Took back {what}; {kept}.", what=what, kept=kept)


def last_step(campaign: Campaign) -> tuple[str, int | None]:
    """Return what would be taken back, "" where there is nothing, and the number of its reading."""
    state = campaign.state
    match state.undo[-1].event if state.undo else None:
        case None:
            return "", None
        case Recorded():
            return _last_text(campaign, len(state.readings) - 1), state.readings[-1].number
        case Skipped():
            asked = state.skipped[-1].asked
            return said("the skip of {reading}", reading=asked_text(campaign, asked)), asked.reading
        case Accepted() as event:
            return said("what was accepted: {change}", change=change_words(event)), None
        case Warmed() as event:
            return said('the temperature of "{setup}", {text}', setup=event.setup, text=event.text), None
    return said("the end"), None


def skip(campaign: Campaign, reason: Short, *, rest: bool = False) -> str:
    """Keep in mind that the reading asked for cannot be taken; rest : nor any other of its set-up."""
    skipped = campaign.skip(reason, rest=rest)
    if rest:
        left = 'Left "{setup}": the plan is made anew without it; undo goes back to it.'
        return said(left, setup=skipped.place.setup)
    return said("Skipped {reading}; the plan is made anew around it.", reading=asked_text(campaign, skipped))


def note(campaign: Campaign, text: Short) -> str:
    """Keep a sentence or a temperature in the record."""
    campaign.note(text)
    warm = campaign.state.notes[-1].warmed
    if warm is None:
        return said("Noted; it is on the disk.")
    what = 'The readings of "{setup}" are brought from {text} to 20 degC; undo takes it back.'
    return said(what, setup=warm.setup, text=warm.text)


def set_anew(campaign: Campaign) -> str:
    """Keep that a zero was set anew before the next reading."""
    return zero_before(campaign, None, campaign.state.free)


def zero_before(campaign: Campaign, setup: str | None, number: int | None) -> str:
    """Keep that a zero was set anew before the reading of a number."""
    told = campaign.accept("jump", setup, number)
    what = 'Kept: "{setup}" has another zero from reading {number} on; undo takes it back.'
    return said(what, setup=told.setups[0], number=told.reading)


def accept(campaign: Campaign) -> str:
    """Put right the mistake that readings name; raises RecordError where they name none."""
    named = explained(campaign)
    if named is None:
        raise RecordError(said("The readings name no mistake"), said("Go on with the readings"))
    told = campaign.accept(named.mistake, campaign.description.setups[named.setups[0]].name)
    return said("Put right: {change}; undo takes it back.", change=change_words(told))


def go_on(campaign: Campaign) -> str:
    """Ask for one more reading although a target is reached."""
    asked = campaign.next(beyond=True)
    if isinstance(asked, Ended):
        return said("Nothing more to ask: {because}.", because=because_text(asked.because))
    return said("One more.")


def explained(campaign: Campaign) -> Explained | None:
    """Return the likeliest mistake that readings name which contradict each other, None for none."""
    found = campaign.estimate().agreement
    return found.explained[0] if found.contradicts and found.explained else None


_SURPRISING = 3.0
"""Standard deviations below which a reading that is believed again is not worth a sentence."""


def doubted(campaign: Campaign) -> frozenset[int]:
    """Return the indices of the readings that are doubted now: where a plan's question is open, those it names."""
    state = campaign.state
    if state.pending is not None and not state.renew:
        return rejected(state.plan_basis)
    return campaign.estimate().left_out


def last_doubt(campaign: Campaign) -> Doubt | None:
    """Return why the last reading is not used, None where it is."""
    last = len(campaign.state.readings) - 1
    return next((doubt for doubt in campaign.estimate().outliers if doubt.reading == last), None)


def others_doubted(campaign: Campaign, before: frozenset[int], *, command: bool = True) -> list[str]:
    """Return sentences about what the last reading changed: earlier readings doubted or believed, and its own surprise.

    before : what was doubted before it; command : whether the option is said that keeps it all the same
    """
    last, now, known = len(campaign.state.readings) - 1, doubted(campaign), campaign.estimate()
    doubtful = "with this one, {reading}, is no longer relied on. Read there again."
    minds = [said(doubtful, reading=_shown(campaign, index)) for index in sorted(now - before - {last})]
    minds += [said("with this one, {reading}, is believed.", reading=_shown(campaign, index)) for index in before - now]
    doubt = last_doubt(campaign)
    if doubt is not None:
        refused = "{why}. It is not used: take it back and read there again. If it is right, record it with --accept."
        kept = "{why}. It is not used: take it back and read there again. If it is right, keep it as really so."
        minds.append(said(refused if command else kept, why=known.objection_to(doubt)))
    elif not campaign.state.readings[last].accepted and (size := known.history.surprise(last)) >= _SURPRISING:
        strange = (
            "it is {size} standard deviations from what was expected. It is believed so far; take it back and read "
            "there again if anything may have been wrong."
        )
        minds.append(said(strange, size=decimals(f"{size:.1f}")))
    return minds


def contradictions(campaign: Campaign, *, command: bool = True) -> list[str]:
    """Return what is to be said of readings that contradict each other; nothing where they agree, or at the end.

    command : whether the one that puts it right is said besides
    """
    if campaign.state.finished is not None:
        return []
    known = campaign.estimate()
    return [agreement_words(known, campaign.path if command else None)] if known.agreement.contradicts else []


_ASKED = later("jump"), "stuck", "still"
"""Mistakes that a person is asked about at once, and besides whether it is backlash where that explains it as well."""


class Named(NamedTuple):
    """What a person is asked about at once: a mistake, of which set-up, from which reading on.

    answers : one, which is yes, or two of which one is right
    """

    mistake: Mistake
    setup: str
    number: int
    question: str
    answers: tuple[str, ...]


def named_now(campaign: Campaign) -> Named | None:
    """Return the likeliest zero that was set anew, or instrument that is stuck, which the readings name now."""
    known = campaign.estimate()
    for each in known.agreement.explained:
        if each.mistake in _ASKED:
            event, answers = acceptance(each, known), (each.mistake, *((later("backlash"),) if each.backlash else ()))
            return Named(each.mistake, event.setups[0], event.reading, question(known, each), answers)
    return None


def confirmed(campaign: Campaign, named: Named, answer: str) -> str:
    """Keep the answer to what is asked."""
    if answer == "jump":
        return zero_before(campaign, named.setup, named.number)
    change = change_words(campaign.accept(answer, named.setup))
    return said("Kept: {change}; undo takes it back.", change=change)


def open_question(campaign: Campaign) -> str:
    """Return what is asked about readings that agree, with the command that answers it; "" for nothing."""
    named = None if campaign.estimate().agreement.contradicts else named_now(campaign)
    if named is None:
        return ""
    what, causes = "{question} Answer: axiscal step accept {record} {causes}", listed(said(" or "), [*named.answers])
    return said(what, question=named.question, record=campaign.path, causes=causes)


def _last_text(campaign: Campaign, index: int) -> str:
    reading, description = campaign.state.readings[index], campaign.description
    return reading_text(description.machine.axes, description.setup(reading.setup), reading, index)


def _shown(campaign: Campaign, index: int) -> str:
    reading = campaign.state.readings[index]
    unit = reading_unit(campaign.description.setup(reading.setup))
    return f"{_last_text(campaign, index)}, {format_quantity(reading.value, unit)}"
