"""The campaign record: one file to which lines are only ever appended, and the one door to it.

A reading is acknowledged when `Record.append` returns. By then it is on the disk, in this file and in no other, and
outlives the process and the power. How the file is made: `lines`.

Nobody leases a record. Who writes appends, reads back from there on, and is told where somebody else came first: two
lines of one number are a branch, which is named until `repair` has asked what becomes of it.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import uuid
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Self

from axiscal.document.durable import alone, clear_drafts, read_at, sync, write_at, write_whole
from axiscal.exceptions import OvertakenError, RecordError
from axiscal.language.spoken import said
from axiscal.record.door import ALL, BINARY, opened, record_errors, refuse_other_form, repairing
from axiscal.record.earlier import told_anew
from axiscal.record.events import Created, Event, EventOrderError, State, Stored, fold
from axiscal.record.lines import (
    EMPTY,
    HEAD,
    SLOTS,
    DamageError,
    EventText,
    KeptLine,
    chained,
    count_bytes,
    counts,
    entry,
    head,
    is_earlier,
    whole_lines,
)
from axiscal.record.payload import PayloadError, stored
from axiscal.record.signing import SignedUntil, hand_of, rows_of, signed_row, signed_until

PATIENCE = 4.0
"""Seconds to wait for another process that is writing."""


class Record(contextlib.AbstractContextManager["Record"]):
    """An open campaign record; a context manager. Every failure is a RecordError that names the file.

    path : as people name it; lines : all that have been read
    name : of what they hold: a hash chained over the contents of events, 64 hex digits
    """

    def __init__(self, path: Path, *, write: bool = True) -> None:
        self.path, self._file, self._write = path, path.absolute(), write
        self.lines, self.name = list[KeptLine](), EMPTY
        self._events, self._state = list[Stored](), State()
        self._end, self._earlier, self._writer = HEAD, -1, uuid.uuid4().hex[:16]

    @classmethod
    def create(cls, path: str | Path, created: Created) -> Self:
        """Return a new record that holds the event `created`; the file appears whole and checked, or not at all."""
        return cls.made(path, content_of(rows_of([created])))

    @classmethod
    def made(cls, path: str | Path, content: bytes, like: Path | None = None) -> Self:
        """Return a new record of the content of a file; raises RecordError where there is a file.

        like : a file whose permissions it gets
        """
        path = Path(path)
        with record_errors(path):
            cls(path)._follow(content[:HEAD], content[HEAD:])
            write_whole(path, content, new=True, like=like)
        return cls.open(path)

    @classmethod
    def open(cls, path: str | Path, *, write: bool = True, changed: bool = False) -> Self:
        """Return an existing record, checked: its kind, its form, every event, every signature.

        changed : also one that was changed since somebody signed it.  Only what writes may be kept waiting
        """
        record = cls(Path(path), write=write)
        with record_errors(record.path):
            if write:
                clear_drafts(record.path.parent, record.path.name)
                if record.path.is_file():
                    os.close(os.open(record.path, os.O_RDWR))
            record._catch_up()
        signed = None if changed else record.signed()
        if signed is not None and not signed.holds:
            what = "The record was changed since {person} signed it at event {number}"
            remedy = "Go on with a copy of before; tools/check_record.py says what was changed"
            raise RecordError(what, remedy, record.path, person=signed.person, number=signed.number)
        return record

    def append(self, *events: Event, after: int | None = None) -> int:
        """Keep `events`, all or none, and return the number of the last one.

        after : number of the last event the caller knows of; OvertakenError if another one has written since
        Raises ValueError for an event that cannot be kept.
        """
        return self._extend(rows_of(events), after)

    def _extend(self, rows: Sequence[EventText], after: int | None) -> int:
        if not self._write:
            raise RecordError("The record was opened to be read", "Open it to write", self.path)
        with record_errors(self.path):
            if self._earlier >= 0:
                self._bring()
            with self._held() as handle:
                self._catch_up()
                if after is not None and len(self.lines) != after:
                    what = "Another process has written to this record in the meantime"
                    remedy = "Look at it with `axiscal step status`, then give the command again"
                    raise OvertakenError(what, remedy, self.path)
                try:
                    fold((stored(number, row) for number, row in enumerate(rows, len(self.lines) + 1)), self._state)
                except EventOrderError as error:
                    what = "This cannot follow what the record holds: {error}"
                    remedy = "Look at it with `axiscal step status`; nothing was written"
                    raise RecordError(what, remedy, self.path, error=error) from error
                if rows:
                    self._add(handle, rows)
        return len(self.lines)

    def _add(self, handle: int, rows: Sequence[EventText]) -> None:
        added = entry(rows, self.campaign, self._writer, len(self.lines), self.lines[-1].hash)
        content = b"".join(line.written() for line in added)
        size = os.fstat(handle).st_size
        if read_at(handle, size - 1, 1) != b"\n":
            content = b"\n" + content  # behind what nobody has finished writing
        try:
            write_at(handle, size, content)
            sync(handle)
        except OSError:  # whole lines would count, and these are not acknowledged
            with contextlib.suppress(OSError):
                if os.fstat(handle).st_size <= size + len(content):
                    os.ftruncate(handle, size)
            raise
        self._catch_up()
        if self.lines[-1].hash != added[-1].hash:
            what = "Another computer has written at the same place, and the entry is not kept"
            raise RecordError(what, "Give the command again", self.path)
        anew = os.open(self._file, os.O_RDWR | BINARY)
        try:
            least = [-1 if each is None else each for each in counts(read_at(anew, 0, HEAD))]
            write_at(anew, SLOTS[least[0] > least[1]], count_bytes(len(self.lines)))
        finally:
            os.close(anew)

    def sign(self) -> bool:
        """Let this person answer for all events so far, and return whether; not without a key, nor twice.

        Raises OvertakenError if another process writes meanwhile.
        """
        self.last()
        if (row := signed_row(self.rows)) is None:
            return False
        self._extend([row], after=len(self.lines))
        return True

    def signed(self) -> SignedUntil | None:
        """Return what vouches for the record: its last signature, or the first that does not hold; None for nobody."""
        return signed_until(self.events(), self.rows)

    @property
    def campaign(self) -> str:
        """The id of the campaign, drawn once."""
        return self.lines[0].campaign

    @property
    def rows(self) -> list[EventText]:
        """All events that have been read, as they were written."""
        return [line.row for line in self.lines]

    def last(self) -> int:
        """Take in what others have written since, and return the number of the last event."""
        with record_errors(self.path):
            self._catch_up()
        return len(self.lines)

    def events(self) -> tuple[Stored, ...]:
        """Return all events, oldest first."""
        self.last()
        return tuple(self._events)

    def state(self) -> State:
        """Return the state folded from all events."""
        self.last()
        return replace(self._state, name=self.name)

    def copy_to(self, path: Path) -> None:
        """Write a copy, in the place of an earlier copy if there is one; raises as `refuse_other`."""
        self.refuse_other(path)
        if not self._is(path):
            with record_errors(path):
                write_whole(path, content_of_lines(self.lines))

    def refuse_other(self, path: Path) -> None:
        """Raise RecordError if there is something at `path` that is more than this record or an earlier copy of it."""
        if not path.exists() or self._is(path):
            return
        try:
            there, why = Record.open(path, write=False), said("it is no earlier copy of this record")
            if there.campaign == self.campaign and there.rows == self.rows[: len(there.rows)]:
                return
        except RecordError as failure:
            why = failure.what
        what = "A file with the name of the record is here already: {why}"
        raise RecordError(what, "Name another folder, or move it away", path, why=why)

    def _is(self, path: Path) -> bool:
        return path.exists() and self.path.exists() and path.samefile(self.path)

    def close(self) -> None:
        """Write no more; what was appended is safe without it."""
        self._write = False

    def __exit__(self, *_: object) -> None:
        self.close()

    @contextlib.contextmanager
    def _held(self) -> Iterator[int]:
        """Yield the file, opened to append, which nobody else writes to where the system has locks."""
        while True:
            handle = os.open(self._file, os.O_RDWR | os.O_APPEND | BINARY)
            try:
                with alone(handle, PATIENCE):
                    if os.path.samestat(os.fstat(handle), os.stat(self._file)):  # nobody has brought it meanwhile
                        yield handle
                        return
            finally:
                os.close(handle)

    def _bring(self) -> None:
        """Write a record of an earlier form anew in this one, and keep the old one beside it."""
        content = self._file.read_bytes()
        if not is_earlier(content):
            return
        self._catch_up()
        kept = self._file.with_name(f"{self.path.name}.{hashlib.sha256(content).hexdigest()[:8]}.before")
        with contextlib.suppress(FileExistsError):
            write_whole(kept, content, new=True, like=self._file)
        handle = os.open(kept, os.O_RDWR | BINARY)
        try:
            with alone(handle, PATIENCE):  # one brings it; the record itself is closed: Windows replaces no open file
                if self._file.read_bytes() == content:
                    write_whole(self._file, told_anew(content))
        finally:
            os.close(handle)

    def _catch_up(self) -> None:
        """Take over what has been written since the last look, as the file has it when it is opened anew."""
        self._follow(*self._read())

    def _follow(self, block: bytes, behind: bytes) -> None:
        """Take over entries that are whole; raises DamageError.  block : the head; behind : the lines not read yet"""
        known = [each for each in counts(block) if each is not None]
        if not known:
            raise DamageError("neither of the two counts of its events can be read")
        waiting, start = list[KeptLine](), self._end
        for line, end in whole_lines(behind):
            if waiting and not (line.last == waiting[0].last and line.follows(waiting[-1])):
                waiting = []  # an entry that nobody has finished
            if not line.follows([None, *self.lines[-1:], *waiting[-1:]][-1]):
                self._refuse_unknown(line)
                continue
            waiting.append(line)
            if line.number == line.last:
                self.lines += waiting
                waiting, self._end = [], start + end
        self._take()
        if len(self.lines) < max(1, *known):
            raise DamageError(f"it ends at event {len(self.lines)} and should end at event {max(1, *known)}")

    def _read(self) -> tuple[bytes, bytes]:
        """Return the head, and what stands behind the last line that was read."""
        handle = opened(self._file, self.path)
        try:
            block, size = read_at(handle, 0, HEAD), os.fstat(handle).st_size
            if is_earlier(block):
                if size == self._earlier:
                    return head(0), b""
                self._earlier, content = size, told_anew(read_at(handle, 0, ALL))
                return content[:HEAD], content[self._end :]
            self._earlier = -1
            refuse_other_form(block, handle, self.path)
            if size < self._end:
                raise DamageError("an older copy has been written over it")
            return block, read_at(handle, self._end, ALL)
        finally:
            os.close(handle)

    def _refuse_unknown(self, line: KeptLine) -> None:
        """Raise DamageError, RecordError of a branch, for a line that does not follow and is not there already."""
        there = self.lines[line.number - 1] if line.number <= len(self.lines) else None
        if there.hash == line.hash if there is not None else line.first == len(self.lines) + 1:
            return  # it stands there twice, or is what is left of an entry that nobody has finished
        if there is None or line.campaign != there.campaign:
            raise DamageError(f"whole lines stand behind event {len(self.lines)} and do not follow from it")
        what = "Two went on from event {number}: {one}, and {other}"
        remedy = said("Ask what becomes of both: {command}", command=repairing(self.path))
        one, other = said_hand(there.row), said_hand(line.row)
        raise RecordError(what, remedy, self.path, number=line.number - 1, one=one, other=other)

    def _take(self) -> None:
        """Fold the events of lines that are new."""

        def told() -> Iterator[Stored]:
            for line in self.lines[len(self._events) :]:
                yield (each := stored(line.number, line.row))
                self._events.append(each)
                self.name = chained(self.name, line.row)

        try:
            self._state = fold(told(), self._state)
        except (PayloadError, EventOrderError) as error:
            raise DamageError(f"event {len(self._events) + 1}: {error}") from error


def said_hand(row: EventText) -> str:
    """Return who wrote an event, and when, in words."""
    person, computer = (name or "?" for name in hand_of(row))
    return said("{person} on {computer}, {at}", person=person, computer=computer, at=row.at[:16])


def content_of(rows: Sequence[EventText], campaign: str = "") -> bytes:
    """Return the file of a record that holds these events, by default of a campaign of its own."""
    made = entry(rows, campaign or uuid.uuid4().hex, uuid.uuid4().hex[:16])
    return content_of_lines(made)


def content_of_lines(lines: Sequence[KeptLine]) -> bytes:
    """Return the file of a record that holds these lines."""
    return head(len(lines)) + b"".join(line.written() for line in lines)
