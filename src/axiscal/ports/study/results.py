"""The results of a study: a database in its folder, written by one process alone, until nothing is missing."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import os
import shlex
import sqlite3
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

from axiscal.document.durable import Closing, HeldError, alone, write_whole
from axiscal.exceptions import StudyError
from axiscal.language.spoken import said
from axiscal.ports.study.study_case import FIGURES, Done, Engine, Solve, WorkItem, canonical, key_of
from axiscal.ports.study.study_file import Study

Row = dict[str, Any]

FILE, _LOCK = "study.sqlite", ".study.lock"
_SCHEMA = """
CREATE TABLE study (text TEXT NOT NULL, digest TEXT NOT NULL, versions TEXT NOT NULL);
CREATE TABLE cases (key TEXT PRIMARY KEY, result TEXT, error TEXT NOT NULL, digest TEXT) WITHOUT ROWID;
"""
_MOST = sys.float_info.max
_DAMAGED = "Name another folder; what can be read of this one, sqlite3 shows"


class Results(Closing):
    """An open database of results; a context manager.

    digest : of all that the cases are a function of; versions : of the programs
    """

    def __init__(self, folder: Path, text: str, digest: str, versions: Mapping[str, str], resume: bool) -> None:
        self.path = folder / FILE
        self._held = ExitStack()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._held.enter_context(_held(folder))
            self._open(text, digest, versions, resume)
        except BaseException:
            self._held.close()
            raise

    def _open(self, text: str, digest: str, versions: Mapping[str, str], resume: bool) -> None:
        begun = self.path.exists()
        self._database = sqlite3.connect(self.path, isolation_level=None)
        self._held.callback(self._database.close)
        self._database.text_factory = lambda raw: raw.decode(errors="replace")  # a flipped bit need not leave UTF-8
        with self._said():
            self._database.execute("PRAGMA journal_mode = WAL")
            self._database.execute("PRAGMA synchronous = FULL")
            tables = {name for (name,) in self._database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
            if not tables:
                self._begin(text, digest, versions)
                return
            if not begun or not {"study", "cases"} <= tables:
                raise StudyError("This is no database of a study", "Name another folder", self.path)
            begun_with = self._database.execute("SELECT digest, versions FROM study").fetchall()
            kept = self._count()
        of, by = self._said_at_its_beginning(begun_with)
        if not resume and kept:
            remedy = "Go on with it by --resume, or name another --out"
            raise StudyError("This folder holds a study already", remedy, self.path)
        if of != digest:
            what = "The study, its campaign or its machine has been changed since these results were begun"
            raise StudyError(what, "Take the changes back, or name another --out", self.path)
        if (first := by.get("axiscal")) != versions.get("axiscal"):
            what = "These results were begun with axiscal {first}, and this is {own}"
            remedy = "Go on with that version, or name another --out"
            raise StudyError(what, remedy, self.path, first=first, own=versions.get("axiscal"))
        with self._said():
            self._give_digests()

    def _give_digests(self) -> None:
        """Give results that were begun when a case had no digest the ones of what they hold now."""
        if any(name == "digest" for _, name, *_ in self._database.execute("PRAGMA table_info(cases)")):
            return
        self._database.create_function("digest_of", 3, _digest, deterministic=True)
        self._database.executescript(
            "BEGIN; ALTER TABLE cases ADD COLUMN digest TEXT; "
            "UPDATE cases SET digest = digest_of(key, result, error); COMMIT"
        )

    def _said_at_its_beginning(self, rows: list[tuple[object, ...]]) -> tuple[object, Mapping[str, object]]:
        """Return the digest of the study and the versions of the programs; raises StudyError."""
        match [(digest, _read(text)) for digest, text in rows]:
            case [(digest, dict() as versions)]:
                return digest, versions
        raise StudyError("It cannot be read of which study these results are", _DAMAGED, self.path)

    def _begin(self, text: str, digest: str, versions: Mapping[str, str]) -> None:
        self._database.executescript(f"BEGIN; {_SCHEMA}")  # tables without the study in them could not be gone on with
        self._database.execute("INSERT INTO study VALUES (?, ?, ?)", (text, digest, canonical(dict(versions))))
        self._database.execute("COMMIT")

    def _count(self) -> int:
        ((count,),) = self._database.execute("SELECT count(*) FROM cases")
        return int(count)

    def keys(self) -> set[str]:
        """Return the keys of the cases that are there."""
        return set(self.all())

    def keep(self, done: Done) -> None:
        """Write what came of a case, once; it is on the disk when this returns."""
        result = None if done.result is None else canonical(done.result)
        row = (done.key, result, done.error, _digest(done.key, result, done.error))
        with self._said():
            self._database.execute("INSERT OR IGNORE INTO cases VALUES (?, ?, ?, ?)", row)

    def all(self) -> dict[str, Done]:
        """Return what came of every case that is there, by its key."""
        with self._said():
            rows = self._database.execute("SELECT key, result, error, digest FROM cases").fetchall()
        return {str(key): self._done(key, found, error, digest) for key, found, error, digest in rows}

    def _done(self, key: object, found: object, error: object, digest: object) -> Done:
        match key, found, error:
            case (str(), None | str(), str()) if digest != _digest(key, found, error):
                what = "The result of the case {key!r:.60} is not the one that was kept: somebody or a disk changed it"
                raise StudyError(what, self._taken_out(digest), self.path, key=key)
            case (str(), None, str()):
                return Done(key, None, error)
            case (str(), str(), str()) if isinstance(result := _read(found), dict):
                if all(map(_is_figure, result.values())):
                    return Done(key, result, error)
        raise StudyError("The result of the case {key!r:.60} cannot be read", _DAMAGED, self.path, key=key)

    def _taken_out(self, digest: object) -> str:
        """Return how a row is taken out by its digest, so that its case is worked on again."""
        if not isinstance(digest, str) or not digest.isalnum():
            return said(_DAMAGED)
        command = f"""sqlite3 {shlex.quote(str(self.path))} "DELETE FROM cases WHERE digest = '{digest}'\""""
        return said("Take it out by `{command}`; --resume works on that case again", command=command)

    @contextmanager
    def _said(self) -> Iterator[None]:
        """Say what is wrong with the database as a failure of ours."""
        try:
            yield
        except (sqlite3.Error, UnicodeDecodeError) as fault:  # sqlite3 may quote what is there in its own words
            if isinstance(fault, sqlite3.OperationalError):
                remedy = "See the room and the rights on the disk, then go on with --resume"
                raise StudyError("The results cannot be written: {reason}", remedy, self.path, reason=fault) from None
            raise StudyError("The results cannot be read: {reason}", _DAMAGED, self.path, reason=fault) from None

    def close(self) -> None:
        """Close the database, and let others work in its folder."""
        self._held.close()


