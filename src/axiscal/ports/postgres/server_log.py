"""The log of one campaign on a server: what `store.Record` is in a file.

A number is given once in a campaign, so of two writers that know the same last event one wins. A branch
holds what was measured elsewhere behind an event of another campaign: its log begins with that one's, up to there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import NamedTuple, Self

from axiscal.exceptions import OvertakenError, RecordError, UnreachableError
from axiscal.language.spoken import capital
from axiscal.ports.postgres.database import Database, not_known, opened_database
from axiscal.ports.postgres.tables import refuse_other
from axiscal.record.copies import Opened, refuse_unfit, unfit
from axiscal.record.events import Created
from axiscal.record.line_form import DamageError, EventText, chained
from axiscal.record.log import (
    EMPTY,
    STORED,
    ChainedText,
    EventLog,
    Story,
    campaign_of,
    chained_texts,
    refuse_overtaken,
    rows_of,
)

_FEWEST = 8
"""Digits of an id by which a campaign may be named, too."""
_SHOWN = 13
"""Digits of an id that are shown: enough to tell any two campaigns."""
_ENTRIES = "SELECT CAST(id AS text), name, CAST(branch_of AS text), branch_at FROM axiscal.campaigns"

_ENTER = """
SELECT axiscal.enter(CAST(:id AS uuid), :name, CAST(:branch_of AS uuid), CAST(:branch_at AS bigint),
    CAST(:kinds AS text[]), CAST(:payloads AS text[]), CAST(:times AS text[]), CAST(:digests AS text[]))
"""
_INSERT = """
SELECT axiscal.append(CAST(:id AS uuid), CAST(:last AS bigint), CAST(:kinds AS text[]),
    CAST(:payloads AS text[]), CAST(:times AS text[]), CAST(:digests AS text[]))
