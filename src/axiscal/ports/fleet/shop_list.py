"""The records of a shop in one list: which machine, when, how well it was known, and what is wrong with a record.

A campaign that ends keeps what it came to in its record, so the list estimates nothing unless it is asked to.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Literal, TypeVar

from axiscal.campaign.ending import result_of
from axiscal.campaign.possible import described
from axiscal.document.durable import clear_drafts
from axiscal.estimation.estimate import concluded
from axiscal.estimation.inheritance import case_of
from axiscal.exceptions import AxiscalError, RecordError, UnreachableError
from axiscal.language.stages import staged
from axiscal.ports.fleet.sister_records import Copy, beside_others, why_not
from axiscal.present.guide.progress import goals_text
from axiscal.record.copies import each_opened
from axiscal.record.events import Finished, Recorded
from axiscal.record.log import EventLog, campaign_of, shared_events
from axiscal.record.result import NOT_SAID, Result
from axiscal.record.store import Record

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class ShopRecord:
    """A record of the shop, and what it comes to.

    machine, serial : of the machine; begun, last : the first event and the last reading, ISO 8601, UTC, "" for none
    readings : those that stand; target : in words; ended : why the campaign ended, "" while it goes on
    result : of a campaign that ended, or as estimated; remarks : what somebody has to mind
    """

    copy: Copy
    machine: str
    serial: str
    begun: str
    last: str
    readings: int
    target: str
    ended: str
    result: Result
    remarks: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ShopList:
    """left_out : records that do not count, and why; kinds : how many events of each kind all records have"""

    listed: tuple[ShopRecord, ...]
    left_out: tuple[tuple[Path, str], ...]
    kinds: Mapping[str, int]

    @property
    def machines(self) -> int:
        """Number of their machines; without a serial number each campaign counts as another machine."""
        return len({(each.machine, each.serial, "" if each.serial else each.copy.campaign) for each in self.listed})


def shop_list(shop: Path, estimate: bool = False) -> ShopList:
    """Return the records of a folder, or of the store, the machine measured last first.

    estimate : also what campaigns come to that go on, or that an earlier version ended
    Raises RecordError for what is neither, and where the store does not answer.
    """
    found, left = _looked_at(shop, partial(_listed, estimate=estimate))
    copies, listed = [each.copy for each in found], list[ShopRecord]()
    for each in found:
        why, remark = beside_others(each.copy, copies)
        if why:
            left.append((each.copy.file, why))
        else:
            listed.append(replace(each, remarks=(*each.remarks, remark) if remark else each.remarks))
    listed.sort(key=lambda each: (each.last or each.begun, each.copy.file.name), reverse=True)
    return ShopList(tuple(listed), tuple(left), Counter(sorted(kind for copy in copies for kind in copy.kinds)))


def _looked_at(shop: Path, read: Callable[[Copy, EventLog], _T]) -> tuple[list[_T], list[tuple[Path, str]]]:
    """Return what is read of each record of a folder or store, and of those that cannot be read why."""
    found, left = list[_T](), list[tuple[Path, str]]()
    with each_opened(shop) as there:
        for file, opened in staged("records", there, len(there)):
            try:
                with opened() as record:
                    found.append(read(Copy.from_texts(file, record.texts()), record))
            except UnreachableError:
                raise
            except (AxiscalError, OSError) as fault:
                left.append((file, why_not(fault)))
    return found, left


def _listed(copy: Copy, record: EventLog, estimate: bool) -> ShopRecord:
    """Return what a record comes to: as it says itself, or else as it is estimated where that is asked for."""
    description, state, events = described(record), record.state(), record.events()
    last = next((each.at for each in reversed(events) if isinstance(each.event, Recorded)), "")
    remarks = () if state.readings else ("it has no readings",)
    result = next((each.event.result for each in state.undo[-1:] if isinstance(each.event, Finished)), NOT_SAID)
    if estimate and state.readings and result == NOT_SAID:
        try:
            result = result_of(concluded(case_of(description), state.readings))
        except AxiscalError as fault:
            remarks = (why_not(fault),)
    which = description.machine.name, description.particulars.serial, events[0].at, last, len(state.readings)
    return ShopRecord(copy, *which, goals_text(description.target), state.finished or "", result, remarks)


@dataclass(frozen=True, slots=True)
class Brought:
    """What became of a record: its file in the folder, and by how many events the file is longer now."""

    file: Path
    what: Literal["new", "went on", "there already"]
    events: int


def brought(folder: Path, source: Path) -> Brought:
    """Bring a record into a folder; raises RecordError where the copy there has gone on by itself."""
    if not folder.is_dir():
        raise RecordError("This is no folder", "Name the folder that holds the records", folder)
    with Record.open(source, write=False) as record:
        texts = record.texts()
        campaign, chains = campaign_of(texts[0]), [text.chain for text in texts]
        there = [each for each in _looked_at(folder, lambda copy, _: copy)[0] if each.campaign == campaign]
        for each in there:
            if each.holds(chains):
                clear_drafts(folder, each.file.name)  # of one who was killed when it had just been published
                return Brought(each.file, "there already", 0)
        for each in there:
            shared = shared_events(chains, each.chains)
            if shared == len(each.chains):
                with Record.open(each.file) as there_already:  # behind its end: a copy in its place could hold less
                    there_already.extend([text.row for text in texts[shared:]], after=shared)
                return Brought(each.file, "went on", len(texts) - shared)
        if there:
            first = shared_events(chains, there[0].chains) + 1
            what = "It and its copy {other} have each gone on by themselves from event {first}"
            remedy = "Nothing was changed; go on with one of them, and keep the other under its name beside it"
            raise RecordError(what, remedy, record.path, other=there[0].file, first=first)
        file = folder / source.name
        if file.exists():  # of another campaign
            file = file.with_stem(f"{file.stem}-{campaign[:8]}")
        Record.made(file, [text.row for text in texts]).close()
        return Brought(file, "new", len(texts))
