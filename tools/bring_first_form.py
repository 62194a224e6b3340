"""Make a record of today's form of one of the first form, an SQLite database with a log beside it while it was open.

    python tools/bring_first_form.py RECORD NEW

Nothing of the old one is touched, a log beside it is read with it. Exit status: 0 done, 1 with the reason on stderr.
"""

from __future__ import annotations

import argparse
import contextlib
import shutil
import sqlite3
import sys
import tempfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from urllib.parse import quote

from axiscal.exceptions import AxiscalError
from axiscal.record.events import Stored
from axiscal.record.lines import EventText
from axiscal.record.payload import PayloadError, decode, encode
from axiscal.record.store import Record, content_of

_LOGS = ("-wal", "-shm", "-journal")


class BroughtError(Exception):
    """The old record is not whole."""


def bring(old: Path, new: Path) -> int:
    """Write a record of all events of another one, and return how many; raises BroughtError, AxiscalError, OSError."""
    try:
        with _still(old) as address:
            events = _events_at(address)
    except (sqlite3.Error, UnicodeDecodeError) as error:  # sqlite3 may quote in its own words what is no text
        raise BroughtError(f"{old}: {error}") from error
    for log in _logs(old):
        if log.exists() and events[: len(alone := _events_alone(old))] != alone:
            raise BroughtError(f"{log.name} beside it is of another state of it and takes entries back; move it away")
    Record.made(new, content_of([EventText(each.at, *encode(each.event)) for each in events])).close()
    return len(events)


def _logs(path: Path) -> tuple[Path, ...]:
    """Return the names of what SQLite leaves beside a record."""
    return tuple(path.with_name(path.name + suffix) for suffix in _LOGS)


def _events_alone(path: Path) -> tuple[Stored, ...]:
    """Return what the file holds without a log; nothing where it cannot be read without it."""
    with contextlib.suppress(sqlite3.Error, UnicodeDecodeError, BroughtError):
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
    logs = [log for log in _logs(path) if log.exists()]
    if not logs:
        yield _alone(path)
        return
    with tempfile.TemporaryDirectory(prefix="axiscal-") as folder:
        for each in (path, *logs):
            shutil.copyfile(each, Path(folder) / each.name)
        yield f"file:{quote(str(Path(folder) / path.name))}?mode=rw"


def _events(connection: sqlite3.Connection) -> Iterator[Stored]:
    if connection.execute("PRAGMA user_version").fetchone()[0] != 1:
        raise BroughtError("it is of no form that there has been")
    if connection.execute("PRAGMA quick_check(1)").fetchone()[0] != "ok":
        raise BroughtError("its pages do not agree")
    for number, at, kind, payload in connection.execute("SELECT id, at, kind, payload FROM events ORDER BY id"):
        try:
            yield Stored(number, at, decode(kind, payload))
        except PayloadError as error:
            raise BroughtError(f"event {number}: {error}") from error


def main() -> int:
    """Bring what the command line names."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("record", type=Path)
    parser.add_argument("new", type=Path)
    names = parser.parse_args()
    try:
        print(f"{bring(names.record, names.new)} events written: {names.new}")
    except (BroughtError, AxiscalError, OSError) as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
