"""When a campaign has come to its end: a target is reached, or none will be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.accuracy.yardstick import Accuracy
from axiscal.description.target import Target
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.ruled import ruled, ruling_of
from axiscal.estimation.uncertain import expanded_uncertainty
from axiscal.units import to_unit

FUTILE = 50
OUT_OF_REACH = f"target out of reach: the last {FUTILE} readings improved it by less than 1 %"
DOES_NOT_FIT = "the readings do not fit the model: they scatter several times as much as it says"
BUDGET = "time budget used"
_HARDLY = 0.99


@dataclass(frozen=True, slots=True)
class Ended:
    """There is nothing more to ask, and why."""

    because: str


def count_reached(target: Target, count: int) -> str | None:
    """Return in words that so many readings are all that were wanted; None where they are not."""
    if target.readings is None or count < target.readings:
        return None
    return f"{count} reading{'' if count == 1 else 's'} taken"


def accuracy_reached(target: Target, known: Estimation) -> str | None:
    """Return in words which accuracy is reached, by the verdict on what is known; None where none is."""
    if _reached(target, known) is None:
        return None
    judged = ruled(known)
    return _reached(target, judged) if ruling_of(judged).promises else DOES_NOT_FIT


def _reached(target: Target, known: Estimation) -> str | None:
    """Return which accuracy is reached by what is known."""
    now = known.accuracy
    factor = 1.0 if target.expanded is None else expanded_uncertainty(known).factor(now.rms)
    wanted = (
        ("rms", target.rms, now.seen, now.rms, 1.0),
        ("worst", target.worst, now.worst_seen, now.worst, 1.0),
        ("U", target.expanded, now.seen, now.rms, factor),
    )
    for name, limit, seen, whole, k in wanted:
        if limit is not None and seen <= now.attainable(limit / k):
            return f"{name} target reached" + _unless_hidden(k * whole, limit)
    return None


def futile(target: Target, path: Sequence[Accuracy]) -> bool:
    """Whether only an accuracy could stop the campaign, and many readings have hardly improved it.

    path : how well the machine was known before the first reading and after each
    """
    if len(path) <= FUTILE or target.readings is not None or target.budget is not None:
        return False
    before, now = path[-1 - FUTILE], path[-1]
    return now.rms > _HARDLY * before.rms and now.worst > _HARDLY * before.worst


def _unless_hidden(whole: float, target: float) -> str:
    """Say by how much the target is missed because of what no allowed reading can see."""
    if whole <= target:
        return ""
    return f" in what readings can tell; with what they cannot tell it is {to_unit(whole, 'um'):.3g} um"
