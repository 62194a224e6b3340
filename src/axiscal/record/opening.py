"""Where a record is kept follows from its name: a file, or, as "store:NAME", the server that AXISCAL_STORE names."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from axiscal.exceptions import RecordError
from axiscal.record.events import Created
from axiscal.record.log import STORED, EventLog
from axiscal.record.store import Record

if TYPE_CHECKING:
    from axiscal.record.postgres.database import Database


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
    from axiscal.record.postgres.server_log import ServerLog

    name = _name(path)
    return ServerLog.create(store_database(), name, created)


def opened_log(path: str | Path, *, write: bool = True) -> EventLog:
    """Return the log of an existing record, checked; raises RecordError."""
    if not is_stored(path):
        return Record.open(path, write=write)
    from axiscal.record.postgres.server_log import ServerLog

    name = _name(path)
    return ServerLog.open(store_database(), name, write=write)


def store_database() -> Database:
    """Return the server that AXISCAL_STORE names, open; raises RecordError."""
    from axiscal.record.postgres.address import store_address
    from axiscal.record.postgres.database import opened_database

    return opened_database(store_address(None))


def _name(path: str | Path) -> str:
    name = str(path).removeprefix(STORED)
    if not name.strip():
        raise RecordError("No campaign of the store is named", "Name one: store:NAME", path)
    return name
