"""A record of a laptop and the store brought together: nothing is lost, and nothing is merged.

Both logs are chained, so what they share is a beginning. If both went on from there, the laptop's rest becomes another
campaign, a branch. The id of the branch follows from the campaign it leaves and its first event. So a second sync, or
another laptop with the same rest, comes to the same branch. What is measured later goes there too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal
from uuid import UUID, uuid5

from axiscal.ports.postgres.database import Database, refuse_newer
from axiscal.ports.postgres.server_log import Entry, ServerLog, enter, entry_of, insert
from axiscal.record.log import ChainedText, EventLog, campaign_of, shared_events

Case = Literal["new", "ahead", "same", "behind", "fork", "fork again", "fork goes on"]
"""What the laptop is against the store."""


@dataclass(frozen=True, slots=True)
class Synced:
    """Result of a sync.

    campaign : where the store has what the laptop has; sent, taken : numbers of events; shared : event of the fork
    """

    case: Case
    campaign: Entry
    sent: int = 0
    taken: int = 0
    shared: int = 0


def synced(database: Database, record: EventLog, name: str) -> Synced:
    """Bring a record and the store together; raises RecordError, and then the store has all of it or what it had.

    name : what the campaign is called in the store if it is new there
    """
    refuse_newer(database)
    texts = record.texts()
    entry = Entry(campaign_of(texts[0]), name, None, None)
    with database.transaction(entry.id):
        there = entry_of(database, entry.id)
        if there is None:
            enter(database, entry)
            insert(database, entry.id, 0, texts)
            return Synced("new", entry, sent=len(texts))
        found, rest = _sent(database, there, texts)
    if rest:
        record.extend([text.row for text in rest], after=len(texts))
    return found


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
    enter(database, branch)
    insert(database, branch.id, shared, texts[shared:])
    return Synced("fork", branch, sent=len(texts) - shared, shared=shared), ()
