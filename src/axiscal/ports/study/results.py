"""The results of a study: a line of JSON for each case, written by one process alone, until nothing is missing.

A line carries its SHA-256. One that is torn or was changed is no result, and its case is worked on again.

Work in processes of this computer, each with one thread; one that is killed is replaced, and nothing is lost.
"""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import signal
from collections import Counter
from collections.abc import Generator, Iterable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager, suppress
from itertools import chain, islice
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, NamedTuple

from axiscal.document.durable import Closing, HeldError, alone, sync, write_at, write_whole
from axiscal.document.file import json_or_none
from axiscal.exceptions import StudyError
from axiscal.language.stages import staged
from axiscal.measurement.readers.csv_table import csv_text
from axiscal.numerics.threads import one_thread
from axiscal.ports.study.study_case import FIGURES, Done, Engine, Solve, WorkItem, answered, canonical, key_of
from axiscal.ports.study.study_file import Study

_TRIES = 4
"""Processes that one question may bring to their end before it is given up: the first and three more."""


def _work(solve: Solve, pipe: Connection) -> None:
    """Answer questions until the head is gone; Ctrl-C is its business."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    pipe.send(None)
    with one_thread(), suppress(EOFError, OSError):
        while True:
            pipe.send(answered(solve, pipe.recv()))


def _begun(solve: Solve) -> tuple[BaseProcess, Connection]:
    """Return a new process that works, and the pipe to it; raises StudyError where it ends before it begins."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(solve, theirs), daemon=True)
    process.start()
    theirs.close()
    try:
        ours.recv()
    except EOFError:
        what = "a process that should work on cases ended before it began"
        raise StudyError(what, "See whether memory is left, or work in this process with --workers 1") from None
    return process, ours


class Processes:
    """An engine of so many processes."""

    def __init__(self, count: int) -> None:
        self._count = count

    def __call__(self, solve: Solve, questions: Iterable[WorkItem]) -> Generator[Done]:
        """Yield what comes of questions; raises StudyError where no process can be started."""
        waiting, tried, working = iter(questions), Counter[str](), list[BaseProcess]()
        running = dict[Connection, WorkItem]()

        def asked(pipe: Connection | None, question: WorkItem) -> None:
            """Let a process work on a question, a new one where there is none."""
            if pipe is None:
                process, pipe = _begun(solve)
                working.append(process)
            running[pipe] = question
            with suppress(OSError):  # of one that was killed while it had nothing to do its pipe tells next
                pipe.send(question)

        try:
            for question in islice(waiting, self._count):
                asked(None, question)
            while running:
                for pipe in wait(list(running)):
                    assert isinstance(pipe, Connection)
                    question = running.pop(pipe)
                    again, found = _come(pipe, question, tried)
                    if (coming := question if found is None else next(waiting, None)) is not None:
                        asked(pipe if again else None, coming)
                    if found is not None:
                        yield found
        finally:
            for process in working:
                process.terminate()
                process.join()


def _come(pipe: Connection, question: WorkItem, tried: Counter[str]) -> tuple[bool, Done | None]:
    """Return whether the process is still there, and what came of its question: None where it is to be tried again."""
    try:
        done: Done = pipe.recv()
        return True, done
    except (EOFError, OSError):
        tried[question.key] += 1
        if tried[question.key] < _TRIES:
            return False, None
        return False, Done(question.key, None, f"the process that worked on it ended without a word, {_TRIES} times")


Row = dict[str, Any]

FILE, _LOCK = "cases.jsonl", ".study.lock"


