"""Records of form 1, as they were at first: an SQLite database, with a log beside it while it was open."""

from __future__ import annotations

import contextlib
import shutil
import sqlite3
import tempfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from urllib.parse import quote

from axiscal.record.events import Stored
from axiscal.record.line_form import SQLITE, DamageError, EventText
from axiscal.record.payload import PayloadError, decode, encode

_LOGS = ("-wal", "-shm", "-journal")


def logs_beside(path: Path) -> tuple[Path, ...]:
    """Return the names of what SQLite leaves beside a record."""
    return tuple(path.with_name(path.name + suffix) for suffix in _LOGS)


def first_rows(path: Path) -> list[EventText]:
    """Return all events of a record of the first form, those of a log beside it included; nothing there is touched.

    Raises DamageError, also where the log is of another state of the record: one only adds to what was there. OSError.
    """
    try:
        with _still(path) as address:
            events = _events_at(address)
    except (sqlite3.Error, UnicodeDecodeError) as error:  # sqlite3 may quote in its own words what is no text
        raise DamageError(str(error)) from error
    for log in logs_beside(path):
        if log.exists() and events[: len(alone := _events_alone(path))] != alone:
            raise DamageError(f"{log.name} beside it is of another state of it and takes entries back; move it away")
    return [EventText(each.at, *encode(each.event), n == len(events)) for n, each in enumerate(events, 1)]


def _events_alone(path: Path) -> tuple[Stored, ...]:
    """Return what the file holds without a log; nothing where it cannot be read without it."""
    with contextlib.suppress(sqlite3.Error, UnicodeDecodeError, DamageError):
        return _events_at(_alone(path))
    return ()


def _events_at(address: str) -> tuple[Stored, ...]:
    with closing(sqlite3.connect(address, uri=True)) as connection:
        return tuple(_events(connection))


def _alone(path: Path) -> str:
    return f"file:{quote(str(path.absolute()))}?mode=ro&immutable=1"


@contextlib.contextmanager
def _still(path: Path) -> Iterator[str]:
    """Yield the address of a database that can be read without writing: the file itself, or with logs a copy of all."""
    logs = [log for log in logs_beside(path) if log.exists()]
    if not logs:
        yield _alone(path)
        return
    with tempfile.TemporaryDirectory(prefix="axiscal-") as folder:
        for each in (path, *logs):
            shutil.copyfile(each, Path(folder) / each.name)
        yield f"file:{quote(str(Path(folder) / path.name))}?mode=rw"


def _events(connection: sqlite3.Connection) -> Iterator[Stored]:
    if connection.execute("PRAGMA user_version").fetchone()[0] != SQLITE:
        raise DamageError("it is of no form that there has been")
    if connection.execute("PRAGMA quick_check(1)").fetchone()[0] != "ok":
        raise DamageError("its pages do not agree")
    for number, at, kind, payload in connection.execute("SELECT id, at, kind, payload FROM events ORDER BY id"):
        try:
            yield Stored(number, at, decode(kind, payload))
        except PayloadError as error:
            raise DamageError(f"event {number}: {error}") from error
