"""How far a campaign is: readings and minutes done and to come, and how well the machine is known.

Beside it stands what is due beside the readings: the temperature.

Words say what `undo` would take back or has taken back, and which readings are no longer believed since the last.
"""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from typing import Literal, NamedTuple

from axiscal.campaign.agreement_words import acceptance, agreement_words, change_words, question
from axiscal.campaign.basis import rejected
from axiscal.campaign.campaign import Campaign
from axiscal.description.stated_type_b import lacks_temperature
from axiscal.description.target import Target
from axiscal.estimation.accuracy.expanded import floor_of, known_to
from axiscal.estimation.judged import Doubt
from axiscal.estimation.promise.mistake import Mistake
from axiscal.language.spoken import counted, decimals, listed, said
from axiscal.measurement.reading import reading_text, reading_unit, reading_units, shown_coordinate, units_of
from axiscal.planning.promise import foreseen
from axiscal.present.answer import AnswerDocument
from axiscal.present.guide.question import asked_text
from axiscal.record.accepted import Accepted
from axiscal.record.events import Recorded, Skipped, Warmed
from axiscal.units import format_quantity, said_quantity, to_unit


def take_back(campaign: Campaign) -> tuple[dict[str, object], str]:
    """Take back the last reading, skip, accepted mistake, temperature or finish; raises RecordError for none.

    Returns the kind of its event, the number of its reading and how many readings are kept, and a sentence of it.
    """
    what, number = last_step(campaign)
    undone, left = type(campaign.undo().event).__name__.lower(), len(campaign.state.readings)
    kept = counted("{count} reading is kept", "{count} readings are kept", left)
    sentence = said("Took back {what}; {kept}.", what=what, kept=kept)
    return {"undone": undone, "reading": number, "readings": left}, sentence


def last_step(campaign: Campaign) -> tuple[str, int | None]:
    """Return what would be taken back, "" where there is nothing, and the number of its reading."""
    state, description = campaign.state, campaign.description
    if not state.undo:
        return "", None
    event = state.undo[-1].event
    if isinstance(event, Recorded):
        index, reading = len(state.readings) - 1, state.readings[-1]
        setup = description.setup(reading.setup)
        return reading_text(description.machine.axes, setup, reading, index), reading.number
    if isinstance(event, Skipped):
        asked = state.skipped[-1].asked
        return said("the skip of {reading}", reading=asked_text(campaign, asked)), asked.reading
    if isinstance(event, Accepted):
        return said("what was accepted: {change}", change=change_words(event)), None
    if isinstance(event, Warmed):
        return said('the temperature of "{setup}", {text}', setup=event.setup, text=event.text), None
    return said("the end"), None


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


Answer = Literal["jump", "backlash", "stuck", "still"]
_ANSWERS: dict[Mistake, tuple[Answer, ...]] = {"jump": ("jump",), "stuck": ("stuck",), "still": ("still",)}
"""What a person may say of a mistake, and besides that it is backlash where that explains it as well."""


class Named(NamedTuple):
    """What a person is asked about at once: a mistake, of which set-up, from which reading on.

    answers : one, which is yes, or two of which one is right
    """

    mistake: Mistake
    setup: str
    number: int
    question: str
    answers: tuple[Answer, ...]

    @property
    def typed(self) -> dict[str, Answer]:
        """What a person types for each of several answers."""
        return {said("jump").lower(): "jump", said("backlash").lower(): "backlash"}


def named_now(campaign: Campaign) -> Named | None:
    """Return the likeliest zero that was set anew, or instrument that is stuck, which the readings name now."""
    known = campaign.estimate()
    for each in known.agreement.explained:
        if (answers := _ANSWERS.get(each.mistake)) is not None:
            event, answers = acceptance(each, known), (*answers, "backlash") if each.backlash else answers
            return Named(each.mistake, event.setups[0], event.reading, question(known, each), answers)
    return None


def confirmed(campaign: Campaign, named: Named, answer: Answer) -> str:
    """Keep the answer to what is asked, and return a sentence of it."""
    if answer == "jump":
        return set_anew(campaign, named.setup, named.number)
    change = change_words(campaign.accept(answer, named.setup))
    return said("Kept: {change}; undo takes it back.", change=change)


def open_question(campaign: Campaign) -> str:
    """Return what is asked about readings that agree, with the command that answers it; "" for nothing."""
    named = None if campaign.estimate().agreement.contradicts else named_now(campaign)
    if named is None:
        return ""
    what, causes = "{question} Answer: axiscal step accept {record} {causes}", listed(said(" or "), [*named.answers])
    return said(what, question=named.question, record=campaign.path, causes=causes)


def set_anew(campaign: Campaign, setup: str | None = None, before: int | None = None) -> str:
    """Keep that a zero was set anew, by default before the next reading, and return a sentence of it."""
    told = campaign.accept("jump", setup, campaign.state.free if before is None else before)
    what = 'Kept: "{setup}" has another zero from reading {number} on; undo takes it back.'
    return said(what, setup=told.setups[0], number=told.reading)


def take_note(campaign: Campaign, text: str) -> str:
    """Keep a sentence or a temperature in the record, and return a sentence of it."""
    campaign.note(text)
    warm = campaign.state.notes[-1].warmed
    if warm is None:
        return said("Noted; it is on the disk.")
    what = 'The readings of "{setup}" are brought from {text} to 20 degC; undo takes it back.'
    return said(what, setup=warm.setup, text=warm.text)


def open_temperature(campaign: Campaign) -> bool:
    """Return whether it counts how warm the scale is that the set-up asked for reads, and nobody has said it."""
    asked, described = campaign.state.pending, campaign.description
    return asked is not None and lacks_temperature(described.setup(asked.place.setup))