def _digest(key: str, result: str | None, error: str) -> str:
    """Return the SHA-256 of a row, by which it is seen that it was changed."""
    return hashlib.sha256(canonical([key, result, error]).encode()).hexdigest()


def _read(text: object) -> object:
    """Return what a JSON text says; None where it is none."""
    try:
        return json.loads(text) if isinstance(text, str) else None
    except (ValueError, RecursionError):
        return None


def _is_figure(value: object) -> bool:
    """Whether a value can be one cell of the table."""
    return value is None or isinstance(value, str) or (isinstance(value, int | float) and abs(value) <= _MOST)


@contextmanager
def _held(folder: Path) -> Iterator[None]:
    """Work in a folder alone; raises StudyError where another process does."""
    handle = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        with ExitStack() as stack:
            try:
                stack.enter_context(alone(handle, 0.0))
            except HeldError:
                what = "Another process works on the study in this folder"
                raise StudyError(what, "Wait for its end, or name another --out", folder) from None
            yield
    finally:
        os.close(handle)


Watch = Callable[[int, int], None]
"""How many are done, of how many that were missing."""


class Ran(NamedTuple):
    """there : cases that were there before; computed : now; failed : of all"""

    there: int
    computed: int
    failed: int


def run_missing(
    results: Results,
    items: Iterable[WorkItem],
    count: int,
    solve: Solve,
    engine: Engine,
    watch: Watch = lambda done, of: None,
) -> Ran:
    """Work on all items that have no result yet, and keep what comes of them; each is on the disk at once.

    count : of all items.  Raises StudyError, SchedulerError, KeyboardInterrupt; what was kept is kept.
    """
    there = results.keys()
    missing, done = count - len(there), 0
    left = (item for item in items if item.key not in there)
    first = next(left, None)
    if first is not None:  # an engine takes seconds to begin
        watch(0, missing)
        with closing(engine(solve, chain([first], left))) as coming:
            for found in coming:
                results.keep(found)
                done += 1
                watch(done, missing)
    failed = sum(found.result is None for found in results.all().values())
    return Ran(len(there), done, failed)


def rows_of(study: Study, found: Mapping[str, Done]) -> list[Row]:
    """Return a row for each case that has a result or an error."""
    rows = list[Row]()
    for choices in study.ways():
        for machine in range(study.machines):
            done = found.get(key_of(choices, machine))
            if done is not None:
                result = done.result or {}
                row: Row = {"machine": machine} | {key: _cell(value) for key, value in choices.items()}
                row |= {FIGURES[name].column: result.get(FIGURES[name].column) for name in study.keep}
                rows.append({**row, "error": done.error})
    return rows


def _cell(value: Any) -> Any:
    """Return a value of the grid as one cell of a table has it."""
    return value if isinstance(value, str | int | float | bool) else canonical(value)


def write_table(folder: Path, rows: list[Row]) -> Path:
    """Write cases.parquet where pyarrow is installed, else cases.csv, and return the file; raises OSError."""
    if find_spec("pyarrow") is not None:
        return _parquet(folder / "cases.parquet", rows)
    path, text = folder / "cases.csv", io.StringIO()
    table = csv.DictWriter(text, list(rows[0]) if rows else [], lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    write_whole(path, text.getvalue().encode())
    return path


def _parquet(path: Path, rows: list[Row]) -> Path:
    import pyarrow
    import pyarrow.parquet

    columns = {name: _column([row[name] for row in rows]) for name in (rows[0] if rows else [])}
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(pyarrow.table(columns), sink)
    write_whole(path, sink.getvalue().to_pybytes())
    return path


def _column(values: list[Any]) -> list[Any]:
    """Return values of one type: as text where a grid mixes types."""
    kinds = {type(value) for value in values if value is not None}
    if len(kinds) <= 1:
        return values
    if kinds == {int, float}:
        return [None if value is None else float(value) for value in values]
    return [None if value is None else str(value) for value in values]
