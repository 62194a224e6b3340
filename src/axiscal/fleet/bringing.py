"""Records brought into a shop's folder: each becomes a copy there, or the copy that is there goes on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from axiscal.exceptions import RecordError
from axiscal.record.durable import clear_drafts
from axiscal.record.folder_index import FolderIndex, IndexedRecord
from axiscal.record.log import ChainedText, EventLog, campaign_of
from axiscal.record.store import Record


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