def contradictions(campaign: Campaign, *, command: bool = True) -> list[str]:
    """Return what is to be said of readings that contradict each other; nothing where they agree, or at the end.

    command : whether the one that puts it right is said besides
    """
    if campaign.state.finished is not None:
        return []
    known = campaign.estimate()
    return [agreement_words(known, campaign.path if command else None)] if known.agreement.contradicts else []


def _shown(campaign: Campaign, index: int) -> str:
    reading, description = campaign.state.readings[index], campaign.description
    setup = description.setup(reading.setup)
    value = format_quantity(reading.value, reading_unit(setup))
    return f"{reading_text(description.machine.axes, setup, reading, index)}, {value}"


class Progress(AnswerDocument):
    """How far the campaign is.

    taken, coming : readings; coming holds the one that is asked for
    minutes, left_minutes : used, by the clock where that was kept, and machine time to come by the plan
    figure : of the volume, as the target names it: "U", "RMS" or "worst"
    before_um, now_um, promised_um, floor_um : at first, now, after the plan, and after endless readings
    goals : what ends the campaign
    """

    taken: int
    coming: int
    minutes: float
    left_minutes: float
    figure: Literal["U", "RMS", "worst"]
    before_um: float
    now_um: float
    promised_um: float
    floor_um: float
    goals: str

    @classmethod
    def of(cls, campaign: Campaign) -> Progress:
        """Return the progress of the campaign by its present plan."""
        known, places = campaign.estimate(), campaign.state.coming
        case, machine, target = campaign.case(), campaign.seconds(), campaign.description.target
        after = foreseen(known.case, known.readings, places) if places else known.printed
        figure: Literal["U", "RMS", "worst"] = "U"
        if target.expanded is None and (target.rms or target.worst) is not None:
            figure = "worst" if target.rms is None else "RMS"
        return cls(
            taken=len(campaign.state.readings),
            coming=len(places),
            minutes=to_unit(machine if campaign.state.clocked is None else campaign.state.clocked, "min"),
            left_minutes=to_unit(campaign.seconds(places) - machine, "min"),
            figure=figure,
            before_um=to_unit(known_to(figure, case.yardstick, case.prior), "um"),
            now_um=to_unit(known_to(figure, known.case.yardstick, known.printed.belief), "um"),
            promised_um=to_unit(known_to(figure, known.case.yardstick, after.belief), "um"),
            floor_um=to_unit(floor_of(figure, known.case.yardstick_as_sized), "um"),
            goals=goals_text(target),
        )


def goals_text(target: Target) -> str:
    """Return what ends the campaign, the first of them that is reached: "U 10 um · RMS 2 um · 40 readings · 90 min"."""
    lengths = (("U", target.expanded), ("RMS", target.rms), (said("worst"), target.worst))
    goals = [f"{name} {said_quantity(length, 'um', 3)}" for name, length in lengths if length is not None]
    goals += [counted("{count} row", "{count} rows", len(target.lines))] if target.lines else []
    goals += [] if target.readings is None else [counted("{count} reading", "{count} readings", target.readings)]
    goals += [] if target.budget is None else [said_quantity(target.budget, "min", 3)]
    return " · ".join(goals)


_EVERY = 30.0
"""Minutes after which the temperature is asked for again: a workshop moves by tenths of a kelvin in that time."""


class Due(AnswerDocument):
    """What is due beside the readings: the last temperature that was said of the scale, and whether to say it now.

    ask : nobody has said one, or half an hour ago
    """

    temperature_degc: float | None
    minutes_ago: float
    ask: bool


def due(campaign: Campaign) -> Due:
    """Return what is due now."""
    setup = campaign.state.pending.place.setup if campaign.state.pending else ""
    told = [(note.at, note.warmed) for note in campaign.state.notes if note.warmed and note.warmed.setup == setup]
    at, last = told[-1] if told else ("", None)
    since = (datetime.now(UTC) - datetime.fromisoformat(at)).total_seconds() / 60 if at else 0.0
    ago, warm = max(since, 0.0), None if last is None else round(to_unit(last.temperature, "degC"), 3)
    asked = open_temperature(campaign) or ago >= _EVERY
    return Due(temperature_degc=warm, minutes_ago=ago, ask=asked)


_LATEST = 3
"""Readings that are listed; a person looks back at no more."""


class KeptReading(AnswerDocument):
    """A reading that is kept: where, what, when (ISO 8601, UTC; "" where nobody knows), whether it is doubted."""

    number: int
    setup: str
    place: str
    values: list[float]
    unit: str
    at: str
    doubted: bool


def latest(campaign: Campaign) -> Iterator[KeptReading]:
    """Yield the last readings, the latest first, each where its axes stood that move: "X 120.5, C 30"."""
    doubted = {doubt.reading for doubt in campaign.estimate().outliers}
    begun, axes = datetime.fromisoformat(campaign.begun), campaign.description.machine.axes
    for index, reading in list(enumerate(campaign.state.readings))[: -_LATEST - 1 : -1]:
        setup, seconds = campaign.description.setup(reading.setup), reading.time
        units, moved = units_of(setup), [(axes[k], reading.pose[k]) for k in setup.moves]
        moved.sort(key=lambda each: (each[0].rotary, each[0].name))
        stood = (f"{axis.name} {round(shown_coordinate(at, axis), 3) + 0.0:.9g}" for axis, at in moved)
        yield KeptReading(
            number=reading.numbered(index),
            setup=reading.setup,
            place=", ".join(stood),
            values=[to_unit(value, unit) for value, unit in zip(reading.values, units, strict=True)],
            unit=reading_units(setup),
            at="" if seconds is None else (begun + timedelta(seconds=seconds)).isoformat(timespec="milliseconds"),
            doubted=index in doubted,
        )
