"""An index of many records: all their events in one database, so that each is read only once.

The index of a folder stands beside the records, that of a store in the user's folder for such files.

It can be thrown away at any time: the records are what counts, and it is made anew from them.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import sqlite3
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple, Self

from axiscal.document.durable import Closing
from axiscal.exceptions import RecordError, UnreachableError
from axiscal.record.line_form import EventText
from axiscal.record.log import ChainedText, campaign_of
from axiscal.record.opening import opened_log

INDEX = ".fleet.sqlite"
"""Its name in the folder."""
_KIND, _FORM = 0x41584958, 4
"""By which SQLite knows the database as ours ("AXIX"), and its form; of another form it is made anew."""
_PATIENCE = 4.0
"""Seconds to wait for another program that writes into it; it does without it then."""
_TABLES = """
CREATE TABLE records (file BLOB PRIMARY KEY, size INTEGER, changed INTEGER, fault TEXT, campaign TEXT, chain TEXT,
    last INTEGER, digest TEXT) WITHOUT ROWID;
CREATE TABLE events (file BLOB, number INTEGER, at TEXT, kind TEXT, payload TEXT, chain TEXT,
    PRIMARY KEY (file, number)) WITHOUT ROWID;
CREATE TABLE findings (chain TEXT, question TEXT, answer TEXT, PRIMARY KEY (chain, question)) WITHOUT ROWID;
"""


Stamp = tuple[int, int]
"""By which it is seen that a record has changed: of a file its size and time."""


class IndexedRecord(NamedTuple):
    """A record of the folder or store.

    fault : why it cannot be read, "" if it can; the rest is then empty
    campaign : which one it is of; chain : the name of what it holds; last : number of its last event
    """

    file: Path
    fault: str
    campaign: str
    chain: str
    last: int


class Kinds(NamedTuple):
    """How many events of one kind there are in all records, and when the first and the last of them was written."""

    kind: str
    events: int
    first: str
    last: str


class FolderIndex(Closing):
    """The index of one folder, open; a context manager.

    folder : where it is kept; why_apart : why it is not kept there, "" where it is
    """

    def __init__(self, folder: Path, database: sqlite3.Connection, why_apart: str) -> None:
        self.folder, self._database, self.why_apart = folder, database, why_apart

    @classmethod
    def open(cls, folder: Path) -> Self:
        """Return the index of a folder; where it cannot be written there, one that is gone afterwards.

        Raises RecordError where there is no such folder.
        """
        if not folder.is_dir():
            raise RecordError("This is no folder", "Name the folder that holds the records", folder)
        return cls._kept_in(folder)

    @classmethod
    def _kept_in(cls, folder: Path) -> Self:
        try:
            return cls(folder, _opened(folder / INDEX), "")
        except (sqlite3.Error, OSError) as failure:
            return cls(folder, _made(":memory:"), f"the index cannot be kept in the folder: {failure}")

    def refresh(self, told: Callable[[str], None] = lambda said: None) -> None:
        """Take in what is new in the folder.  told : called with the name of each record that is read"""
        before = {row[0]: row[1:] for row in self._rows("SELECT file, size, changed, fault FROM records")}
        there = self._there()
        for gone in before.keys() - {_name(path) for path, _ in there}:
            with self._writing() as database:
                database.execute("DELETE FROM events WHERE file = ?", (gone,))
                database.execute("DELETE FROM records WHERE file = ?", (gone,))
        for path, stamp in there:
            if before.get(_name(path)) != (*stamp, ""):  # what could not be read is tried again
                told(path.name)
                self._take_in(path, stamp)

    def _there(self) -> list[tuple[Path, Stamp]]:
        """Return the records there are, and of each by what it is seen that it has changed."""
        return [(file, _stamp(file)) for file in sorted(self.folder.glob("*.axiscal"))]

    def _path(self, name: str) -> Path:
        return self.folder / name

    def _take_in(self, file: Path, stamp: Stamp) -> None:
        try:
            with opened_log(file, write=False) as record:
                texts = record.texts()
        except UnreachableError:
            raise
        except (RecordError, OSError) as fault:
            why = fault.what if isinstance(fault, RecordError) else fault.strerror or str(fault)
            with self._writing() as database:
                database.execute("DELETE FROM events WHERE file = ?", (_name(file),))
                self._enter(_name(file), *stamp, why, "", "", 0)
            return
        with self._writing() as database:
            begin = self._known(_name(file), texts)
            new = ((_name(file), n, *_fields(text)) for n, text in enumerate(texts[begin:], begin + 1))
            database.executemany("INSERT INTO events VALUES (?, ?, ?, ?, ?, ?)", new)
            self._enter(_name(file), *stamp, "", campaign_of(texts[0]), texts[-1].chain, len(texts))

    def _enter(self, name: bytes, *row: object) -> None:
        """Write the row of a record, after its events."""
        self._database.execute("INSERT OR REPLACE INTO records VALUES (?, ?, ?, ?, ?, ?, ?, '')", (name, *row))
        digest = _digest(self._database, name)
        self._database.execute("UPDATE records SET digest = ? WHERE file = ?", (digest, name))

    def _known(self, name: bytes, texts: tuple[ChainedText, ...]) -> int:
        """Return how many events of a record are in the index; none where it has not simply gone on."""
        rows = self._rows("SELECT max(number), chain FROM events WHERE file = ?", name)
        number, chain = rows[0]
        if number is not None and number <= len(texts) and texts[number - 1].chain == chain:
            return int(number)
        self._database.execute("DELETE FROM events WHERE file = ?", (name,))
        return 0

    def records(self) -> list[IndexedRecord]:
        """Return the records of the folder, by their names."""
        rows = self._rows("SELECT file, fault, campaign, chain, last FROM records ORDER BY file")
        return [IndexedRecord(self._path(os.fsdecode(row[0])), *row[1:]) for row in rows]

    def chain_at(self, record: IndexedRecord, number: int) -> str:
        """Return the chain behind an event of a record, "" if it has no such event."""
        rows = self._rows("SELECT chain FROM events WHERE file = ? AND number = ?", _name(record.file), number)
        return str(rows[0][0]) if rows else ""

    def parting(self, one: IndexedRecord, other: IndexedRecord) -> int:
        """Return the number of the first event that two records of one campaign do not share."""
        query = (
            "SELECT count(*) FROM events AS a JOIN events AS b ON a.number = b.number AND a.chain = b.chain "
            "WHERE a.file = ? AND b.file = ?"
        )
        return int(self._rows(query, _name(one.file), _name(other.file))[0][0]) + 1

    def kinds(self) -> list[Kinds]:
        """Return what happened in all records together."""
        rows = self._rows("SELECT kind, count(*), min(at), max(at) FROM events GROUP BY kind ORDER BY kind")
        return [Kinds(*row) for row in rows]

    def found(self, chain: str, question: str) -> str | None:
        """Return what was kept as the answer to a question about the record of this name.

        None where nothing was, or what is there is not what was kept.
        """
        for (kept,) in self._rows("SELECT answer FROM findings WHERE chain = ? AND question = ?", chain, question):
            answer = str(kept).partition(" ")[2]
            if kept == _with_digest(chain, question, answer):
                return answer
        return None

    def keep(self, chain: str, question: str, answer: str) -> None:
        """Keep the answer to a question about the record of this name."""
        with self._writing() as database:
            row = (chain, question, _with_digest(chain, question, answer))
            database.execute("INSERT OR REPLACE INTO findings VALUES (?, ?, ?)", row)

    def _rows(self, query: str, *values: object) -> list[tuple[Any, ...]]:
        return self._database.execute(query, values).fetchall()

    @contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        """Yield the database in one transaction; where another program holds it, what is new goes to one in memory."""
        try:
            self._database.execute("BEGIN IMMEDIATE")
        except sqlite3.OperationalError as busy:
            self._leave(str(busy))
            self._database.execute("BEGIN IMMEDIATE")
        try:
            yield self._database
            self._database.commit()
        except BaseException as failure:
            self._database.rollback()
            if isinstance(failure, sqlite3.Error):
                what, remedy = f"The index of the records cannot be written: {failure}", "Make room on the disk"
                raise RecordError(what, f"{remedy}; the records are as they were", self.folder / INDEX) from failure
            raise

    def _leave(self, why: str) -> None:
        """Go on with a copy in memory."""
        aside = sqlite3.connect(":memory:", isolation_level=None)
        self._database.backup(aside)
        self._database.close()
        self._database, self.why_apart = aside, f"the index in the folder cannot be written: {why}"

    def close(self) -> None:
        """Close it."""
        self._database.close()


def _name(path: Path) -> bytes:
    """Return the name of a record as the disk has it, which need not be text."""
    return os.fsencode(path.name)


def _fields(text: ChainedText) -> Iterable[str]:
    row: EventText = text.row
    return row.at, row.kind, row.payload, text.chain


def _with_digest(chain: str, question: str, answer: str) -> str:
    """Return an answer behind the SHA-256 of all three."""
    return f"{hashlib.sha256(f'{chain} {question} {answer}'.encode()).hexdigest()} {answer}"


def _stamp(file: Path) -> Stamp:
    with contextlib.suppress(OSError):
        found = os.stat(file)
        return found.st_size, found.st_mtime_ns
    return -1, -1


def _opened(path: Path) -> sqlite3.Connection:
    """Return the database of an index, made anew where it is none that can be used; raises sqlite3.Error, OSError."""
    if path.exists():
        try:
            return _hurried(_existing(path))
        except sqlite3.OperationalError:  # another program holds it, or it may not be read: nothing is wrong with it
            raise
        except (sqlite3.DatabaseError, UnicodeDecodeError):  # sqlite3 may quote in its own words what is no text
            path.unlink()
    return _hurried(_made(str(path)))


def _hurried(database: sqlite3.Connection) -> sqlite3.Connection:
    """Return a database that waits for no disk: what lost power tears is seen when it is opened, and made anew."""
    database.execute("PRAGMA synchronous = OFF")
    return database


def _existing(path: Path) -> sqlite3.Connection:
    database = _connected(str(path))
    try:
        kind, form = (database.execute(f"PRAGMA {name}").fetchone()[0] for name in ("application_id", "user_version"))
        whole = database.execute("PRAGMA quick_check(1)").fetchone()[0] == "ok" and _tables(database) == _TABLES
        if (kind, form) != (_KIND, _FORM) or not whole or not _as_written(database):
            raise sqlite3.DatabaseError("it is not an index of this form, or not as it was written")
    except BaseException:
        database.close()
        raise
    return database


def _as_written(database: sqlite3.Connection) -> bool:
    """Return whether each record and its events are as written, and no event lacks its record."""
    kept = dict(database.execute("SELECT file, digest FROM records"))
    named = {file for (file,) in database.execute("SELECT DISTINCT file FROM events")}
    return named <= kept.keys() and all(digest == _digest(database, file) for file, digest in kept.items())


def _digest(database: sqlite3.Connection, name: bytes) -> str:
    """Return the SHA-256 of the row of a record and of all its events."""
    row = database.execute(
        "SELECT size, changed, fault, campaign, chain, last FROM records WHERE file = ?", (name,)
    ).fetchone()
    found = hashlib.sha256(repr((name, row)).encode())
    events = database.execute(
        "SELECT CAST(number || ' ' || at || ' ' || kind || ' ' || payload || ' ' || chain AS BLOB) FROM events "
        "WHERE file = ? ORDER BY number",
        (name,),
    )
    for (event,) in events:
        found.update(event or b"")
    return found.hexdigest()


def _tables(database: sqlite3.Connection) -> str:
    """Return the tables that a database has, as they were made."""
    rows = database.execute("SELECT sql FROM sqlite_master WHERE type = 'table' ORDER BY rowid").fetchall()
    return "".join(f"\n{sql};" for (sql,) in rows) + "\n"


def _connected(address: str) -> sqlite3.Connection:
    database = sqlite3.connect(address, timeout=_PATIENCE, isolation_level=None)
    database.text_factory = lambda raw: raw.decode(errors="replace")  # a flipped bit need not leave UTF-8
    return database


def _made(address: str) -> sqlite3.Connection:
    database = _connected(address)
    database.executescript(
        f"BEGIN IMMEDIATE; {_TABLES} PRAGMA application_id = {_KIND}; PRAGMA user_version = {_FORM}; COMMIT;"
    )
    return database