class Results(Closing):
    """The open results of a folder; a context manager.

    digest : of all that the cases are a function of; versions : of the programs
    found : what came of every case that is there, by its key
    """

    def __init__(self, folder: Path, text: str, digest: str, versions: Mapping[str, str], resume: bool) -> None:
        self.path, self.found = folder / FILE, dict[str, Done]()
        self._held = ExitStack()
        try:
            with self._refusing("The results cannot be read: {reason}"):
                folder.mkdir(parents=True, exist_ok=True)
                self._held.enter_context(_held(folder))
                if not self.path.exists():
                    begun = {"digest": digest, "text": text, "versions": dict(versions)}
                    write_whole(self.path, _line(begun))
                content = self.path.read_bytes()
            *lines, _ = content.split(b"\n")
            self.found = {done.key: done for done in map(_done, reversed(lines[1:])) if done is not None}
            self._refuse_other(lines[0] if lines else b"", digest, versions, resume)
            self._end = content.rfind(b"\n") + 1  # behind it stands what an end of power or room has torn
            with self._refusing("The results cannot be written: {reason}"):
                self._file = self._held.enter_context(self.path.open("r+b", buffering=0)).fileno()
        except BaseException:
            self._held.close()
            raise

    def _refuse_other(self, first: bytes, digest: str, versions: Mapping[str, str], resume: bool) -> None:
        """Raise StudyError for results that are not of this study, or where nobody said to go on with them."""
        match json_or_none(first):
            case {"digest": of, "versions": {"axiscal": by}}:
                pass
            case _:
                remedy = "Name another folder"
                raise StudyError("It cannot be read of which study these results are", remedy, self.path)
        if not resume and self.found:
            remedy = "Go on with it by --resume, or name another --out"
            raise StudyError("This folder holds a study already", remedy, self.path)
        if of != digest:
            what = "The study, its campaign or its machine has been changed since these results were begun"
            raise StudyError(what, "Take the changes back, or name another --out", self.path)
        if by != versions["axiscal"]:
            what = "These results were begun with axiscal {first}, and this is {own}"
            remedy = "Go on with that version, or name another --out"
            raise StudyError(what, remedy, self.path, first=by, own=versions["axiscal"])

    def keep(self, done: Done) -> None:
        """Write what came of a case, once; it is on the disk when this returns."""
        if done.key in self.found:
            return
        line = _line({**done._asdict(), "sha256": _digest(done)})
        with self._refusing("The results cannot be written: {reason}"):
            os.ftruncate(self._file, self._end)
            write_at(self._file, self._end, line)
            sync(self._file)
        self._end += len(line)
        self.found[done.key] = done

    @contextmanager
    def _refusing(self, what: str) -> Iterator[None]:
        """Say what the disk did as a failure of ours."""
        try:
            yield
        except OSError as fault:
            remedy = "See the room and the rights on the disk, then go on with --resume"
            raise StudyError(what, remedy, self.path, reason=fault.strerror or fault) from None

    def close(self) -> None:
        """Close the file, and let others work in its folder."""
        self._held.close()


def _line(value: Any) -> bytes:
    return f"{canonical(value)}\n".encode(errors="backslashreplace")


def _digest(done: Done) -> str:
    return hashlib.sha256(_line([*done])).hexdigest()


def _done(line: bytes) -> Done | None:
    """Return the result in a line; None where it is not as it was written."""
    match json_or_none(line):
        case {"key": str() as key, "result": None | dict() as result, "error": str() as error, "sha256": digest}:
            done = Done(key, result, error)
            with suppress(ValueError):  # a number that JSON does not have
                return done if digest == _digest(done) else None
    return None


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
) -> Ran:
    """Work on all items that have no result yet, and keep what comes of them; each is on the disk at once.

    count : of all items.  Raises StudyError, KeyboardInterrupt; what was kept is kept.
    """
    there = set(results.found)
    missing, done = count - len(there), 0
    left = (item for item in items if item.key not in there)
    first = next(left, None)
    if first is not None:  # an engine takes seconds to begin
        with closing(engine(solve, chain([first], left))) as coming:
            for found in staged("cases", coming, missing):
                results.keep(found)
                done += 1
    failed = sum(found.result is None for found in results.found.values())
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
                row |= {FIGURES[name].column: result.get(FIGURES[name].column) for name in FIGURES}
                rows.append({**row, "error": done.error})
    return rows


def _cell(value: Any) -> Any:
    """Return a value of the grid as one cell of a table has it."""
    return value if isinstance(value, str | int | float | bool) else canonical(value)


def write_table(folder: Path, rows: list[Row]) -> Path:
    """Write cases.csv and return the file; raises OSError."""
    path, heads = folder / "cases.csv", list(rows[0]) if rows else []
    cells = [["" if value is None else str(value) for value in row.values()] for row in rows]
    write_whole(path, csv_text([heads, *cells]).encode())
    return path
