"""The campaign record: one file to which events are only ever appended.

A reading is acknowledged when `Record.append` returns. By then it is on the disk, in this file and in no other, and
outlives the process and the power. How the file is made: `line_form`.
"""

from __future__ import annotations

import contextlib
import errno
import gc
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Self

from axiscal.document.durable import (
    HeldError,
    alone,
    clear_drafts,
    draft_of,
    read_at,
    sync,
    sync_folder,
    write_at,
    written,
)
from axiscal.exceptions import NewerError, RecordError
from axiscal.language.spoken import said
from axiscal.record.events import Created
from axiscal.record.lease import leave, take
from axiscal.record.line_form import (
    BLOCK,
    FORM,
    HEADS,
    MARK,
    MARKS,
    MOST_TORN,
    START,
    DamageError,
    EventText,
    Mark,
    form_of,
    head,
    is_torn,
    mark_bytes,
    read_mark,
    rows_after,
    taken_for_text,
    transaction,
    whole_after,
)
from axiscal.record.log import ChainedText, EventLog, in_one, refuse_changed, refuse_overtaken, rows_of

PATIENCE = 4.0
"""Seconds to wait for another process that is writing."""
_CLOSED = -1
"""No handle of any file."""


class Record(EventLog):
    """An open campaign record; a context manager. Every failure is a RecordError that names the file."""

    def __init__(self, path: Path, handle: int, *, write: bool = True) -> None:
        super().__init__(path)
        self._handle, self._write = handle, write
        self._mark, self._older, self._turn = Mark(), MARKS[0], 0
        self._leased = False

    @classmethod
    def create(cls, path: str | Path, created: Created) -> Self:
        """Return a new record that holds the event `created`; the file appears whole and checked, or not at all."""
        return cls.made(path, rows_of([created]))

    @classmethod
    def made(cls, path: str | Path, rows: Sequence[EventText]) -> Self:
        """Return a new record of events as they were written elsewhere; raises RecordError where there is a file."""
        path = Path(path)
        clear_drafts(path.parent, path.name)
        refuse_existing(path)
        draft = draft_of(path)
        with record_errors(path):
            try:
                written(draft, content_of(in_one(rows))[0])
                cls.open(draft, write=False).close()
                _publish(draft, path)
            finally:
                with contextlib.suppress(OSError):
                    draft.unlink(missing_ok=True)
        return cls.open(path)

    @classmethod
    def open(cls, path: str | Path, *, write: bool = True) -> Self:
        """Return an existing record, checked: its kind, its form, every event. Only what writes may be kept waiting."""
        path = Path(path)
        with record_errors(path):
            if write:
                clear_drafts(path.parent, path.name)
            _refuse_other_form(path)
            handle = os.open(path, (os.O_RDWR if write else os.O_RDONLY) | getattr(os, "O_BINARY", 0))
            record = cls(path, handle, write=write)
            collecting = gc.isenabled()
            gc.disable()  # events are no garbage, and there may be a hundred thousand
            try:
                record._catch_up()
            except BaseException:
                record.close()
                raise
            finally:
                if collecting:
                    gc.enable()
            return record

    @property
    def name(self) -> str:
        """The name of what the record holds: a hash chained over the contents of its events, 64 hex digits."""
        return self._mark.chain

    def extend(self, rows: Sequence[EventText], after: int | None = None) -> int:
        """Write events as they were written elsewhere, in one transaction; else as `append`."""
        handle = self._handle
        if handle == _CLOSED or not self._write:
            raise RecordError("The record was opened to be read", "Open it to write", self.path)
        with record_errors(self.path):
            if self.path.exists() and take(self.path):
                self._open_anew()
            self._leased = True
        with record_errors(self.path), alone(handle, PATIENCE):
            if not (self.path.exists() and os.path.samestat(os.fstat(handle), os.stat(self.path))):
                what = "The record is no longer here: it was moved, or another file was put in its place"
                remedy = "Put it back, then give the command again; what was acknowledged is in it"
                raise RecordError(what, remedy, self.path)
            self._catch_up()
            refuse_overtaken(self._mark.last, after, self.path)
            if rows:
                rows = in_one(rows)
                content, mark = transaction(self._mark, rows)
                story = self._story.then(rows, self.path)
                other = MARKS[self._older == MARKS[0]]
                newest = read_at(handle, other, MARK)
                try:
                    os.ftruncate(handle, self._mark.end)
                    write_at(handle, self._mark.end, content)
                    sync(handle)
                except OSError:  # whole lines would count, and these are not acknowledged
                    with contextlib.suppress(OSError):
                        os.ftruncate(handle, self._mark.end)
                    raise
                write_at(handle, self._older, mark_bytes(mark))
                sync(handle)
                stands = {self._mark.end: content, self._older: mark_bytes(mark), other: newest}
                if any(self._read_back(at, len(text)) != text for at, text in stands.items()):
                    raise self._branched(rows, mark)
                self._older, self._turn = other, mark.turn
                self._mark, self._story = mark, story
        return self._mark.last

    def _open_anew(self) -> None:
        """Let go of what the system remembers of the file: another computer may have written to it."""
        anew = os.open(self.path, os.O_RDWR | getattr(os, "O_BINARY", 0))
        if os.path.samestat(os.fstat(anew), os.fstat(self._handle)):
            os.dup2(anew, self._handle)
        os.close(anew)

    def _read_back(self, at: int, size: int) -> bytes:
        """Return what another opening of the file sees."""
        anew = os.open(self.path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        try:
            return read_at(anew, at, size)
        finally:
            os.close(anew)

    def _branched(self, rows: Sequence[EventText], mark: Mark) -> RecordError:
        """Keep events beside a record that another computer writes to at the same place; return what to say."""
        before = rows_after(Mark(), self._read_back(START, self._mark.end - START))
        branch = self.path.with_name(f"{self.path.stem}-{mark.chain[:8]}.axiscal")
        Record.made(branch, [*(row for row, _ in before), *rows]).close()
        what = "Another computer has written at the same place; what was to be written is in {branch}"
        remedy = "Let one computer write at a time. Record the readings of {branch} here"
        return RecordError(what, remedy, self.path, branch=branch)

    def last(self) -> int:
        """Return the number of the last event, 0 if there is none."""
        with record_errors(self.path):
            self._catch_up()
        return self._mark.last

    def texts(self) -> tuple[ChainedText, ...]:
        """Return all events as they were written."""
        self.last()
        with record_errors(self.path):
            content = read_at(self._handle, START, self._mark.end - START)
            return tuple(ChainedText(row, mark.chain) for row, mark in rows_after(Mark(), content))

    def close(self) -> None:
        """Close the file; what was appended is safe without it."""
        if self._handle != _CLOSED:
            if self._leased:
                leave(self.path)
            os.close(self._handle)
            self._handle = _CLOSED

    def _catch_up(self) -> None:
        """Take over what has been written since the last look."""
        marks = {at: read_mark(read_at(self._handle, at, MARK)) for at in MARKS}
        whole = {at: mark for at, mark in marks.items() if isinstance(mark, Mark)}
        if not whole:
            raise DamageError("neither of the two marks of its end can be read")
        newest = max(whole, key=lambda at: whole[at].turn)
        self._older = MARKS[newest == MARKS[0]]
        mark = whole[newest]
        if mark.turn < self._turn and None not in marks.values():
            raise DamageError("an older copy has been written over it")
        self._turn = mark.turn
        if mark.turn == self._mark.turn and mark != self._mark:
            raise DamageError("another record has been written over it")
        if mark.turn > self._mark.turn:
            content = read_at(self._handle, self._mark.end, mark.end - self._mark.end)
            rows = list(rows_after(self._mark, content))
            if not rows or rows[-1][1] != mark:
                ends = self._mark.last + len(rows)
                if ends == mark.last:
                    raise DamageError(f"the mark of its end is not that of event {ends}")
                raise DamageError(f"it ends at event {ends} and should end at event {mark.last}")
            self._take(rows)
        if os.fstat(self._handle).st_size < self._mark.end:
            raise DamageError(f"it ends before event {self._mark.last}")
        end, behind = self._mark.end, read_at(self._handle, self._mark.end, MOST_TORN)
        self._take(whole_after(self._mark, behind))
        if not is_torn(self._mark, behind[self._mark.end - end :]):
            raise DamageError(f"whole lines stand behind event {self._mark.last} and do not follow from it")

    def _take(self, rows: Iterable[tuple[EventText, Mark]]) -> None:
        for row, mark in rows:
            self._story.happened(mark.last, row)
            self._mark = mark


def opened_log(path: str | Path, *, write: bool = True, changed: bool = False) -> Record:
    """Return the log of an existing record, checked; raises RecordError.

    changed : also where it was changed since somebody signed it
    """
    log = Record.open(path, write=write)
    try:
        if not changed:
            refuse_changed(log)
    except BaseException:
        log.close()
        raise
    return log


def refuse_existing(path: Path) -> None:
    """Raise RecordError if there is something at `path` already."""
    if path.exists():
        remedy = "Go on with it by `axiscal step next`, or name another file for the record"
        raise RecordError("This file exists already", remedy, path)


def content_of(rows: Sequence[EventText]) -> tuple[bytes, Mark]:
    """Return the file of a record that holds these events, and its mark."""
    lines, mark = transaction(Mark(), rows)
    blocks = mark_bytes(mark).ljust(BLOCK - 1) + b"\n" + (BLOCK - 1) * b" " + b"\n"
    return head() + blocks + lines, mark


def _publish(draft: Path, path: Path) -> None:
    try:
        os.link(draft, path)
    except FileExistsError:
        refuse_existing(path)
    except OSError:  # a file system without hard links
        refuse_existing(path)
        draft.rename(path)
    sync_folder(path.parent)


def _refuse_other_form(path: Path) -> None:
    """Raise RecordError for a file that is no record, or of a form to come."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise RecordError("This is a pipe or a device", "Name a record, which is a file", path)
    try:
        with path.open("rb") as file:
            start = file.read(START)
    except FileNotFoundError:
        raise RecordError("There is no such record", "Start one with `axiscal step start CAMPAIGN`", path) from None
    except IsADirectoryError:
        inside = next(iter(sorted(path.glob("*.axiscal"))), "a file *.axiscal")
        raise RecordError("This is a folder", "Name the record in it: {inside}", path, inside=inside) from None
    except OSError as error:
        remedy = "Name a file you may read"
        raise RecordError("The record cannot be opened: {strerror}", remedy, path, strerror=error.strerror) from error
    form = form_of(start)
    if form is not None and form > FORM:
        what = "This record was written by a newer axiscal (form {form}; this one knows {known})"
        remedy = "Install the newer version to go on with it; nothing was changed"
        raise NewerError(what, remedy, path, form=form, known=FORM)
    if start[:BLOCK] in HEADS:
        return
    if taken_for_text(start):
        raise DamageError("a program took it for text and changed line ends or blanks; salvage undoes that")
    if any(isinstance(read_mark(start[at:]), Mark) for at in MARKS):
        raise DamageError("its first lines are not as they were written")
    if start[:16] == b"SQLite format 3\0" and start[68:72] == b"AXIS":
        remedy = "Bring it into today's: python tools/bring_first_form.py RECORD NEW"
        raise RecordError("This record is of the first form, an SQLite database", remedy, path)
    remedy = "Name a record, a file *.axiscal; `axiscal step start CAMPAIGN` makes one"
    raise RecordError("This file is not a campaign record", remedy, path)


@contextlib.contextmanager
def record_errors(path: Path) -> Iterator[None]:
    """Turn what the file system or a foreign writer did into a RecordError."""
    try:
        yield
    except DamageError as error:
        raise RecordError("The record is damaged: {reason}", restoring(path), path, reason=error) from error
    except HeldError:
        remedy = "Close it or wait, then give the command again"
        raise RecordError("Another program holds this record and is writing", remedy, path) from None
    except OSError as error:
        if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOENT):
            what = "The record cannot be written here"
            remedy = "Put it in a folder that exists and that you may write to"
        else:
            what = "The disk did not take the entry ({reason})"
            remedy = "Make room; everything acknowledged before is kept"
        raise RecordError(what, remedy, path, reason=error.strerror or error) from error


def restoring(path: Path) -> str:
    """Return what to do about a damaged record."""
    left = said("the file has been left as it was")
    new = path.with_name(f"{path.stem}-salvaged.axiscal")
    command = f"axiscal data salvage {path} {new}"
    return said("Restore it from a copy, or save what stands whole: {command}; {left}", command=command, left=left)
