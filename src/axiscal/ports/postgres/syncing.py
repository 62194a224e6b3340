"""A record of a laptop and the store brought together: nothing is lost, and nothing is merged.

Both logs are chained, so what they share is a beginning. If both went on from there, the laptop's rest becomes another
campaign, a branch. The id of the branch follows from the campaign it leaves and its first event. So a second sync, or
another laptop with the same rest, comes to the same branch. What is measured later goes there too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from shlex import quote
from typing import Literal
from uuid import UUID, uuid5

from axiscal.exceptions import RecordError
from axiscal.ports.postgres.database import Database
from axiscal.ports.postgres.server_log import Entry, ServerLog, enter, entry_of, insert, refuse_taken
from axiscal.ports.postgres.tables import refuse_other
from axiscal.record.log import EMPTY, ChainedText, EventLog, campaign_of, shared_events
from axiscal.record.signing import own_hand

Case = Literal["new", "ahead", "same", "behind", "fork", "fork again", "fork goes on"]
"""What the laptop is against the store."""


@dataclass(frozen=True, slots=True)
class Synced:
    """Result of a sync.

    campaign : where the store has what the laptop has; sent, taken : numbers of events; shared : event of the fork
    set_back : the last event that the store had seen in this file, and the laptop has no more; 0 if it has all
    """

    case: Case
    campaign: Entry
    sent: int = 0
    taken: int = 0
    shared: int = 0
    set_back: int = 0


def synced(database: Database, record: EventLog, name: str) -> Synced:
    """Bring a record and the store together; raises RecordError, and then the store has all of it or what it had.

    name : what the campaign is called in the store if it is new there
    """
    refuse_other(database)
    texts = record.texts()
    entry = Entry(campaign_of(texts[0]), name, None, None)

    if first := set_aside(database, entry.id, texts):
        what = "Whoever keeps the store has set event {first} of this record aside, and all behind it"
        remedy = "Go on without them: axiscal shop sync {record} --drop; all of it stays in a file beside"
        raise RecordError(what, remedy, record.path, first=first, record=quote(str(record.path)))

    def brought() -> tuple[Synced, Sequence[ChainedText]]:
        there = entry_of(database, entry.id)
        found, rest = _new(database, entry, texts) if there is None else _sent(database, there, texts)
        back = _countersigned(database, entry.id, record.path, found.campaign, texts)
        return replace(found, set_back=back), rest

    found, rest = database.transaction(brought)
    if rest:
        record.extend([text.row for text in rest], after=len(texts))
    return found


def set_aside(database: Database, campaign: str, texts: Sequence[ChainedText]) -> int:
    """Return the number of the first event that the store has set aside, of a campaign or its branches; 0 for none."""
    rows = database.select(
        "SELECT min(number) FROM axiscal.aside WHERE digest = ANY(CAST(:digests AS text[])) AND campaign IN "
        "(SELECT id FROM axiscal.campaigns WHERE CAST(:id AS uuid) IN (id, branch_of))",
        id=campaign,
        digests=[text.chain for text in texts],
    )
    return int(rows[0][0] or 0)


def _new(database: Database, entry: Entry, texts: Sequence[ChainedText]) -> tuple[Synced, Sequence[ChainedText]]:
    refuse_taken(database, entry, "give this one another name: --name NAME")
    enter(database, entry, texts)
    return Synced("new", entry, sent=len(texts)), ()


def _countersigned(database: Database, record: str, path: Path, there: Entry, texts: Sequence[ChainedText]) -> int:
    """Let the store keep how far it saw this file, and return the last event it had seen before and that has gone."""
    of_this = {"record": record, "copy": f"{own_hand().computer}:{path.resolve()}"}
    rows = database.select(
        "SELECT s.number, e.digest FROM axiscal.seen AS s JOIN axiscal.standing AS e USING (campaign, number) "
        "WHERE s.record = CAST(:record AS uuid) AND s.copy = :copy ORDER BY s.id DESC LIMIT 1",
        **of_this,
    )
    number, digest = rows[0] if rows else (0, EMPTY)
    may = database.select("SELECT has_function_privilege('axiscal.saw(uuid, text, uuid, bigint)', 'EXECUTE')")[0][0]
    if may and (number, digest) != (len(texts), texts[-1].chain):
        seen = "SELECT axiscal.saw(CAST(:record AS uuid), :copy, CAST(:campaign AS uuid), CAST(:number AS bigint))"
        database.select(seen, **of_this, campaign=there.id, number=len(texts))
    kept = number <= len(texts) and digest in (EMPTY, texts[number - 1].chain)
    return 0 if kept else int(number)


def _sent(database: Database, entry: Entry, texts: Sequence[ChainedText]) -> tuple[Synced, Sequence[ChainedText]]:
    """Return what was done in the store, and what the laptop lacks."""
    stored = ServerLog(database, entry).texts()
    shared = shared_events([text.chain for text in stored], [text.chain for text in texts])
    fork = entry.branch_of is not None
    at = entry.branch_at or 0
    if shared == len(stored):
        insert(database, entry.id, len(stored), texts[shared:])
        case: Case = "same" if shared == len(texts) else "ahead"
        if fork:
            case = "fork again" if case == "same" else "fork goes on"
        return Synced(case, entry, sent=len(texts) - shared, shared=at), ()
    if shared == len(texts):
        rest = stored[shared:]
        return Synced("fork goes on" if fork else "behind", entry, taken=len(rest), shared=at), rest
    branch = Entry(str(uuid5(UUID(entry.id), texts[shared].chain)), entry.name, entry.id, shared)
    if known := entry_of(database, branch.id):
        return _sent(database, known, texts)
    enter(database, branch, texts[shared:])
    return Synced("fork", branch, sent=len(texts) - shared, shared=shared), ()