"""


class Entry(NamedTuple):
    """A campaign on the server: its id, the name people gave it, and where it branches off another one."""

    id: str
    name: str
    branch_of: str | None
    branch_at: int | None

    @property
    def called(self) -> str:
        """What people type for it: its name, or the id of a branch, whose name is that of another campaign."""
        return self.name if self.branch_of is None else self.id[:_SHOWN]


class ServerLog(EventLog):
    """The open log of one campaign on a server; a context manager. Every failure is a RecordError.

    path : "store:NAME", as people name it, and "store:ID" for a branch
    """

    def __init__(self, database: Database, entry: Entry, *, write: bool = True) -> None:
        super().__init__(Path(f"{STORED}{entry.called}"))
        self.entry, self._database, self._write = entry, database, write
        self._texts = list[ChainedText]()
        self._sources = [entry, *_ancestors(database, entry)]

    @classmethod
    def create(cls, database: Database, name: str, created: Created) -> Self:
        """Return a new campaign that holds the event `created`; raises RecordError where there is one of this name."""
        first = chained_texts(rows_of([created]))[0]
        entry = Entry(campaign_of(first), name, None, None)

        def begun() -> None:
            refuse_taken(database, entry, "go on with it by `axiscal step next`, or give the campaign another name")
            enter(database, entry, [first])

        with _closed_at_a_fault(database):
            refuse_other(database)
            database.transaction(begun)
            log = cls(database, entry)
            log.last()
        return log

    @classmethod
    def open(cls, database: Database, name: str, *, write: bool = True) -> Self:
        """Return the log of a campaign, by its name or the beginning of its id, checked; raises RecordError."""
        with _closed_at_a_fault(database):
            refuse_other(database)
            log = cls(database, only_entry(name, entries(database, name)), write=write)
            log.last()
        return log

    @property
    def name(self) -> str:
        """The name of what it holds: a hash chained over the contents of its events, 64 hex digits."""
        return self._texts[-1].chain if self._texts else EMPTY

    def extend(self, rows: Sequence[EventText], after: int | None = None) -> int:
        """Keep events as they were written elsewhere, in one transaction; else as `append`."""
        if not self._write:
            raise RecordError("The record was opened to be read", "Open it to write", self.path)
        return self._kept_at_once(rows, after) or self._kept_after_a_look(rows, after)

    def _kept_after_a_look(
        self, rows: Sequence[EventText], after: int | None, asked: Sequence[ChainedText] = ()
    ) -> int:
        """Keep events behind what is there by now and return the number of the last one.

        asked : the same, as the server went away with them: either they are there, or they can no longer come
        """
        known = len(self._texts)

        def kept() -> tuple[Story, Sequence[ChainedText]]:
            self._catch_up()
            there = self._texts[known : known + len(asked)]
            if asked and [(each.row.at, each.chain) for each in there] == [(e.row.at, e.chain) for e in asked]:
                return self._story, ()
            refuse_overtaken(len(self._texts), after, self.path)
            story = self._story.then(rows, self.path)
            texts = self._behind(rows)
            insert(self._database, self.entry.id, len(self._texts), texts)
            return story, texts

        self._story, texts = self._database.transaction(kept)
        self._texts += texts
        return len(self._texts)

    def _behind(self, rows: Sequence[EventText]) -> list[ChainedText]:
        return chained_texts((row._replace(closes=True) for row in rows), self.name)

    def _kept_at_once(self, rows: Sequence[EventText], after: int | None) -> int | None:
        """Keep events in one question to the server and return the number of the last one.

        The server takes them only behind the last event that is known here: None where that is no longer the last, or
        the question was not asked.
        """
        known = len(self._texts)
        if not rows or not known or after not in (None, known):
            return None
        try:
            story, texts = self._story.then(rows, self.path), self._behind(rows)
        except RecordError:  # it may follow what has been written since
            return None
        try:
            if not self._database.at_once(_INSERT, id=self.entry.id, last=known, **_columns(texts)):
                return None
        except OvertakenError:
            return None
        except UnreachableError as failure:
            try:
                return self._kept_after_a_look(rows, after, texts)
            except UnreachableError:
                raise not_known(failure) from None
        except RecordError:
            self._catch_up()  # where the store is damaged that is what is said
            raise
        self._texts += texts
        self._story = story
        return known + len(texts)

    def last(self) -> int:
        """Return the number of the last event."""
        self._catch_up()
        return len(self._texts)

    def texts(self) -> tuple[ChainedText, ...]:
        """Return all events as they were written."""
        self._catch_up()
        return tuple(self._texts)

    def close(self) -> None:
        """Close the connection."""
        self._database.close()

    def _catch_up(self) -> None:
        """Take over what has been written since the last look; raises RecordError where it does not follow."""
        try:
            for number, text in self._new():
                self._take(number, text)
        except DamageError as error:
            what = "The campaign in the store is damaged: {reason}"
            remedy = (
                "Tell whoever keeps the store: a backup has what was there, and this sets aside what cannot be: "
                "axiscal shop sync --quarantine {path}:{first}"
            )
            first = len(self._texts) + 1
            raise RecordError(what, remedy, self.path, reason=error, path=self.path, first=first) from error

    def _new(self) -> list[tuple[int, ChainedText]]:
        """Return the events behind those that are known, and the last one that is."""
        known, found = len(self._texts), list[tuple[int, ChainedText]]()
        until: int | None = None
        for source in self._sources:
            rows = self._database.select(
                "SELECT number, at, kind, payload, digest FROM axiscal.standing "
                "WHERE campaign = CAST(:id AS uuid) AND number >= :first AND number <= :until ORDER BY number",
                id=source.id,
                first=known,
                until=2**62 if until is None else until,
            )
            found = [
                (number, ChainedText(EventText(at, kind, payload), chain)) for number, at, kind, payload, chain in rows
            ] + found
            until = source.branch_at
        if known and (not found or found[0][0] != known):
            raise DamageError("an older state of the store has been put in its place")
        return found

    def _take(self, number: int, text: ChainedText) -> None:
        if number == len(self._texts):
            if text.chain != self.name:
                raise DamageError("another campaign has been put in its place")
            return
        if number != len(self._texts) + 1 or chained(self.name, text.row) != text.chain:
            raise DamageError(f"event {number} does not follow from the events before it")
        self._story.happened(number, text.row)
        self._texts.append(text)


@contextmanager
def _closed_at_a_fault(database: Database) -> Iterator[None]:
    try:
        yield
    except BaseException:
        database.close()
        raise


def entries(database: Database, name: str | None = None) -> list[Entry]:
    """Return the campaigns of a store: all, or those of a name or an id that begins so."""
    rows = database.select(
        f"{_ENTRIES} AS c WHERE EXISTS (SELECT FROM axiscal.events AS e WHERE e.campaign = c.id) "
        "AND (CAST(:name AS text) IS NULL OR name = :name "
        "OR (length(:name) >= :few AND starts_with(CAST(id AS text), :name))) "
        "ORDER BY name, id",
        name=name,
        few=_FEWEST,
    )
    return [Entry(*row) for row in rows]


def entry_of(database: Database, campaign: str) -> Entry | None:
    """Return the campaign of an id, None if the store has none."""
    rows = database.select(f"{_ENTRIES} WHERE id = CAST(:id AS uuid)", id=campaign)
    return Entry(*rows[0]) if rows else None


def refuse_taken(database: Database, entry: Entry, remedy: str) -> None:
    """Raise RecordError for a name that does not fit file systems, or that another campaign of the store has."""
    named = Path(f"{STORED}{entry.name}")
    refuse_unfit(entry.name, named)
    taken = "SELECT count(*) FROM axiscal.campaigns AS c WHERE branch_of IS NULL AND lower(name) = lower(:name) AND id "
    behind = "<> CAST(:id AS uuid) AND EXISTS (SELECT FROM axiscal.events AS e WHERE e.campaign = c.id)"
    if database.select(taken + behind, name=entry.name, id=entry.id)[0][0]:
        raise RecordError("The store has a campaign of this name already", capital(remedy), named)


def enter(database: Database, entry: Entry, texts: Sequence[ChainedText]) -> None:
    """Add a campaign with its first events to a store, within a transaction."""
    database.select(_ENTER, **entry._asdict() | _columns(texts))


def insert(database: Database, campaign: str, last: int, texts: Sequence[ChainedText]) -> None:
    """Add events behind the last one of a campaign, within a transaction."""
    if texts:
        database.select(_INSERT, id=campaign, last=last, **_columns(texts))


def _columns(texts: Sequence[ChainedText]) -> dict[str, object]:
    return {
        "kinds": [text.row.kind for text in texts],
        "payloads": [text.row.payload for text in texts],
        "times": [text.row.at for text in texts],
        "digests": [text.chain for text in texts],
    }


def _ancestors(database: Database, entry: Entry) -> list[Entry]:
    """Return the campaigns that a branch begins with, the nearest first."""
    found, above = list[Entry](), entry.branch_of
    while above is not None and (nearest := entry_of(database, above)) is not None:
        found.append(nearest)
        above = nearest.branch_of
    return found


def only_entry(name: str, found: Sequence[Entry]) -> Entry:
    path, found = Path(f"{STORED}{name}"), [each for each in found if each.called == name or each.id.startswith(name)]
    if not found:
        remedy = "Look at its name, or send it there: axiscal shop sync"
        raise RecordError("The store has no such campaign", remedy, path)
    if len(found) > 1:
        ids = ", ".join(entry.id[:_SHOWN] for entry in found)
        remedy = "Name one by its id: {known}"
        raise RecordError("The store has {found} campaigns of this name", remedy, path, found=len(found), known=ids)
    return found[0]


@contextmanager
def each_opened() -> Iterator[list[tuple[Path, Opened]]]:
    """Yield the campaigns of the named store, each with how it is opened to be read, all over one connection."""
    database = opened_database()
    try:
        refuse_other(database)
        there = entries(database)
        called = Counter(entry.called for entry in there)
        yield [(_path(entry, called[entry.called] == 1), partial(_read_over, database, entry)) for entry in there]
    finally:
        database.close()


def _read_over(database: Database, entry: Entry) -> AbstractContextManager[ServerLog]:
    """Return a log whose end leaves the connection open."""
    return nullcontext(ServerLog(database, entry, write=False))


def _path(entry: Entry, alone: bool) -> Path:
    """Return "store:NAME", or "store:ID" of a branch, or where the name is no single one."""
    by_name = Path(f"{STORED}{entry.called}")
    if alone and not unfit(entry.called):
        return by_name
    return Path(f"{STORED}{entry.id[:_SHOWN]}")
