"""How far a campaign is: readings and minutes done and to come, and how well the machine is known.

Beside it stands what is due beside the readings: the temperature, and the place that shows whether a zero has wandered.
"""

from __future__ import annotations

import re
from datetime import UTC, datetime

from axiscal.answers.answer import AnswerDocument
from axiscal.campaign.campaign import Campaign
from axiscal.description.target import Target
from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.language.spoken import counted, said
from axiscal.planning.promise import promised, reachable_rms
from axiscal.units import said_quantity, to_unit


class KnownTo(AnswerDocument):
    """RMS and worst standard uncertainty."""

    rms_um: float
    worst_um: float

    @classmethod
    def of(cls, accuracy: Accuracy) -> KnownTo:
        """Return it of an accuracy."""
        return cls(rms_um=to_unit(accuracy.rms, "um"), worst_um=to_unit(accuracy.worst, "um"))


class Progress(AnswerDocument):
    """How far the campaign is.

    taken, coming : readings; coming holds the one that is asked for
    minutes, left_minutes : used, by the clock where that was kept, and machine time to come by the plan
    before, now, promised : how well the machine was known at first, is known, and will be after the plan
    floor_um : RMS that endless readings would leave; goals : what ends the campaign
    """

    taken: int
    coming: int
    minutes: float
    left_minutes: float
    before: KnownTo
    now: KnownTo
    promised: KnownTo
    floor_um: float
    goals: str

    @classmethod
    def of(cls, campaign: Campaign) -> Progress:
        """Return the progress of the campaign by its present plan."""
        known, places = campaign.estimate(), campaign.state.coming
        case, machine = campaign.case(), campaign.seconds()
        return cls(
            taken=len(campaign.state.readings),
            coming=len(places),
            minutes=to_unit(machine if campaign.state.clocked is None else campaign.state.clocked, "min"),
            left_minutes=to_unit(campaign.seconds(places) - machine, "min"),
            before=KnownTo.of(case.yardstick.measure(case.prior)),
            now=KnownTo.of(known.accuracy),
            promised=KnownTo.of(promised(known.case, known.printed, places) if places else known.accuracy),
            floor_um=to_unit(reachable_rms(case), "um"),
            goals=goals_text(campaign.description.target),
        )


def goals_text(target: Target) -> str:
    """Return what ends the campaign, the first of them that is reached: "U 10 um · RMS 2 um · 40 readings · 90 min"."""
    lengths = (("U", target.expanded), ("RMS", target.rms), (said("worst"), target.worst))
    goals = [f"{name} {said_quantity(length, 'um', 3)}" for name, length in lengths if length is not None]
    goals += [counted("{count} row", "{count} rows", len(target.lines))] if target.lines else []
    goals += [] if target.readings is None else [counted("{count} reading", "{count} readings", target.readings)]
    goals += [] if target.budget is None else [said_quantity(target.budget, "min", 3)]
    return " · ".join(goals)


_DEGREES = re.compile(r"(-?[0-9]+(?:[.,][0-9]+)?)\s*(?:°\s*C|degC)\b")
_EVERY = 30.0
"""Minutes after which the temperature is asked for again: a workshop moves by tenths of a kelvin in that time."""


class Due(AnswerDocument):
    """What is due beside the readings: the last temperature noted, how long ago, whether to note it now.

    marker_minutes : machine time until a place is read again that shows a drift, None where none is planned
    """

    temperature_degc: float | None
    minutes_ago: float
    ask: bool
    marker_minutes: float | None


def due(campaign: Campaign) -> Due:
    """Return what is due now."""
    warm, ago = _temperature(campaign)
    asked = warm is None or ago >= _EVERY
    return Due(temperature_degc=warm, minutes_ago=ago, ask=asked, marker_minutes=_marker(campaign))


def _temperature(campaign: Campaign) -> tuple[float | None, float]:
    for note in reversed(campaign.state.notes):
        if (found := _DEGREES.search(note.text)) is not None:
            ago = (datetime.now(UTC) - datetime.fromisoformat(note.at)).total_seconds() / 60
            return float(found[1].replace(",", ".")), max(ago, 0.0)
    return None, 0.0


def _marker(campaign: Campaign) -> float | None:
    places, read = campaign.state.coming, {reading.place for reading in campaign.state.readings}
    first = next((n for n, place in enumerate(places) if place in read), None)
    return None if first is None else to_unit(campaign.seconds(places[:first]) - campaign.seconds(), "min")
