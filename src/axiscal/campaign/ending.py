"""When a campaign has come to its end: a target is reached, or none will be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.accuracy.yardstick import Accuracy, attainable
from axiscal.description.target import Target
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.uncertain import expanded_uncertainty
from axiscal.planning.promise import asked
from axiscal.units import to_unit

FUTILE = 50
OUT_OF_REACH = f"target out of reach: the last {FUTILE} readings improved it by less than 1 %"
CONTRADICT = "the readings contradict each other, and no single mistake explains it"
BUDGET = "time budget used"
_REACHED = "target reached"
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


def standing(target: Target, known: Estimation) -> str | None:
    """Return in words why an accuracy asks for no more readings; None where it does."""
    found = _said(target, known)
    return CONTRADICT if found is not None and known.agreement.withheld else found


def reaches(target: Target, known: Estimation) -> bool | None:
    """Return whether an accuracy that was asked for is reached, with what no reading can see; None where none was."""
    return (standing(target, known) or "").endswith(_REACHED) if target.accurate else None


def _said(target: Target, known: Estimation) -> str | None:
    """Return which accuracy asks for no more readings, one that is reached first; None where all do.

    The floors are those of the sizes as stated.
    """
    done = [(each, known_to(each.name, known)) for each in asked(target, known.case.yardstick)]
    done = [(each, now) for each, now in done if now <= attainable(each.limit, each.floor)]
    for each, now in done:
        if now <= each.limit:
            return f"{each.name} {_REACHED}"
    for each, now in done:
        floor, left = (f"{to_unit(size, 'um'):.3g} um" for size in (each.floor, now))
        return f"{each.name} target cannot be reached: endless readings would leave {floor}, these leave {left}"
    return None


def known_to(name: str, known: Estimation) -> float:
    """Return how well the machine is known by the figure of that name, m."""
    if name == "U":
        return expanded_uncertainty(known).space
    return known.accuracy.rms if name == "rms" else known.accuracy.worst


def out_of_reach(target: Target, path: Sequence[Accuracy]) -> str | None:
    """Return in words that only an accuracy could stop the campaign and many readings have hardly brought it nearer.

    path : how well the machine was known before the first reading and after each
    """
    if target.readings is not None or target.budget is not None or len(path) <= FUTILE:
        return None
    before, now = path[-1 - FUTILE], path[-1]
    still = now.rms > _HARDLY * before.rms and now.worst > _HARDLY * before.worst
    return OUT_OF_REACH if still else None
