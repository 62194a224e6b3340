"""Where a record is kept follows from its name: a file, or, as "store:NAME", the server that AXISCAL_STORE names."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from axiscal.document.ports import ours
from axiscal.exceptions import RecordError
from axiscal.record.events import Created
from axiscal.record.log import STORED, EventLog
from axiscal.record.store import Record

_DATABASE, _SERVER_LOG = "ports.postgres.database:opened_database", "ports.postgres.server_log:ServerLog"


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
    log: EventLog = ours(_SERVER_LOG).create(ours(_DATABASE)(), name, created)
    return log


def opened_log(path: str | Path, *, write: bool = True) -> EventLog:
    """Return the log of an existing record, checked; raises RecordError."""
    if not is_stored(path):
        return Record.open(path, write=write)
    name = _name(path)
    log: EventLog = ours(_SERVER_LOG).open(ours(_DATABASE)(), name, write=write)
    return log


def _name(path: str | Path) -> str:
    name = str(path).removeprefix(STORED)
    if not name.strip():
        raise RecordError("No campaign of the store is named", "Name one: store:NAME", path)
    return name


def is_store(named: Path) -> bool:
    """Return whether the name is that of the whole store, not of a campaign in it."""
    return str(named) == STORED


def gathered(named: Iterable[Path]) -> list[Path]:
    """Return the names of single records, by which each is opened; raises RecordError where the store cannot tell."""
    found = list[Path]()
    for each in named:
        if is_store(each):
            found += ours("ports.postgres.server_log:all_there")()
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
