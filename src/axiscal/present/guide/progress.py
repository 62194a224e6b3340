"""How far a campaign is: readings and minutes done and to come, and how well the machine is known."""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.campaign.campaign import Campaign
from axiscal.description.target import Target
from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.language.spoken import counted, said
from axiscal.planning.promise import promised, reachable_rms
from axiscal.units import said_quantity


@dataclass(frozen=True, slots=True)
class Progress:
    """Where a campaign stands.

    taken, coming : readings; coming holds the one that is asked for
    seconds, left : used, by the clock where that was kept, and machine time to come by the plan
    before, now, promised : how well the machine was known at first, is known, and will be after the plan
    floor : RMS that endless readings would leave, m
    """

    taken: int
    coming: int
    seconds: float
    left: float
    before: Accuracy
    now: Accuracy
    promised: Accuracy
    floor: float

    @classmethod
    def of(cls, campaign: Campaign) -> Progress:
        """Return the progress of the campaign by its present plan."""
        known, places = campaign.estimate(), campaign.state.coming
        case, machine = campaign.case(), campaign.seconds()
        return cls(
            taken=len(campaign.state.readings),
            coming=len(places),
            seconds=machine if campaign.state.clocked is None else campaign.state.clocked,
            left=campaign.seconds(places) - machine,
            before=case.yardstick.measure(case.prior),
            now=known.accuracy,
            promised=promised(*known.banded, places) if places else known.accuracy,
            floor=reachable_rms(case),
        )


def goals_text(target: Target) -> str:
    """Return what ends the campaign, the first of them that is reached: "U 10 um · RMS 2 um · 40 readings · 90 min"."""
    lengths = (("U", target.expanded), ("RMS", target.rms), (said("worst"), target.worst))
    goals = [f"{name} {said_quantity(length, 'um', 3)}" for name, length in lengths if length is not None]
    goals += [counted("{count} row", "{count} rows", len(target.lines))] if target.lines else []
    goals += [] if target.readings is None else [counted("{count} reading", "{count} readings", target.readings)]
    goals += [] if target.budget is None else [said_quantity(target.budget, "min", 3)]
    return " · ".join(goals)
