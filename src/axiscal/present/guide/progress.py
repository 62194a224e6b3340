"""How far a campaign is: readings and minutes done and to come, and how well the machine is known.

Beside it stands what is due beside the readings: the temperature.
"""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from shlex import quote
from typing import Literal

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.listing import Standing
from axiscal.description.stated_type_b import lacks_temperature
from axiscal.description.target import Target
from axiscal.estimation.accuracy.expanded import floor_of, known_to
from axiscal.language.spoken import counted, said
from axiscal.measurement.reading import reading_units, shown_coordinate, units_of
from axiscal.planning.promise import foreseen
from axiscal.present.answer import AnswerDocument
from axiscal.units import said_quantity, to_unit


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


class RecordStanding(AnswerDocument):
    """Where the campaign of a record stands, as the record says it by itself: for `status FOLDER` and page.

    record : its path in the folder; last : time of the last event, ISO 8601, UTC; readings, coming : taken, planned
    finished : why it ended; rms_um, U_um, agreement : as it was known then; next : the command that goes on with it
    """

    record: str
    machine: str
    last: str
    readings: int
    coming: int
    finished: str | None
    rms_um: float | None
    U_um: float | None
    agreement: str | None
    next: str | None

    @classmethod
    def of(cls, standing: Standing, folder: Path) -> RecordStanding:
        """Return it of a record in a folder."""
        state, result, path = standing.state, standing.state.result, quote(str(standing.file))
        rms, expanded = (None if size is None else to_unit(size, "um") for size in (result.rms, result.expanded))
        then = f"axiscal step undo {path}" if result.agreement == "contradict" else None
        if state.finished is None:
            then = f"axiscal {'measure' if state.coming or not state.readings else 'finish'} {path}"
        return cls(
            record=str(standing.file.relative_to(folder)),
            machine=standing.machine,
            last=standing.at,
            readings=len(state.readings),
            coming=len(state.coming),
            finished=state.finished,
            rms_um=rms,
            U_um=expanded,
            agreement=result.agreement or None,
            next=then,
        )


_EVERY = 30.0
"""Minutes after which the temperature is asked for again: a workshop moves by tenths of a kelvin in that time."""


class Due(AnswerDocument):
    """What is due beside the readings: the last temperature that was said of the scale, and whether to say it now.

    ask : nobody has said one, or half an hour ago
    """

    temperature_degc: float | None
    minutes_ago: float
    ask: bool


def open_temperature(campaign: Campaign) -> bool:
    """Return whether it counts how warm the scale is that the set-up asked for reads, and nobody has said it."""
    asked, described = campaign.state.pending, campaign.description
    return asked is not None and lacks_temperature(described.setup(asked.place.setup))


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
