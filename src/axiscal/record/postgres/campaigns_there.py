"""The campaigns of a store as they are named, and how far each has gone."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import NamedTuple

from axiscal.record.log import STORED
from axiscal.record.postgres.database import Database
from axiscal.record.postgres.schema import refuse_newer
from axiscal.record.postgres.server_log import Entry

_SHOWN = 13
"""Digits of an id that are shown."""
_THERE = """
SELECT CAST(c.id AS text), c.name, CAST(c.branch_of AS text), c.branch_at, e.number, e.digest
FROM axiscal.campaigns AS c LEFT JOIN LATERAL (
    SELECT number, digest FROM axiscal.events WHERE campaign = c.id ORDER BY number DESC LIMIT 1) AS e ON true
ORDER BY c.name, c.id
"""


class CampaignThere(NamedTuple):
    """A campaign of a store.

    path : by which it is asked for, "store:NAME", or "store:ID" of a branch, or where the name is no single one
    last, digest : of its last event; 0 and "" where it has none
    """

    path: Path
    last: int
    digest: str


def campaigns_there(database: Database) -> list[CampaignThere]:
    """Return the campaigns of a store by their names; raises RecordError."""
    refuse_newer(database)
    rows = [(Entry(*row[:4]), row[4], row[5]) for row in database.rows(_THERE)]
    called = Counter(entry.called for entry, _, _ in rows)
    return [CampaignThere(_path(entry, called[entry.called] == 1), last or 0, end or "") for entry, last, end in rows]


def _path(entry: Entry, alone: bool) -> Path:
    by_name = Path(f"{STORED}{entry.called}")
    if alone and by_name.name == f"{STORED}{entry.called}":  # a name such as a/b is one of a folder and a file
        return by_name
    return Path(f"{STORED}{entry.id[:_SHOWN]}")
