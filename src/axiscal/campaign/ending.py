"""When a campaign has come to its end: a target is reached, or none will be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from axiscal.accuracy.expanded import expanded
from axiscal.accuracy.yardstick import Accuracy, attainable
from axiscal.answer.known import known_rows
from axiscal.description.target import Target
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.uncertain import expanded_uncertainty
from axiscal.planning.promise import FEW, WantedAccuracy, asked
from axiscal.units import to_unit

FUTILE = 50
OUT_OF_REACH = f"target out of reach: the last {FUTILE} readings improved it by less than 1 %"
CONTRADICT = "the readings contradict each other, and no single mistake explains it"
BUDGET = "time budget used"
_REACHED = "target reached"
ALL_REACHED = f"every {_REACHED}"
_BEYOND = "cannot be reached with these set-ups"
_HARDLY = 0.99


@dataclass(frozen=True, slots=True)
class Ended:
    """There is nothing more to ask, and why."""

    because: str


class _Standing(NamedTuple):
    """An accuracy of the volume that is asked for, and how well it is known, m."""

    wanted: WantedAccuracy
    now: float


def count_reached(target: Target, count: int) -> str | None:
    """Return in words that so many readings are all that were wanted; None where they are not."""
    if target.readings is None or count < target.readings:
        return None
    return f"{count} reading{'' if count == 1 else 's'} taken"


def standing(target: Target, known: Estimation) -> str | None:
    """Return in words why limits ask for no more readings; None where they do."""
    found = _said(target, known)
    return CONTRADICT if found is not None and known.agreement.withheld else found


def reaches(target: Target, known: Estimation) -> bool | None:
    """Return whether limits that are given are reached, with what no reading can see; None where none is."""
    return (standing(target, known) or "").endswith(_REACHED) if target.accurate else None


def _said(target: Target, known: Estimation) -> str | None:
    """Return that one accuracy of the volume and all other rows are reached, or that no reading can; None for neither.

    The floors of the volume are those of the sizes as stated.
    """
    volume = [_Standing(each, known_to(each.name, known)) for each in asked(target, known.case.yardstick)]
    first = next((each for each in volume if each.now <= each.wanted.limit), None)
    spent = [each for each in volume if each.now <= attainable(each.wanted.limit, each.wanted.floor)]
    if volume and not spent:
        return None
    if not known.readings:
        return None
    if not target.lines and first is not None:
        return None if _unread(target, known) else f"{first.wanted.name} {_REACHED}"
    rows = [row for row in known_rows(*known.banded, known.readings) if row.row.kind != "volume"]
    missing = [row for row in rows if row.reached is False]
    if not missing and (first is not None or not volume):
        return ALL_REACHED
    if not all(row.settled for row in rows):
        return None
    if first is not None or not volume:
        return f"{', '.join(row.row.name for row in missing)} {_BEYOND}"
    floor, left = (f"{to_unit(size, 'um'):.3g} um" for size in (spent[0].wanted.floor, spent[0].now))
    name = spent[0].wanted.name
    return f"{name} target cannot be reached: endless readings would leave {floor}, these leave {left}"


def _unread(target: Target, known: Estimation) -> bool:
    """Return whether sizes as stated meet an accuracy unread, and fewer readings than check them were taken."""
    if len(known.readings) >= FEW or not len(known.stated.sizes):
        return False
    yardstick, prior = known.stated.yardstick, known.stated.prior
    rms, worst, *_ = yardstick.measure(prior)
    pairs = (target.rms, rms), (target.worst, worst), (target.expanded, expanded(yardstick, prior).space)
    return any(limit is not None and before <= limit for limit, before in pairs)


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
