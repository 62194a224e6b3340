"""Readings of a branch taken over into the campaign that it left: a person says so, no machine merges.

Both logs begin alike up to the event where they parted. What the branch has read since goes behind what the campaign
has, as readings that were given; a note keeps up to which event, so that a second time takes only what is new.
A set-up that both have read has one zero in the model: whether it stayed mounted is for a person to say.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Reading
from axiscal.record.events import State, fold
from axiscal.record.log import EventLog, campaign_of, shared_events

_NOTE = "readings of the branch {branch} taken over, up to its event {last}"
_NOTED = re.compile(r"^readings of the branch (?P<branch>[0-9a-f]{13}) taken over, up to its event (?P<last>\d+)$")
_SHOWN = 13
"""Digits of the hash of a branch's first event by which it is known again."""


@dataclass(frozen=True, slots=True)
class Adopted:
    """taken : readings taken over; shared : events both begin with; undone : earlier readings the branch took back"""

    taken: int
    shared: int
    undone: tuple[int, ...]


def adopted(campaign: Campaign, own: EventLog, branch: EventLog, same_mounting: bool = False) -> Adopted:
    """Take the readings of a branch over into a campaign, all or none.

    own : the campaign's log; same_mounting : set-ups that both have read stayed mounted
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
    known_by = theirs[shared].chain[:_SHOWN]
    since = _taken_until(campaign.state, known_by) or shared
    there = fold(branch.events()[:since])
    new = tuple(reading for reading in now.readings if reading not in set(there.readings))  # numbers are given again
    if not same_mounting:
        said = {reading.setup for reading in set(there.readings) - set(before.readings)}
        _refuse_shared(campaign.state.readings, [each for each in new if each.setup not in said], branch.path)
    if new:
        campaign.adopt(new, _NOTE.format(branch=known_by, last=len(theirs)))
    return Adopted(len(new), shared, tuple(sorted(undone)))


def _taken_until(state: State, branch: str) -> int | None:
    found = [_NOTED.match(note.text) for note in state.notes]
    return max((int(each["last"]) for each in found if each and each["branch"] == branch), default=None)


def _refuse_shared(mine: Sequence[Reading], new: Sequence[Reading], path: Path) -> None:
    both = {reading.setup for reading in mine} & {reading.setup for reading in new}
    if both:
        names = ", ".join(sorted(both))
        raise RecordError(
            f"Both have read the same set-up, {names}, and mounted anew it has other unknowns",
            "If it stayed mounted for both, say so: --same-mounting; else keep the branch as a campaign of its own",
            path,
        )
