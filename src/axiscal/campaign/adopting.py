"""Readings of a branch taken over into the campaign that it left: a person says so, no machine merges.

Both logs begin alike up to the event where they parted. Later readings of the branch go behind those of the campaign,
as given readings. A note keeps up to which event, so that a second time takes only new ones. Readings that are here
already, from here or by way of another branch, are not taken again: they would count twice. Readings are taken over as
they were recorded, with the temperatures that were said; mistakes that were accepted in the branch are not. A set-up
that both have read has one zero in the model: a person must say whether it stayed mounted. If it was mounted anew for
the branch, it is a new set-up here: its unknowns begin as stated, whatever is known of the other.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import stands_with_others
from axiscal.document import shown
from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Reading
from axiscal.record.events import Mounted, fold
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
    campaign: Campaign,
    own: EventLog,
    branch: EventLog,
    same_mounting: bool = False,
    again: bool = False,
    mounted_anew: bool = False,
) -> Adopted:
    """Take the readings of a branch over into a campaign, all or none.

    own : the campaign's log; same_mounting : set-ups that both have read stayed mounted
    again : what was taken over and taken back here since is taken over once more
    mounted_anew : set-ups that both have read were mounted anew for the branch
    Raises RecordError where they are no branches of one campaign, where a set-up has been read in both and nobody says
    whether it stayed, or where it shares with others the place that would be another one.
    """
    mine, theirs = own.texts(), branch.texts()
    if campaign_of(mine[0]) != campaign_of(theirs[0]):
        remedy = 'Name two records that went on from one; a new campaign takes this one\'s result by prior = "FILE"'
        raise RecordError("It is no branch of this campaign", remedy, branch.path)
    shared = shared_events([text.chain for text in mine], [text.chain for text in theirs])
    before, now = fold(branch.events()[:shared]), branch.state()
    undone = {reading.number or 0 for reading in set(before.written) - set(now.written)}
    if shared == len(theirs):
        return Adopted(0, shared, ())
    found = [(int(each["last"]), each["branch"]) for note in campaign.state.notes if (each := _NOTED.match(note.text))]
    known = [last for last, name in found if 0 < last <= len(theirs) and theirs[last - 1].chain.startswith(name)]
    since = max(known, default=None) or shared
    there = fold(branch.events()[:since])
    names = _names_here(campaign.state.mounted, now.mounted, mine[shared:], theirs[shared:])
    taken = _without(there.written, before.written)
    here = _without(campaign.state.written, before.written)
    gone = before.written if again else there.written
    new = _not_among(_called(_without(now.written, gone), names), here)
    said = {reading.setup for reading in _called(taken, names)}
    both = ({reading.setup for reading in campaign.state.written} & {reading.setup for reading in new}) - said
    anew = tuple[Mounted, ...]()
    if both and mounted_anew:
        anew = _mounted_anew(campaign, sorted(both), theirs[shared].chain, branch.path)
        new = tuple(_called(new, {each.setup: each.name for each in anew}))
    elif both and not same_mounting:
        what = "Both have read the same set-up, {names}, and mounted anew it has other unknowns"
        remedy = "Say whether it stayed mounted for both, --same-mounting, or not, --mounted-anew"
        raise RecordError(what, remedy, branch.path, names=", ".join(sorted(both)))
    warm = [note.warmed for note in now.notes if note.warmed is not None and note not in there.notes]
    if new:
        brought = [each for each in now.mounted if each.name in names and names[each.name] == each.name]
        unknown = [each for each in brought if each not in campaign.state.mounted]
        note = _NOTE.format(branch=theirs[-1].chain[:_SHOWN], last=len(theirs))
        called = names | {each.setup: each.name for each in anew}
        told = (replace(each, setup=called.get(each.setup, each.setup)) for each in warm)
        campaign.adopt(new, note, (*unknown, *anew, *told))
    back = () if again else _not_among(_called([each for each in taken if each in set(now.written)], names), here)
    return Adopted(len(new), shared, tuple(sorted(undone)), len(back))


def _names_here(
    here: Sequence[Mounted], there: Sequence[Mounted], mine: Sequence[ChainedText], theirs: Sequence[ChainedText]
) -> dict[str, str]:
    """Return what set-ups of a branch are called here, where that is something else or was mounted anew.

    mine, theirs : the events since they parted
    """
    names = {each.setup: each.name for each in here if _begun_among(each, theirs)}
    for each in (one for one in there if one.branch):
        names[each.name] = each.setup if _begun_among(each, mine) else each.name
    return names


def _begun_among(mounted: Mounted, texts: Sequence[ChainedText]) -> bool:
    """Return whether the branch for which a set-up was mounted anew holds these events."""
    return any(mounted.branch and text.chain.startswith(mounted.branch) for text in texts)


def _called(readings: Iterable[Reading], names: Mapping[str, str]) -> list[Reading]:
    """Return readings with other names of their set-ups."""
    return [replace(reading, setup=names.get(reading.setup, reading.setup)) for reading in readings]


def _mounted_anew(campaign: Campaign, setups: Sequence[str], chain: str, path: Path) -> tuple[Mounted, ...]:
    """Return set-ups as they were mounted anew for a branch.  chain : behind its first event"""
    for name in setups:
        if other := stands_with_others(campaign.description.setup(name)):
            what = '"{name}" shares the place of {other} with other set-ups, which nobody says was put up anew'
            raise RecordError(what, "Keep the branch as a campaign of its own", path, name=name, other=shown(other))
        if any(each.name == name for each in campaign.state.mounted):
            remedy = "Say --same-mounting if it stayed; else keep this one as a campaign of its own"
            raise RecordError('"{name}" was mounted anew for a branch already', remedy, path, name=name)
    return tuple(Mounted(name, f"{name}, mounted for {chain[:8]}", chain[:_SHOWN]) for name in setups)


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
