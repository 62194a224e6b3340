"""The campaign record: one SQLite file to which events are only ever appended.

A reading is acknowledged when `Record.append` returns: by then it has been committed with a write-ahead log and
synchronous=FULL, and outlives the process and the power.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Self
from urllib.parse import quote

from axiscal.exceptions import RecordError
from axiscal.record.events import Created, Event, EventOrderError, State, Stored, fold
from axiscal.record.migrations import MIGRATIONS
from axiscal.record.payload import PayloadError, decode, encode

APPLICATION_ID = 0x41584953  # "AXIS"
PATIENCE = 4.0
"""Seconds to wait for another process that is writing."""


class Record:
    """An open campaign record; a context manager. Every failure is a RecordError that names the file."""

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path = path
        self._connection = connection

    @classmethod
    def create(cls, path: str | Path, created: Created) -> Self:
        """Return a new record that holds the event `created`; the file appears whole or not at all."""
        path = Path(path)
        refuse_existing(path)
        draft = path.with_name(f".{path.name}.{os.getpid()}.new")
        try:
            with _record_errors(path), cls(path, _connect(f"file:{quote(str(draft))}?mode=rwc")) as record:
                _migrate(record._connection)
                record.append(created)
            _publish(draft, path)
        finally:
            for leftover in (draft, *_sidecars(draft)):
                leftover.unlink(missing_ok=True)
        return cls.open(path)

    @classmethod
    def open(cls, path: str | Path, *, write: bool = True) -> Self:
        """Return an existing record, checked: its kind, its version, its pages."""
        path = Path(path)
        _refuse_foreign(path)
        lasting = os.access(path, os.W_OK) and os.access(path.parent, os.W_OK)
        mode = "rw" if write or lasting else "ro"  # who may write also clears away the write-ahead log on closing
        if mode == "ro" and not os.access(path.parent, os.W_OK) and not any(side.exists() for side in _sidecars(path)):
            mode = "ro&immutable=1"  # a write-ahead log cannot be opened in a folder that is read-only
        with _record_errors(path):
            record = cls(path, _connect(f"file:{quote(str(path.absolute()))}?mode={mode}", write))
            try:
                record._check(write)
            except BaseException:
                record.close()
                raise
            return record

    def append(self, *events: Event, after: int | None = None) -> int:
        """Write `events` in one transaction and return the number of the last one.

        after : number of the last event the caller knows of; RecordError if another process has written since
        """
        at = datetime.now(UTC).isoformat(timespec="milliseconds")
        rows = [(*encode(event), at) for event in events]
        with _record_errors(self.path), _transaction(self._connection):
            if after is not None and self.last() != after:
                raise RecordError(
                    "Another process has written to this record in the meantime",
                    "Look at it with `axiscal status`, then give the command again",
                    self.path,
                )
            for row in rows:
                self._connection.execute("INSERT INTO events (kind, payload, at) VALUES (?, ?, ?)", row)
        return self.last()

    def last(self) -> int:
        """Return the number of the last event, 0 if there is none."""
        with _record_errors(self.path):
            row = self._connection.execute("SELECT coalesce(max(id), 0) FROM events").fetchone()
        return int(row[0])

    def events(self) -> tuple[Stored, ...]:
        """Return all events, oldest first."""
        with _record_errors(self.path):
            rows = self._connection.execute("SELECT id, at, kind, payload FROM events ORDER BY id").fetchall()
            return tuple(Stored(number, at, decode(kind, payload)) for number, at, kind, payload in rows)

    def state(self) -> State:
        """Return the state folded from all events."""
        with _record_errors(self.path):
            return fold(self.events())

    def copy(self, path: Path) -> None:
        """Write a copy of the record, in the place of an earlier copy if there is one; raises as `refuse_other`."""
        if path.exists() and path.samefile(self.path):
            return
        self.refuse_other(path)
        draft = path.with_name(f".{path.name}.{os.getpid()}.new")
        try:
            with _record_errors(path):
                self._connection.execute("VACUUM INTO ?", (str(draft),))
                os.replace(draft, path)
                _sync_folder(path.parent)
        finally:
            draft.unlink(missing_ok=True)

    def refuse_other(self, path: Path) -> None:
        """Raise RecordError if there is something at `path` that is more than an earlier copy of this record."""
        if not path.exists() or path.samefile(self.path):
            return
        remedy = "Name another folder, or move it away"
        try:
            with Record.open(path, write=False) as there:
                kept = there.events()
        except RecordError as failure:
            raise RecordError(
                f"A file with the name of the record is here already: {failure.what}", remedy, path
            ) from None
        own = self.events()
        if kept[:1] != own[:1]:
            raise RecordError("Another campaign's record is here already", remedy, path)
        if kept != own[: len(kept)]:
            raise RecordError("The copy that is here has gone on by itself", f"{remedy}; or go on with that one", path)

    def close(self) -> None:
        """Close the file; what was appended is safe without it."""
        self._connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        self.close()

    def _check(self, write: bool) -> None:
        version = _pragma(self._connection, "user_version")
        if version > len(MIGRATIONS):
            raise RecordError(
                f"This record was written by a newer axiscal (form {version}; this one knows {len(MIGRATIONS)})",
                "Install the newer version to go on with it; nothing was changed",
                self.path,
            )
        if self._connection.execute("PRAGMA quick_check(1)").fetchone()[0] != "ok":
            raise _damaged(self.path, "its pages do not agree")
        if write:
            _migrate(self._connection)


def refuse_existing(path: Path) -> None:
    """Raise RecordError if there is something at `path` already."""
    if path.exists():
        raise RecordError(
            "This file exists already", "Go on with it by `axiscal next`, or name another file for the record", path
        )


def _publish(draft: Path, path: Path) -> None:
    try:
        os.link(draft, path)
    except FileExistsError:
        refuse_existing(path)
    except OSError:  # a file system without hard links
        refuse_existing(path)
        draft.rename(path)
    _sync_folder(path.parent)


def _sync_folder(folder: Path) -> None:
    if os.name != "posix":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _sidecars(path: Path) -> tuple[Path, ...]:
    return tuple(path.with_name(path.name + suffix) for suffix in ("-wal", "-shm", "-journal"))


def _refuse_foreign(path: Path) -> None:
    try:
        with path.open("rb") as file:
            head = file.read(100)
    except FileNotFoundError:
        raise RecordError("There is no such record", "Start one with `axiscal start CAMPAIGN`", path) from None
    except IsADirectoryError:
        inside = next(iter(sorted(path.glob("*.axiscal"))), "a file *.axiscal")
        raise RecordError("This is a folder", f"Name the record in it: {inside}", path) from None
    except OSError as error:
        raise RecordError(f"The record cannot be opened: {error.strerror}", "Name a file you may read", path) from error
    if head[:16] != b"SQLite format 3\0" or head[68:72] != APPLICATION_ID.to_bytes(4, "big"):
        raise _foreign(path)


def _foreign(path: Path) -> RecordError:
    return RecordError(
        "This file is not a campaign record", "Name a record that `axiscal start` or `axiscal run` has made", path
    )


def _damaged(path: Path, detail: str) -> RecordError:
    return RecordError(
        f"The record is damaged: {detail}", "Restore it from a copy; the file has been left as it was", path
    )


def _connect(address: str, write: bool = True) -> sqlite3.Connection:
    connection = sqlite3.connect(address, uri=True, timeout=PATIENCE, isolation_level=None)
    try:
        if write:
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = FULL")
        else:
            connection.execute("PRAGMA query_only = ON")
    except BaseException:
        connection.close()
        raise
    return connection


def _pragma(connection: sqlite3.Connection, name: str) -> int:
    return int(connection.execute(f"PRAGMA {name}").fetchone()[0])


@contextlib.contextmanager
def _transaction(connection: sqlite3.Connection) -> Iterator[None]:
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise


def _migrate(connection: sqlite3.Connection) -> None:
    if _pragma(connection, "user_version") == len(MIGRATIONS):
        return
    with _transaction(connection):
        for migration in MIGRATIONS[_pragma(connection, "user_version") :]:
            for statement in migration.statements:
                connection.execute(statement)
        connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        connection.execute(f"PRAGMA user_version = {len(MIGRATIONS)}")


@contextlib.contextmanager
def _record_errors(path: Path) -> Iterator[None]:
    """Turn what SQLite, the file system or a foreign writer did into a RecordError."""
    try:
        yield
    except (PayloadError, EventOrderError) as error:
        raise _damaged(path, str(error)) from error
    except sqlite3.Error as error:
        raise _sqlite_failure(path, error) from error
    except OSError as error:
        raise RecordError(
            f"The record cannot be written: {error.strerror}", "Name a folder you may write", path
        ) from error


def _sqlite_failure(path: Path, error: sqlite3.Error) -> RecordError:
    name = getattr(error, "sqlite_errorname", "")
    if name.startswith(("SQLITE_BUSY", "SQLITE_LOCKED")):
        what, remedy = (
            "Another program holds this record and is writing",
            "Close it or wait, then give the command again",
        )
    elif name.startswith(("SQLITE_READONLY", "SQLITE_CANTOPEN", "SQLITE_PERM")):
        what, remedy = "The record cannot be written here", "Put it in a folder that exists and that you may write to"
    elif name.startswith(("SQLITE_FULL", "SQLITE_IOERR")):
        what, remedy = f"The disk did not take the entry ({error})", "Make room; everything acknowledged before is kept"
    else:
        return _damaged(path, str(error))
    return RecordError(what, remedy, path)
