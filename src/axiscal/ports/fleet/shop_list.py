"""The records of a shop in one list: which machine, when, how well it was known, and what is wrong with a record."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from axiscal.campaign.possible import described
from axiscal.campaign.versions import versions
from axiscal.description.target import Target
from axiscal.document.durable import clear_drafts
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import expanded_uncertainty
from axiscal.estimation.inheritance import case_of
from axiscal.exceptions import AxiscalError, RecordError
from axiscal.ports.fleet.sister_records import why_not
from axiscal.record.events import Recorded
from axiscal.record.folder_index import FolderIndex, IndexedRecord, Kinds
from axiscal.record.log import ChainedText, EventLog, campaign_of
from axiscal.record.opening import is_store, opened_log
from axiscal.record.store import Record
from axiscal.units import format_quantity


@dataclass(frozen=True, slots=True)
class Known:
    """What a record comes to.

    machine, serial : of the machine; begun, last : the first event and the last reading, ISO 8601, UTC, "" for none
    readings : those that stand; target : in words; ended : why the campaign ended, "" while it goes on
    rms, expanded : RMS standard uncertainty over the volume and U, m, None where nothing is known or promised
    agreement : in one word, "" where there is none, and trouble says why
    """

    machine: str
    serial: str
    begun: str
    last: str
    readings: int
    target: str
    ended: str
    rms: float | None
    expanded: float | None
    agreement: str
    trouble: str = ""


@dataclass(frozen=True, slots=True)
class ShopRecord:
    """A record of the shop: its campaign, with a remark if somebody has to mind something.

    chain : behind its last event; events : how many; known : its result
    """

    file: Path
    campaign: str
    chain: str
    events: int
    known: Known
    remark: str = ""


@dataclass(frozen=True, slots=True)
class ShopList:
    """left_out : records that do not count, and why; kinds : of all events; why_apart : why no index is kept"""

    listed: tuple[ShopRecord, ...]
    left_out: tuple[tuple[Path, str], ...]
    kinds: tuple[Kinds, ...]
    why_apart: str

    @property
    def machines(self) -> int:
        """Number of their machines; without a serial number each campaign counts as another machine."""
        which = [
            (each.known.machine, each.known.serial, "" if each.known.serial else each.campaign) for each in self.listed
        ]
        return len(set(which))


def shop_list(shop: Path, told: Callable[[str], None] = lambda said: None) -> ShopList:
    """Return the records of a folder, or of the store, the machine measured last first.

    told : called with what is being done
    Raises RecordError for what is neither, and where the store does not answer.
    """
    with _index(shop) as index:
        index.refresh(lambda name: told(f"reading {name}"))
        records = index.records()
        left = [(each.file, each.fault) for each in records if each.fault]
        listed = list[ShopRecord]()
        for record in (each for each in records if not each.fault):
            why, remark = _beside_others(record, records, index)
            if why:
                left.append((record.file, why))
                continue
            try:
                known = _known(record, index, told)
            except AxiscalError as fault:
                left.append((record.file, why_not(fault)))
                continue
            listed.append(ShopRecord(record.file, record.campaign, record.chain, record.last, known, remark))
        listed.sort(key=lambda each: (each.known.last or each.known.begun, each.file.name), reverse=True)
        return ShopList(tuple(listed), tuple(left), tuple(index.kinds()), index.why_apart)


def _index(shop: Path) -> FolderIndex:
    if not is_store(shop):
        return FolderIndex.open(shop)
    from axiscal.ports.postgres.store_index import StoreIndex

    return StoreIndex.of_store()


def _beside_others(record: IndexedRecord, records: Sequence[IndexedRecord], index: FolderIndex) -> tuple[str, str]:
    """Return why a record does not count beside the others of its campaign, and what is to be minded where it does."""
    remark = ""
    for other in records:
        if other.file == record.file or other.fault or other.campaign != record.campaign:
            continue
        if other.chain == record.chain:
            if other.file.name < record.file.name:
                return f"it is the same as {other.file.name}", ""
        elif index.chain_at(other, record.last) == record.chain:
            return f"it is an earlier copy of {other.file.name}", ""
        elif index.chain_at(record, other.last) != other.chain:
            remark = f"it and {other.file.name} went on differently from event {index.parting(record, other)}"
    return "", remark


def _known(record: IndexedRecord, index: FolderIndex, told: Callable[[str], None]) -> Known:
    """Return what a record comes to, from the index where it was found before; raises AxiscalError."""
    question = f"what it comes to and whether readings agree, by {json.dumps(versions(), sort_keys=True)}"
    answer = index.found(record.chain, question)
    if answer is None:
        told(f"estimating {record.file.name}")
        answer = json.dumps(asdict(_found(record.file)))
        index.keep(record.chain, question, answer)
    return Known(**json.loads(answer))


def _found(file: Path) -> Known:
    with opened_log(file, write=False) as record:
        description, state, events = described(record), record.state(), record.events()
    machine, serial = description.machine.name, description.particulars.serial
    last = next((each.at for each in reversed(events) if isinstance(each.event, Recorded)), "")
    said = machine, serial, events[0].at, last, len(state.readings), target_words(description.target)
    ended = state.finished or ""
    if not state.readings:
        return Known(*said, ended, None, None, "", "it has no readings")
    try:
        known = concluded(case_of(description), state.readings)
    except AxiscalError as fault:
        return Known(*said, ended, None, None, "", why_not(fault))
    if known.agreement.withheld:
        return Known(*said, ended, None, None, "contradict")
    return Known(*said, ended, known.accuracy.rms, expanded_uncertainty(known).space, "agree")


def target_words(target: Target) -> str:
    """Return when a campaign stops, in words."""
    lengths = ("RMS", target.rms), ("worst", target.worst), ("U", target.expanded)
    said = [f"{name} {format_quantity(value, 'um', 3)}" for name, value in lengths if value is not None]
    said += [want.row.name for want in target.lines]
    if target.readings is not None:
        said.append(f"{target.readings} readings")
    if target.budget is not None:
        said.append(format_quantity(target.budget, "min", 3))
    return ", ".join(said)


@dataclass(frozen=True, slots=True)
class Brought:
    """What became of a record: its file in the folder, and by how many events the file is longer now."""

    file: Path
    what: Literal["new", "went on", "there already"]
    events: int


def brought(folder: Path, source: Path) -> Brought:
    """Bring a record into a folder; raises RecordError where the copy there has gone on by itself."""
    with Record.open(source, write=False) as record, FolderIndex.open(folder) as index:
        index.refresh()
        texts = record.texts()
        campaign = campaign_of(texts[0])
        there = [each for each in index.records() if each.campaign == campaign]
        for each in there:
            if index.chain_at(each, len(texts)) == texts[-1].chain:
                clear_drafts(folder, each.file.name)  # of one who was killed when it had just been published
                return Brought(each.file, "there already", 0)
        for each in there:
            if each.last <= len(texts) and texts[each.last - 1].chain == each.chain:
                with Record.open(each.file) as there_already:  # behind its end: a copy in its place could hold less
                    there_already.extend([text.row for text in texts[each.last :]], after=each.last)
                return Brought(each.file, "went on", len(texts) - each.last)
        if there:
            raise _parted(record, texts, there[0], index)
        file = _free(folder / source.name, campaign)
        Record.made(file, [text.row for text in texts]).close()
        return Brought(file, "new", len(texts))


def _parted(record: EventLog, texts: tuple[ChainedText, ...], there: IndexedRecord, index: FolderIndex) -> RecordError:
    first = next(n for n, text in enumerate(texts, 1) if index.chain_at(there, n) != text.chain)
    what = f"It and its copy {there.file} have each gone on by themselves from event {first}"
    remedy = "Nothing was changed; go on with one of them, and keep the other under its name beside it"
    return RecordError(what, remedy, record.path)


def _free(file: Path, campaign: str) -> Path:
    """Return a name in the folder for a new record: its own, or one with its campaign where another has that."""
    return file.with_stem(f"{file.stem}-{campaign[:8]}") if file.exists() else file
