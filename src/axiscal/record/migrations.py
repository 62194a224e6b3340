"""The form of the record: named steps, applied in order, never edited once released."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Migration:
    """A step from one form of the record to the next: its name and the SQL statements that take it."""

    name: str
    statements: tuple[str, ...]


MIGRATIONS: tuple[Migration, ...] = (
    Migration(
        "append-only events",
        (
            """CREATE TABLE events (
                id INTEGER PRIMARY KEY AUTOINCREMENT,
                kind TEXT NOT NULL,
                payload TEXT NOT NULL,
                at TEXT NOT NULL
            ) STRICT""",
            """CREATE TRIGGER events_are_never_changed BEFORE UPDATE ON events
                BEGIN SELECT RAISE(ABORT, 'an event is never changed'); END""",
            """CREATE TRIGGER events_are_never_deleted BEFORE DELETE ON events
                BEGIN SELECT RAISE(ABORT, 'an event is never deleted'); END""",
        ),
    ),
)
