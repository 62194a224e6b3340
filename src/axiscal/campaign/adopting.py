"""Readings of a branch taken over into the campaign that it left: a person says so, no machine merges.

Both logs begin alike up to the event where they parted. What the branch has read since goes behind what the campaign
has, as readings that were given; a note keeps up to which event, so that a second time takes only what is new. What
stands here already, because it came from here or by way of another branch, is not taken again: twice it would count
as two readings.
A set-up that both have read has one zero in the model: whether it stayed mounted is for a person to say.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Reading
from axiscal.record.events import State, fold
from axiscal.record.log import ChainedText, EventLog, campaign_of, shared_events

_NOTE = "readings of the branch {branch} taken over, up to its event {last}"
_NOTED = re.compile(r"^readings of the branch (?P<branch>[0-9a-f]{13}) taken over, up to its event (?P<last>\d+)$")
_SHOWN = 13
"""Digits of the chain behind the last event taken over, by which what was taken over is known again."""


@dataclass(frozen=True, slots=True)
class Adopted:
    """taken : readings taken over; shared : events both begin with; undone : earlier readings the branch took back

    back : readings of the branch that were taken over and do not stand here any more
    """

    taken: int
    shared: int
    undone: tuple[int, ...]
    back: int = 0


def adopted(
    campaign: Campaign, own: EventLog, branch: EventLog, same_mounting: bool = False, again: bool = False
) -> Adopted:
    """Take the readings of a branch over into a campaign, all or none.

    own : the campaign's log; same_mounting : set-ups that both have read stayed mounted
    again : what was taken over and taken back here since is taken over once more
    Raises RecordError where they are no branches of one campaign, or a set-up has been read in both.
    """
    mine, theirs = own.texts(), branch.texts()
    if campaign_of(mine[0]) != campaign_of(theirs[0]):
        raise RecordError("It is no branch of this campaign", "Name two records that went on from one", branch.path)
    shared = shared_events([text.chain for text in mine], [text.chain for text in theirs])
    before, now = fold(branch.events()[:shared]), branch.state()
    undone = {reading.number or 0 for reading in set(before.readings) - set(now.readings)}
    if shared == len(theirs):
        return Adopted(0, shared, ())
    since = _taken_until(campaign.state, theirs) or shared
    there = fold(branch.events()[:since])
    taken = _without(there.readings, before.readings)
    here = _without(campaign.state.readings, before.readings)
    new = _not_among(_without(now.readings, before.readings if again else there.readings), here)
    if not same_mounting:
        said = {reading.setup for reading in taken}
        _refuse_shared(campaign.state.readings, [each for each in new if each.setup not in said], branch.path)
    if new:
        campaign.adopt(new, _NOTE.format(branch=theirs[-1].chain[:_SHOWN], last=len(theirs)))
    back = () if again else _not_among([each for each in taken if each in set(now.readings)], here)
    return Adopted(len(new), shared, tuple(sorted(undone)), len(back))


def _without(readings: Iterable[Reading], others: Iterable[Reading]) -> list[Reading]:
    """Return readings but those of another time of the same log, where a number may have been given again."""
    gone = set(others)
    return [reading for reading in readings if reading not in gone]


def _not_among(readings: Iterable[Reading], here: Iterable[Reading]) -> tuple[Reading, ...]:
    """Return readings that do not stand here under any number."""
    left, found = Counter(replace(reading, number=None) for reading in here), list[Reading]()
    for reading in readings:
        same = replace(reading, number=None)
        if left[same]:
            left[same] -= 1
        else:
            found.append(reading)
    return tuple(found)


def _taken_until(state: State, theirs: Sequence[ChainedText]) -> int | None:
    """Return up to which of the events of a branch its readings were taken over; None where none were."""
    found = [(int(each["last"]), each["branch"]) for note in state.notes if (each := _NOTED.match(note.text))]
    known = [last for last, name in found if 0 < last <= len(theirs) and theirs[last - 1].chain.startswith(name)]
    return max(known, default=None)


def _refuse_shared(mine: Sequence[Reading], new: Sequence[Reading], path: Path) -> None:
    both = {reading.setup for reading in mine} & {reading.setup for reading in new}
    if both:
        names = ", ".join(sorted(both))
        raise RecordError(
            f"Both have read the same set-up, {names}, and mounted anew it has other unknowns",
            "If it stayed mounted for both, say so: --same-mounting; else keep the branch as a campaign of its own",
            path,
        )
