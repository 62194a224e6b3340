"""A set-up that is left before its readings are taken: what is dropped, and what that costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.campaign.campaign import Campaign
from axiscal.cli.texts import count_text
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.planning.promise import promised
from axiscal.units import format_quantity

_COSTS = 1.01
"""By less than a percent of the RMS a set-up that is left costs nothing worth a sentence."""


@dataclass(frozen=True, slots=True)
class Stand:
    """What was to come before a reading that nobody asked for.

    setup : the one that is mounted; planned : the readings to come; rms : that they promised, m
    """

    setup: str
    planned: tuple[Place, ...]
    rms: float

    @classmethod
    def of(cls, campaign: Campaign) -> Stand | None:
        """Return where the campaign stands; None where nothing is planned, or no set-up is mounted."""
        state = campaign.state
        planned = tuple(state.plan)
        mounted = state.readings[-1].setup if state.readings else None
        setup = state.pending.place.setup if state.pending is not None else mounted
        if setup is None or not planned:
            return None
        return cls(setup, planned, _promise(campaign, planned))

    def left_for(self, campaign: Campaign, reading: Reading) -> str:
        """Return what leaving the set-up for this reading drops and costs, "" where it costs nothing."""
        coming = _in(self.planned, self.setup)
        if reading.setup == self.setup or not coming:
            return ""
        plan = campaign.prepared() if campaign.reached() is None else ()
        dropped, rms = coming - _in(plan, self.setup), _promise(campaign, plan)
        if dropped <= 0 and rms <= _COSTS * self.rms:
            return ""
        were, now = (format_quantity(value, "um", 3) for value in (self.rms, rms))
        return (
            f'this leaves "{self.setup}", where {count_text(coming, "planned reading")} were still to come. '
            f"{count_text(max(dropped, 0), 'reading')} there are dropped now, since mounting it again costs its time: "
            f"the plan ends at {now} RMS, and would have ended at {were}. To stay, take this back: axiscal undo."
        )


def _in(places: Sequence[Place], setup: str) -> int:
    return sum(place.setup == setup for place in places)


def _promise(campaign: Campaign, places: Sequence[Place]) -> float:
    known = campaign.estimate(ended=True)
    return promised(known.case, known.knowledge, places).rms
