"""The records of a shop in one list: which machine, when, how well it was known, and what is wrong with a record.

What records come to is kept in the user's folder for what can be made anew, by the chain of all that each holds.
Nothing is said there of where a record stands: the same campaign in a folder, a copy of it and one on a server have one
name. A file that was changed by anybody or anything else, or by other versions, holds nothing.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from axiscal.campaign.possible import described, versions
from axiscal.document.durable import clear_drafts, write_whole
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import expanded_uncertainty
from axiscal.estimation.inheritance import case_of
from axiscal.exceptions import AxiscalError, RecordError, UnreachableError
from axiscal.language.spoken import speaking
from axiscal.language.stages import staged
from axiscal.ports.fleet.sister_records import Copy, beside_others, why_not
from axiscal.present.guide.progress import goals_text
from axiscal.record.copies import opened_log, records_of
from axiscal.record.events import Recorded
from axiscal.record.log import campaign_of, shared_events
from axiscal.record.store import Record


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
    """left_out : records that do not count, and why; kinds : how many events of each kind all records have

    why_apart : why what they come to is not kept for the next time
    """

    listed: tuple[ShopRecord, ...]
    left_out: tuple[tuple[Path, str], ...]
    kinds: Mapping[str, int]
    why_apart: str

    @property
    def machines(self) -> int:
        """Number of their machines; without a serial number each campaign counts as another machine."""
        which = [
            (each.known.machine, each.known.serial, "" if each.known.serial else each.campaign) for each in self.listed
        ]
        return len(set(which))


def shop_list(shop: Path) -> ShopList:
    """Return the records of a folder, or of the store, the machine measured last first.

    Raises RecordError for what is neither, and where the store does not answer.
    """
    records, left = _looked_at(shop)
    before, why_apart, listed = kept_answers(), "", list[ShopRecord]()
    answers = {**before}
    for record in staged("records", records, len(records)):
        why, remark = beside_others(record, records)
        if why:
            left.append((record.file, why))
            continue
        try:
            if record.chain not in answers:
                answers[record.chain] = asdict(_found(record.file))
        except AxiscalError as fault:
            left.append((record.file, why_not(fault)))
            continue
        known = Known(**answers[record.chain])
        listed.append(ShopRecord(record.file, record.campaign, record.chain, len(record.chains), known, remark))
    if answers != before:
        try:
            keep_answers(answers)
        except OSError as fault:
            why_apart = str(fault)
    listed.sort(key=lambda each: (each.known.last or each.known.begun, each.file.name), reverse=True)
    kinds = Counter(kind for record in records for kind in record.kinds)
    return ShopList(tuple(listed), tuple(left), dict(sorted(kinds.items())), why_apart)


def _looked_at(shop: Path) -> tuple[list[Copy], list[tuple[Path, str]]]:
    """Return the records of a folder or store, and of those that cannot be read why."""
    found, left = list[Copy](), list[tuple[Path, str]]()
    for file in records_of(shop):
        try:
            with opened_log(file, write=False) as record:
                found.append(Copy.from_texts(file, record.texts()))
        except UnreachableError:
            raise
        except (RecordError, OSError) as fault:
            left.append((file, why_not(fault)))
    return found, left


def _found(file: Path) -> Known:
    with opened_log(file, write=False) as record:
        description, state, events = described(record), record.state(), record.events()
    machine, serial = description.machine.name, description.particulars.serial
    last = next((each.at for each in reversed(events) if isinstance(each.event, Recorded)), "")
    with speaking("en"):  # it is kept for whoever asks next
        goals = goals_text(description.target)
    said = machine, serial, events[0].at, last, len(state.readings), goals
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
        there = [each for each in _looked_at(folder)[0] if each.campaign == campaign]
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


Answers = Mapping[str, Mapping[str, Any]]
"""By chain, what can be written as JSON."""


def kept_answers() -> Answers:
    """Return the answers of these versions; none where they cannot be read or are not as they were written."""
    with contextlib.suppress(OSError, ValueError, RecursionError):
        digest, _, text = _file().read_text(encoding="utf-8").partition("\n")
        if digest == _digest(text):
            found: Answers = json.loads(text)
            return found
    return {}


def keep_answers(answers: Answers) -> None:
    """Keep answers in the place of those before; raises OSError."""
    file, text = _file(), json.dumps(answers, sort_keys=True)
    file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    write_whole(file, f"{_digest(text)}\n{text}".encode())


def _digest(text: str) -> str:
    """Return the SHA-256 of answers and of the versions that they follow from."""
    return hashlib.sha256(f"{json.dumps(versions(), sort_keys=True)}\n{text}".encode()).hexdigest()


def _file() -> Path:
    named = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(named) if named else Path.home() / ".cache") / "axiscal" / "fleet.json"
