"""When a campaign has come to its end: a target is reached, or none will be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from axiscal.accuracy.yardstick import Accuracy
from axiscal.description.target import Target
from axiscal.estimation.defence import Defence
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.ruled import GROSS, ruled, ruling_of
from axiscal.estimation.uncertain import expanded_uncertainty
from axiscal.estimation.vouching import defended, defended_by
from axiscal.units import to_unit

FUTILE = 50
OUT_OF_REACH = f"target out of reach: the last {FUTILE} readings improved it by less than 1 %"
NOT_VOUCHED = f"target promised, not vouched for: the last {FUTILE} readings improved what they can by less than 1 %"
ONLY_STATED = (
    f"target promised, not vouched for: it rests on what is stated, which {FUTILE} more readings would not mend"
)
DOES_NOT_FIT = "the readings do not fit the model: they scatter several times as much as it says"
BUDGET = "time budget used"
_REACHED = "target reached"
_HARDLY = 0.99
_LOOKED_AT = 10
"""Readings over which it is seen how fast they mend what rests on statements: of fewer a single good one decides."""


@dataclass(frozen=True, slots=True)
class Ended:
    """There is nothing more to ask, and why."""

    because: str


@dataclass(frozen=True, slots=True)
class Attained:
    """Whether an accuracy is reached, in words; where none is, which one is promised that is not vouched for.

    vouched : standard uncertainty that the readings can vouch for, m
    found : where one is promised, what they could not show
    """

    reached: str | None = None
    promised: str | None = None
    vouched: float = 0.0
    found: Defence | None = field(default=None, compare=False)


def count_reached(target: Target, count: int) -> str | None:
    """Return in words that so many readings are all that were wanted; None where they are not."""
    if target.readings is None or count < target.readings:
        return None
    return f"{count} reading{'' if count == 1 else 's'} taken"


def standing(target: Target, known: Estimation) -> Attained:
    """Return whether an accuracy is reached, by the verdict on what is known.

    Where readings could hardly have contradicted the model, its promise does not count, but what they can vouch for.
    """
    promised = _reached(target, known)
    if promised is None:
        return Attained()
    if known.misfit() > GROSS:
        return Attained(DOES_NOT_FIT)
    if _reached(target, known, unshown(target, known)) is None:
        return _promised(promised, known)
    judged = ruled(known)
    if not ruling_of(judged).promises:
        return Attained(DOES_NOT_FIT)
    said = _reached(target, judged, unshown(target, judged))
    return _promised(promised, judged) if said is None else Attained(said)


def reaches(target: Target, known: Estimation) -> bool | None:
    """Return whether an accuracy that was asked for is reached, with what no reading can see; None where none was."""
    return (standing(target, known).reached or "").endswith(_REACHED) if target.accurate else None


def _promised(said: str, known: Estimation) -> Attained:
    found = defended(known)
    return Attained(promised=said.partition(" ")[0], vouched=found.u_def, found=found)


def unshown(target: Target, known: Estimation) -> float:
    """Return how many times what is promised the readings can vouch for, 1 where the target allows more."""
    promised = known.accuracy.rms
    return 1.0 if target.unchecked or not promised > 0 else defended(known).u_def / promised


def _reached(target: Target, known: Estimation, larger: float = 1.0) -> str | None:
    """Return which accuracy is reached by what is known, where the standard uncertainty is so many times as large."""
    for each in _asked(target, known, larger):
        if each.counted <= each.allowed:
            return f"{each.name} {_REACHED}" + _unless_hidden(each.whole, each.limit)
    return None


class _Asked(NamedTuple):
    """An accuracy that is asked for: counted against what is allowed, and with what no reading sees, all in m."""

    name: str
    limit: float
    counted: float
    allowed: float
    whole: float


def _asked(target: Target, known: Estimation, larger: float) -> Iterator[_Asked]:
    now, factor = known.accuracy, 1.0
    if target.expanded is not None:
        found = expanded_uncertainty(known)
        standard = now.rms if known.ruling is None else known.ruling.standard
        factor = max(found.factor(now.rms), found.factor(standard) * larger) / larger
    wanted = (
        ("rms", target.rms, now.seen, now.rms, 1.0),
        ("worst", target.worst, now.worst_seen, now.worst, 1.0),
        ("U", target.expanded, now.seen, now.rms, factor),
    )
    for name, limit, seen, whole, k in wanted:
        if limit is not None:
            yield _Asked(name, limit, larger * seen, now.attainable(limit / k), larger * k * whole)


def out_of_reach(target: Target, known: Estimation, path: Sequence[Accuracy]) -> str | None:
    """Return in words that only an accuracy could stop the campaign and many readings have hardly brought it nearer.

    path : how well the machine was known before the first reading and after each
    Where the promise is good enough and the readings cannot vouch for it, it is what they vouch for that has to grow.
    """
    if target.readings is not None or target.budget is not None:
        return None
    if len(path) > _LOOKED_AT and _rests_for_good(target, known, path[-1 - _LOOKED_AT]):
        return ONLY_STATED
    if len(path) <= FUTILE:
        return None
    before, now = path[-1 - FUTILE], path[-1]
    if standing(target, known).promised is not None:
        vouched = defended_by(known, len(known.readings) - FUTILE, before.rms).u_def
        return NOT_VOUCHED if defended(known).u_def > _HARDLY * vouched else None
    still = now.rms > _HARDLY * before.rms and now.worst > _HARDLY * before.worst
    return OUT_OF_REACH if still else None


def _rests_for_good(target: Target, known: Estimation, before: Accuracy) -> bool:
    """Return whether what is promised rests on statements alone, and more readings would not bring it to the target.

    before : how well the machine was known some readings ago. Each reading mends no more than the one before it did.
    """
    if target.unchecked or _reached(target, known) is None:
        return False
    found = defended(known)
    larger = found.u_def / known.accuracy.rms
    missed = min((each.counted / each.allowed for each in _asked(target, known, larger)), default=0.0)
    if missed <= 1.0 or not found.only_stated:
        return False
    earlier = defended_by(known, len(known.readings) - _LOOKED_AT, before.rms).u_def / before.rms * before.seen
    mended = larger * known.accuracy.seen / earlier
    return bool(missed * mended ** (FUTILE / _LOOKED_AT) > 1.0)


def _unless_hidden(whole: float, target: float) -> str:
    """Say by how much the target is missed because of what no allowed reading can see."""
    if whole <= target:
        return ""
    return f" in what readings can tell; with what they cannot tell it is {to_unit(whole, 'um'):.3g} um"
