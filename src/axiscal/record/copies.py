"""Copies of a record: whole, to the letter, and only in the place of an earlier copy of the same one.

Where a record is kept follows from its name: a file, or, as "store:NAME", the server that AXISCAL_STORE names.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

from axiscal.document.durable import write_whole
from axiscal.document.gone import instead_of
from axiscal.document.ports import part
from axiscal.exceptions import RecordError
from axiscal.record.accepted import Bumped
from axiscal.record.events import Created, Event, Recorded
from axiscal.record.line_form import EventText
from axiscal.record.log import STORED, EventLog, in_one, refuse_changed
from axiscal.record.payload import encode
from axiscal.record.store import Record, content_of, record_errors, refuse_existing
from axiscal_core import refusals

Opened = Callable[[], AbstractContextManager[EventLog]]
"""How a record is opened to be read."""


def is_stored(path: str | Path) -> bool:
    """Whether a name is that of a campaign on a server."""
    return str(path).startswith(STORED)


def file_name(path: Path) -> Path:
    """Return the name that a file of a record has, also where the record itself is on a server."""
    return Path(f"{_name(path)}.axiscal") if is_stored(path) else path


def created_log(path: str | Path, created: Created) -> EventLog:
    """Return a new log that holds the event `created`; raises RecordError where there is one of this name."""
    if not is_stored(path):
        return Record.create(path, created)
    name = _name(path)
    log: EventLog = part("server-log").create(part("database")(), name, created)
    return log


def opened_log(path: str | Path, *, write: bool = True, changed: bool = False) -> EventLog:
    """Return the log of an existing record, checked; raises RecordError.

    changed : also where it was changed since somebody signed it
    """
    if not isinstance(path, str | Path):
        raise refusals.InputError("Campaign.open", "path", f"= {path!r} is none", 'Give one, such as "mill.axiscal"')
    log: EventLog
    if is_stored(path):
        log = part("server-log").open(part("database")(), _name(path), write=write)
    else:
        log = Record.open(path, write=write)
    try:
        if not changed:
            refuse_changed(log)
    except BaseException:
        log.close()
        raise
    return log


def _name(path: str | Path) -> str:
    name = str(path).removeprefix(STORED)
    if not name.strip():
        raise RecordError("No campaign of the store is named", "Name one: store:NAME", path)
    refuse_unfit(name, path)
    return name


_NO_FILE = re.compile(r'[/\\:*?"<>|]|^[-. ]|[. ]$|^(con|prn|aux|nul|com\d|lpt\d)(\.|$)', re.IGNORECASE)
"""What no name of a file may have, on one system or another, or what a command takes for an option."""
_LONGEST = 100
"""Letters of a name: the file beside it has more, and most file systems take 255 bytes."""


def unfit(name: str) -> bool:
    """Return whether a name is no name of a file on every system."""
    return not 0 < len(name) <= _LONGEST or not name.isprintable() or _NO_FILE.search(name) is not None


def refuse_unfit(name: str, path: str | Path) -> None:
    """Raise RecordError for a name of a campaign of a store that is no name of a file on every system."""
    if unfit(name):
        remedy = "Use up to {most} letters, digits, blanks, _ - and . between; what is there already goes by its id"
        raise RecordError("A campaign of the store cannot have this name", remedy, path, most=_LONGEST)


def is_store(named: Path) -> bool:
    """Return whether the name is that of the whole store, not of a campaign in it."""
    return str(named) == STORED


def gathered(named: Iterable[Path]) -> list[Path]:
    """Return the names of single records, by which each is opened; raises RecordError where the store cannot tell."""
    found = list[Path]()
    for each in named:
        if is_store(each):
            with each_opened(each) as there:
                found += [path for path, _ in there]
        elif not is_stored(each) and each.is_dir():
            found += sorted(each.glob("*.axiscal"))
        else:
            found.append(each)
    return found


def records_of(shop: Path) -> list[Path]:
    """Return the records of a folder, or of the store; raises RecordError for anything else."""
    if not is_store(shop) and not shop.is_dir():
        remedy = "Name the folder that holds the records, or {store} for the campaigns on the server"
        raise RecordError("This is no folder", remedy, shop, store=STORED)
    return gathered([shop])


@contextmanager
def each_opened(shop: Path) -> Iterator[list[tuple[Path, Opened]]]:
    """Yield the records of a folder or of the store, each with how it is opened to be read; raises as `records_of`."""
    if is_store(shop):
        with part("server-logs")() as there:
            yield there
    else:
        yield [(file, partial(opened_log, file, write=False)) for file in records_of(shop)]


TYPE = "axiscal-type/1"
"""The schema of what a type has taught."""


def write_copy(log: EventLog, path: Path) -> None:
    """Write a copy of a log as a file, in the place of an earlier copy if there is one; raises as `refuse_other`."""
    if _is_itself(log, path):
        return
    refuse_other(log, path)
    with record_errors(path):
        write_whole(path, content_of(in_one([text.row for text in log.texts()]))[0])


def end_at(path: Path, last: int) -> Path:
    """Let a record end at an event, and return where all of it stays, beside; raises RecordError."""
    kept = path.with_name(f"{path.stem}-whole{path.suffix}")
    refuse_existing(kept)
    with Record.open(path) as record, record_errors(path):
        rows = [text.row for text in record.texts()[:last]]
        write_whole(kept, path.read_bytes())
        write_whole(path, content_of(in_one(rows))[0])
    return kept


def refuse_other(log: EventLog, path: Path) -> None:
    """Raise RecordError if there is something at `path` that is more than an earlier copy of this log."""
    if not path.exists() or _is_itself(log, path):
        return
    remedy = "Name another folder, or move it away"
    try:
        with Record.open(path, write=False) as there:
            kept = [_content(text.row) for text in there.texts()]
    except RecordError as failure:
        what = "A file with the name of the record is here already: {why}"
        raise RecordError(what, remedy, path, why=failure.what) from None
    own = [_content(text.row) for text in log.texts()]
    if kept[:1] != own[:1]:
        raise RecordError("Another campaign's record is here already", remedy, path)
    if kept != own[: len(kept)]:
        remedy = "Name another folder, or move it away; or go on with that one"
        raise RecordError("The copy that is here has gone on by itself", remedy, path)


def _is_itself(log: EventLog, path: Path) -> bool:
    return path.exists() and log.path.exists() and path.samefile(log.path)


def _content(row: EventText) -> tuple[str, str, str]:
    return row.at, row.kind, row.payload


def carried_text(path: Path) -> str:
    """Return what a campaign names as its prior as text that a record can carry; raises RecordError.

    path : of a campaign record
    """
    with suppress(OSError), path.open("rb") as file:  # the record says what is wrong with it
        if TYPE.encode() in file.read(200):
            raise RecordError("{schema} is gone", instead_of("files", TYPE), path, schema=TYPE)
    with opened_log(path, write=False) as record:
        state = record.state()
    created = state.created
    if created is None or not state.readings:
        raise RecordError("The record has no readings", "Name a campaign that has been measured", path)
    bumps = *carried_bumps(created.prior_text), *state.bumps
    kept: dict[str, Sequence[Event]] = {"mounted": state.mounted, "warmed": state.warmed, "bumped": bumps}
    kept = {"readings": [Recorded(reading) for reading in state.readings]} | {k: of for k, of in kept.items() if of}
    document: dict[str, Any] = {name: [json.loads(encode(each)[1]) for each in of] for name, of in kept.items()}
    document["created"] = json.loads(encode(created)[1])
    return json.dumps(document, ensure_ascii=False, separators=(",", ":"), sort_keys=True)


def carried_bumps(text: str) -> tuple[Bumped, ...]:
    """Return the bumps of a machine's controls in such a text; of a type there are none."""
    with suppress(ValueError, TypeError, AttributeError):  # what else is damaged in it is said where it is estimated by
        return tuple(Bumped(**each) for each in json.loads(text).get("bumped", ()))
    return ()
