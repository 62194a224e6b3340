"""The tables of a store, what they refuse, and who may do what.

Nobody changes or deletes an event, its owner included: a trigger refuses it. What is inserted has to follow: the next
number of its campaign, and the hash chained over what stands before it, which the server computes itself. People add
by functions alone, which check kinds, texts, names and branches, so that no other client can do more. Of each copy of
a record that is brought together with the store it is kept how far it went: `seen`.

A client of a measurer's own can add an entry that is none, and then nobody can read what stands there. The owner sets
it and all behind it aside: the rows stay, and `standing` shows the others.

Nobody waits for anybody. A unique index would make writers wait for a client that keeps its transaction open, and so
would a lock. Therefore each transaction is serializable (Ports and Grittner, VLDB 2012): two that write the same number
never both end well, the first to end wins, and the other is tried again.
"""

from __future__ import annotations

from importlib import resources

from axiscal.exceptions import RecordError
from axiscal.ports.postgres.database import Database

FORM = 4
"""Of the tables; the first had no functions, in the second a client could keep others waiting, and in the third a
campaign could have no event, and any name."""
_LONGEST, _MOST = 20_000_000, 200_000
"""Letters of an event, and events that come at once: ten times what the largest campaign has."""
_SESSIONS = 200
"""Connections that a store takes, where its owner has not said."""
_LIMIT = (
    "DO $body$ BEGIN IF (SELECT datconnlimit FROM pg_database WHERE datname = current_database()) < 0 THEN EXECUTE "
    "format('ALTER DATABASE %I CONNECTION LIMIT {sessions}', current_database()); END IF; END $body$"
)
_ROLE = "DO $body$ BEGIN CREATE ROLE {role} NOLOGIN; EXCEPTION WHEN duplicate_object THEN NULL; END $body$"
ROLES = "axiscal_reader", "axiscal_measurer"
"""Who may read, and who may read and add; a person's account is made a member of one: GRANT axiscal_reader TO anna."""


def prepare(database: Database) -> bool:
    """Make a database a store, or one of an earlier form one of this; False where it is one.  Raises RecordError."""
    there = bool(database.select("SELECT to_regclass('axiscal.form') IS NOT NULL")[0][0])
    form = _form(database) if there else 0
    if form >= FORM:
        refuse_other(database)
        return False

    def made() -> None:
        for role in ROLES:
            database.select(_ROLE.format(role=role))
        if not there:
            _make(database, _script("first"), "campaigns", "events")
        quotas = _script("now").replace("{longest}", str(_LONGEST)).replace("{most}", str(_MOST))
        _make(database, quotas, "seen", "aside")
        database.select(_LIMIT.format(sessions=_SESSIONS))
        database.select(_script("rights"))

    database.transaction(made)
    return True


def refuse_other(database: Database) -> None:
    """Raise RecordError for a database that is no store, or one of another axiscal."""
    form = _form(database)
    if form < FORM:
        what = "This store was made by an earlier axiscal (form {form}; this one needs {known})"
        remedy = "Prepare it once more, as its owner: axiscal shop sync --prepare; what it holds stays"
        raise RecordError(what, remedy, database.address.shown, form=form, known=FORM)
    if form > FORM:
        what = "This store was made by a newer axiscal (form {form}; this one knows {known})"
        remedy = "Install the newer version; nothing was changed"
        raise RecordError(what, remedy, database.address.shown, form=form, known=FORM)


def _make(database: Database, script: str, *tables: str) -> None:
    """Run a script; nobody changes or deletes what the tables hold."""
    for each in (script, *(_script("kept").replace("{table}", table) for table in tables)):
        database.select(each)


def _script(name: str) -> str:
    return resources.files(__package__).joinpath(f"{name}.sql").read_text(encoding="utf-8")


def _form(database: Database) -> int:
    """Return the form of a store; one without is as new as can be."""
    form = database.select("SELECT max(number) FROM axiscal.form")[0][0]
    return FORM + 1 if form is None else int(form)


def quarantined(database: Database, campaign: str, first: int) -> int:
    """Set the events of a campaign from one on aside, as the owner, and return how many; raises RecordError."""
    asked = "SELECT axiscal.quarantine(CAST(:campaign AS uuid), CAST(:first AS bigint))"
    return int(database.select(asked, campaign=campaign, first=first)[0][0])
