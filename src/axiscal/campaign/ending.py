"""When a campaign has come to its end: a target is reached, or none will be, or its source is given up."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

from axiscal.campaign.sources import Skip
from axiscal.description.target import Target
from axiscal.estimation.accuracy.expanded import WantedAccuracy, asked, known_to
from axiscal.estimation.accuracy.yardstick import Accuracy, attainable
from axiscal.estimation.estimation import Estimation, expanded_uncertainty
from axiscal.estimation.known_rows import known_rows
from axiscal.exceptions import SourceError
from axiscal.language.spoken import WORDS, counted, later, said
from axiscal.measurement.reading import Reading
from axiscal.planning.promise import FEW
from axiscal.record.events import KeptResult
from axiscal.units import format_quantity


class Milestone(NamedTuple):
    """The last of so many readings taken (None: before the first), how well the machine was known, and the seconds."""

    taken: int
    reading: Reading | None
    accuracy: Accuracy
    seconds: float

    @property
    def number(self) -> int:
        """The number of the reading, 0 before the first."""
        return 0 if self.reading is None else self.reading.numbered(self.taken - 1)


FUTILE = 50
OUT_OF_REACH = f"target out of reach: the last {FUTILE} readings improved it by less than 1 %"
CONTRADICT = "the readings contradict each other, and no single mistake explains it"
BUDGET = "time budget used"
_REACHED = "target reached"
ALL_REACHED = f"every {_REACHED}"
_BEYOND = "cannot be reached with these set-ups"
_HARDLY = 0.99
_CLEARLY = 1.1
"""Times its limit is a floor as stated that ends a campaign: sizes that are learnt move it by about a tenth."""
_PASSING = {"drift", "cycle", "growth", "way", "noise"}
"""Kinds of sizes that endless readings take away, however large."""


class Ended(NamedTuple):
    """There is nothing more to ask, and why."""

    because: str


_Standing = tuple[WantedAccuracy, float]
"""The wanted accuracy of the volume, and the accuracy so far, m."""


def standing(target: Target, known: Estimation) -> str | None:
    """Return in words why limits ask for no more readings; None where they do."""
    found = _said(target, known)
    return CONTRADICT if found is not None and known.agreement.withheld else found


def reaches(target: Target, known: Estimation) -> bool | None:
    """Return whether limits that are given are reached, with what no reading can see; None where none is."""
    return (standing(target, known) or "").endswith(_REACHED) if target.accurate else None


def _said(target: Target, known: Estimation) -> str | None:
    """Return that the volume and all other rows are reached, or that no reading can; None for neither."""
    belief, yardstick = known.printed.belief, known.case.yardstick
    volume = [(each, known_to(each.name, yardstick, belief)) for each in asked(target, yardstick)]
    first = next((wanted for wanted, now in volume if now <= wanted.limit), None)
    spent = [] if first is not None else _spent(target, known, volume)
    if volume and first is None and not spent:
        return None
    if not known.readings:
        return None
    if not target.lines and first is not None:
        return None if _unread(target, known) else f"{first.name} {_REACHED}"
    rows = [row for row in known_rows(known.case, known.printed, known.readings) if row.row.kind != "volume"]
    missing = [row for row in rows if row.open]
    if not missing and (first is not None or not volume):
        return ALL_REACHED
    if not all(row.settled for row in rows):
        return None
    if first is not None or not volume:
        return f"{', '.join(row.row.name for row in missing)} {_BEYOND}"
    wanted, now = spent[0]
    floor, left = (format_quantity(size, "um", 3) for size in (wanted.floor, now))
    return f"{wanted.name} target cannot be reached: endless readings would leave {floor}, these leave {left}"


def _spent(target: Target, known: Estimation, volume: Sequence[_Standing]) -> list[_Standing]:
    """Return the accuracies of which readings have taken away what they can, with what they leave at least.

    A floor counts with the size that is surely there. As stated it counts once a few readings have checked the sizes,
    if it is clearly above its limit. A floor above what is left already counts no more.
    """
    surely = 1.0 if known.posterior is None else known.posterior.draws[0].surely
    sizes = {} if known.posterior is None else known.posterior.sizes
    largest = max([1.0, *(size for (kind, _), size in sizes.items() if kind not in _PASSING)])

    for wanted, now in volume:  # floors grow with the sizes at the most, and take long to find
        most = largest * wanted.floor
        if now <= attainable(wanted.limit, most) and max(wanted.floor, surely * most) > wanted.limit:
            break
    else:
        return []
    found = []
    for wanted, (stated, now) in zip(asked(target, known.case.yardstick_as_sized), volume, strict=True):
        checked = len(known.readings) >= FEW and stated.floor > _CLEARLY * wanted.limit
        floors = surely * wanted.floor, *([stated.floor] if checked else [])
        least = max((floor for floor in floors if floor <= now), default=0.0)
        if now <= attainable(wanted.limit, wanted.floor) and least > wanted.limit:
            found.append((wanted._replace(floor=least), now))
    return found


def _unread(target: Target, known: Estimation) -> bool:
    """Return whether sizes as stated meet an accuracy unread, and fewer readings than check them were taken."""
    if len(known.readings) >= FEW or not len(known.stated.sizes):
        return False
    yardstick, prior = known.stated.yardstick, known.stated.prior
    return any(known_to(each.name, yardstick, prior) <= each.limit for each in asked(target, yardstick))


def out_of_reach(
    target: Target, path: Sequence[Accuracy], before: Callable[[], Estimation], now: Estimation
) -> str | None:
    """Return in words that only an accuracy could stop the campaign and many readings have hardly brought it nearer.

    path : how well the machine was known before the first reading and after each
    before, now : what was known as many readings ago, and is: rows count where rows are asked for
    """
    if target.readings is not None or target.budget is not None or len(path) <= FUTILE:
        return None
    then, last = path[-1 - FUTILE], path[-1]
    still = last.rms > _HARDLY * then.rms and last.worst > _HARDLY * then.worst
    return OUT_OF_REACH if still and not (target.lines and _nearer(before(), now)) else None


def _nearer(before: Estimation, now: Estimation) -> bool:
    """Return whether a row with a limit is known better than it was, by more than what hardly counts."""
    old, new = (
        {row.row: row for row in known_rows(each.case, each.printed, ()) if row.limit is not None}
        for each in (before, now)
    )
    return any(row.known < _HARDLY * old[name].known for name, row in new.items() if not row.settled)


PATIENCE = 25
"""So many skipped readings in a row are taken for a source that does not work."""


def refuse_endless(in_a_row: int, answer: Skip) -> None:
    """Raise SourceError where a source has skipped too many readings in a row, `answer` the last one."""
    if in_a_row >= PATIENCE:
        what = "the source has skipped {in_a_row} readings in a row; the last one because: {reason}"
        raise SourceError(what, "Mend it, then go on with --resume", in_a_row=in_a_row, reason=answer.reason)


def result_of(known: Estimation) -> KeptResult:
    """Return what the readings of a campaign that has ended come to, in the four digits that a record keeps."""
    if not known.readings:
        return KeptResult()
    if known.agreement.withheld:
        return KeptResult(None, None, "contradict")
    rms, expanded = (float(f"{size:.4g}") for size in (known.accuracy.rms, expanded_uncertainty(known).space))
    return KeptResult(rms, expanded, "agree")


def refuse_implausible(known: Estimation) -> None:
    """Raise SourceError where the last reading is one that no error of the stated size could make."""
    last = len(known.readings) - 1
    doubt = next((doubt for doubt in known.outliers if doubt.implausible and doubt.reading == last), None)
    if doubt is not None:
        remedy = "It is kept and not relied on. Mend the source; if it is right, undo it and record it with --accept"
        raise SourceError(known.objection_to(doubt), remedy)


ENDINGS = (ALL_REACHED, BUDGET, CONTRADICT, OUT_OF_REACH, *WORDS["endings"])
"""Those that are whole sentences."""
_TAKEN = "{count} reading taken", "{count} readings taken"
_KEPT = (
    *ENDINGS,
    later("{name} target reached"),
    later("{rows} cannot be reached with these set-ups"),
    later("{name} target cannot be reached: endless readings would leave {floor:.3g} um, these leave {left:.3g} um"),
)
"""And those with names and sizes, as they are kept."""


def because_text(because: str) -> str:
    """Return the reason in the language that is spoken; one that is not known here stays English."""
    for words in (*_TAKEN, *_KEPT):
        if (found := re.fullmatch(re.sub(r"{(\w+)[^}]*}", r"(?P<\1>.+)", words), because)) is not None:
            parts = {key: float(part) if key in ("floor", "left") else part for key, part in found.groupdict().items()}
            return said(words, **parts) if words in _KEPT else counted(*_TAKEN, int(parts["count"]))
    return because
