"""When a campaign has come to its end: a target is reached, or none will be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from axiscal.accuracy.expanded import expanded_floor
from axiscal.accuracy.yardstick import Accuracy, attainable
from axiscal.description.target import Target
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.ruled import GROSS, ruled, ruling_of
from axiscal.estimation.uncertain import expanded_uncertainty
from axiscal.units import to_unit

FUTILE = 50
OUT_OF_REACH = f"target out of reach: the last {FUTILE} readings improved it by less than 1 %"
DOES_NOT_FIT = "the readings do not fit the model: they scatter several times as much as it says"
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
    """Return in words why an accuracy asks for no more readings, by the verdict on what is known; None where it does."""
    if _said(target, known) is None:
        return None
    if known.misfit() > GROSS:
        return DOES_NOT_FIT
    judged = ruled(known)
    return _said(target, judged) if ruling_of(judged).promises else DOES_NOT_FIT


def reaches(target: Target, known: Estimation) -> bool | None:
    """Return whether an accuracy that was asked for is reached, with what no reading can see; None where none was."""
    return (standing(target, known) or "").endswith(_REACHED) if target.accurate else None


class _Asked(NamedTuple):
    """An accuracy that is asked for, what is known, and what endless readings would leave, all in m."""

    name: str
    limit: float
    whole: float
    floor: float

    @property
    def reached(self) -> bool:
        """Whether it is reached."""
        return self.whole <= self.limit

    @property
    def done(self) -> bool:
        """Whether it is reached, or no reading can reach it and they have done what was asked of them."""
        return self.whole <= attainable(self.limit, self.floor)

    @property
    def words(self) -> str:
        """What the record keeps of it."""
        if self.reached:
            return f"{self.name} {_REACHED}"
        floor, whole = (f"{to_unit(each, 'um'):.3g} um" for each in (self.floor, self.whole))
        return f"{self.name} target cannot be reached: endless readings would leave {floor}, these leave {whole}"


def _said(target: Target, known: Estimation) -> str | None:
    """Return which accuracy asks for no more readings, first one that is reached; None where all do."""
    done = sorted((each for each in _asked(target, known) if each.done), key=lambda each: not each.reached)
    return done[0].words if done else None


def _asked(target: Target, known: Estimation) -> Iterator[_Asked]:
    """Yield the accuracies that are asked for; their floors are the model's, whatever the verdict adds."""
    now, yardstick = known.accuracy, known.case.yardstick
    rms, worst = yardstick.floors
    if target.rms is not None:
        yield _Asked("rms", target.rms, now.rms, rms)
    if target.worst is not None:
        yield _Asked("worst", target.worst, now.worst, worst)
    if target.expanded is not None:
        yield _Asked("U", target.expanded, expanded_uncertainty(known).space, expanded_floor(yardstick).space)


def out_of_reach(target: Target, path: Sequence[Accuracy]) -> str | None:
    """Return in words that only an accuracy could stop the campaign and many readings have hardly brought it nearer.

    path : how well the machine was known before the first reading and after each
    """
    if target.readings is not None or target.budget is not None or len(path) <= FUTILE:
        return None
    before, now = path[-1 - FUTILE], path[-1]
    still = now.rms > _HARDLY * before.rms and now.worst > _HARDLY * before.worst
    return OUT_OF_REACH if still else None
