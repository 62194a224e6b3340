"""A connection to a PostgreSQL server that comes back after the server has been away; the one place with its driver.

The tables of a store, what they refuse, and who may do what.

Nobody changes or deletes an event, its owner included: a trigger refuses it. What is inserted has to follow: the next
number of its campaign, and the hash chained over what stands before it, which the server computes itself.
"""

from __future__ import annotations

import contextlib
import hashlib
import selectors
import socket
import ssl
import struct
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Literal

from axiscal.document import shown
from axiscal.exceptions import OvertakenError, RecordError, UnreachableError
from axiscal.numerics.remembered import Memo
from axiscal.ports.postgres.address import StoreAddress, store_address
from axiscal.record.log import EMPTY

FORM = 1
"""Of the tables."""
_TABLES = f"""
CREATE SCHEMA axiscal;
CREATE TABLE axiscal.form (number integer PRIMARY KEY);
INSERT INTO axiscal.form VALUES ({FORM});
CREATE TABLE axiscal.campaigns (
    id uuid PRIMARY KEY, name text NOT NULL, branch_of uuid REFERENCES axiscal.campaigns, branch_at bigint,
    CHECK ((branch_of IS NULL) = (branch_at IS NULL)), CHECK (branch_of <> id), CHECK (branch_at > 0));
CREATE INDEX ON axiscal.campaigns (name);
CREATE TABLE axiscal.events (
    campaign uuid REFERENCES axiscal.campaigns, number bigint CHECK (number > 0), kind text NOT NULL,
    payload text NOT NULL, at text NOT NULL, digest text NOT NULL, writer text NOT NULL DEFAULT session_user,
    PRIMARY KEY (campaign, number));
CREATE FUNCTION axiscal.refuse() RETURNS trigger LANGUAGE plpgsql AS $body$
BEGIN
    RAISE EXCEPTION 'events are only ever added' USING ERRCODE = '42501';
END $body$;
CREATE FUNCTION axiscal.follow() RETURNS trigger LANGUAGE plpgsql AS $body$
DECLARE
    before text;
BEGIN
    SELECT digest INTO before FROM axiscal.events WHERE campaign = NEW.campaign AND number = NEW.number - 1;
    IF before IS NULL THEN
        SELECT e.digest INTO before FROM axiscal.campaigns AS c
            JOIN axiscal.events AS e ON e.campaign = c.branch_of AND e.number = c.branch_at
            WHERE c.id = NEW.campaign AND c.branch_at = NEW.number - 1;
    END IF;
    IF before IS NULL AND NEW.number = 1
        AND EXISTS (SELECT FROM axiscal.campaigns WHERE id = NEW.campaign AND branch_of IS NULL) THEN
        before := '{EMPTY}';
    END IF;
    IF before IS NULL THEN
        RAISE EXCEPTION 'event % does not follow: there is no event before it', NEW.number;
    END IF;
    IF NEW.digest <> encode(sha256(convert_to(concat_ws(' ', before, NEW.kind, NEW.payload), 'UTF8')), 'hex') THEN
        RAISE EXCEPTION 'event % does not follow: its digest is another', NEW.number;
    END IF;
    NEW.writer := session_user;
    RETURN NEW;
END $body$;
CREATE TRIGGER follow BEFORE INSERT ON axiscal.events FOR EACH ROW EXECUTE FUNCTION axiscal.follow();
"""
_KEPT = """
CREATE TRIGGER keep BEFORE UPDATE OR DELETE ON axiscal.{table} FOR EACH ROW EXECUTE FUNCTION axiscal.refuse();
CREATE TRIGGER keep_all BEFORE TRUNCATE ON axiscal.{table} FOR EACH STATEMENT EXECUTE FUNCTION axiscal.refuse();
"""
_ROLE = "DO $body$ BEGIN CREATE ROLE {role} NOLOGIN; EXCEPTION WHEN duplicate_object THEN NULL; END $body$"
_RIGHTS = """
REVOKE ALL ON SCHEMA axiscal FROM PUBLIC;
GRANT USAGE ON SCHEMA axiscal TO axiscal_reader, axiscal_measurer;
GRANT SELECT ON ALL TABLES IN SCHEMA axiscal TO axiscal_reader, axiscal_measurer;
GRANT INSERT ON axiscal.campaigns, axiscal.events TO axiscal_measurer;
"""
ROLES = "axiscal_reader", "axiscal_measurer"
"""Who may read, and who may read and add; a person's account is made a member of one: GRANT axiscal_reader TO anna."""

_PATIENCE = 15.0
"""Seconds for an answer: a server of a shop answers in hundredths, a lost network never."""
_LOCK = 4000
"""Milliseconds for which another writer is waited for."""
_SENTENCES = {
    "28P01": ("The store does not take this password", "Put the right one into PGPASSWORD"),
    "28000": ("The store does not let this user in", "Ask whoever keeps it for an account"),
    "3D000": ("The server has no such database", "Make one with createdb, then: axiscal sync --prepare"),
    "42501": ("This user may not do that in the store", "Ask for the role axiscal_measurer; to read, axiscal_reader"),
    "42P01": ("The database is no store yet", "Prepare it once, as its owner: axiscal sync --prepare"),
    "3F000": ("The database is no store yet", "Prepare it once, as its owner: axiscal sync --prepare"),
    "55P03": ("Another program holds this campaign and is writing", "Wait, then give the command again"),
}
"""What is said for the states of SQL that a person can do something about."""
_UNIQUE, _GONE = "23505", ("57P01", "57P02", "57P03", "08")
"""A number that is taken; the server ends, or is not there."""


class Database:
    """A database; every failure is a RecordError that names it."""

    def __init__(self, address: StoreAddress) -> None:
        self.address = address
        self._connection: Any = None
        self._line, self._prepared = -1, Memo()
        self._within = False

    def rows(self, query: str, **values: object) -> list[list[Any]]:
        """Return what a query gives; `:name` in it stands for a value.

        Outside of a transaction a query only reads, or begins one, so it may run twice. It runs again over a new
        connection if an earlier one was dropped, as servers and routers do with idle ones.
        """
        of_before = self._connection is not None and not self._within
        try:
            return self._asked(query, values)
        except UnreachableError:
            if not of_before:
                raise
            return self._asked(query, values)

    def _asked(self, query: str, values: Mapping[str, object]) -> list[list[Any]]:
        with self._failures():
            found = self._opened().run(query, **values)
        return list(found or [])

    def at_once(self, query: str, **values: object) -> bool:
        """Do one thing in one transaction and one question to the server, which is never sent again.

        Return whether it was sent and done. It is not if the connection is yet to be made, or already has something
        to say, such as its end. Raises UnreachableError where nobody knows whether it was done.
        """
        if self._within or self._connection is None or _speaks(self._line):
            return False
        with self._failures():
            self._prepared.answer(query, lambda: self._connection.prepare(query)).run(**values)
        return True

    @contextmanager
    def transaction(self, held: str) -> Iterator[None]:
        """Do all that the block does, or nothing; where the server goes away at the end it is not known which.

        held : what nobody else may write to meanwhile, by a name
        """
        try:
            # one question to the server; the lock comes before the first look at what there is
            self.rows(f"START TRANSACTION; SELECT pg_advisory_xact_lock({lock_number(held)})")
            self._within = True
            yield
            self._commit()
        except BaseException:
            with contextlib.suppress(RecordError):
                self.rows("ROLLBACK")
            raise
        finally:
            self._within = False

    def _commit(self) -> None:
        try:
            self.rows("COMMIT")
        except RecordError as failure:
            raise not_known(failure) from None

    def close(self) -> None:
        """Close the connection."""
        connection, self._connection = self._connection, None
        self._prepared = Memo()
        if connection is not None:
            with contextlib.suppress(*_network_failures()):
                connection.close()

    @property
    def _named(self) -> str:
        return self.address.shown

    def _opened(self) -> Any:
        if self._connection is None:
            if self._within:
                raise UnreachableError("The server went away in the middle", "Give the command again", self._named)
            line = _line(self.address)
            self._line = line.fileno()  # it stays the same under TLS
            self._connection = _connected(self.address, line)
        return self._connection

    @contextmanager
    def _failures(self) -> Iterator[None]:
        """Turn what server, network and driver did into a RecordError."""
        try:
            yield
        except UnicodeEncodeError as failure:
            self.close()
            what = f"{shown(failure.object)} has a letter that is none"
            raise RecordError(what, "Give the campaign a name without it", self._named) from None
        except _network_failures() as failure:
            found = failure.args[0] if failure.args else ""
            state = str(found.get("C", "")) if isinstance(found, dict) else ""
            if not state or state.startswith(_GONE):
                self.close()
                raise UnreachableError(
                    f"The store does not answer: {_words(failure)}",
                    "Look whether server and network are there, then give the command again; what was kept is kept",
                    self._named,
                ) from failure
            if state == _UNIQUE:
                raise OvertakenError(
                    "Another process has written to this record in the meantime",
                    "Look at it with `axiscal status`, then give the command again",
                    self._named,
                ) from failure
            what, remedy = _SENTENCES.get(
                state, (f"The store refuses it: {_words(failure)}", "Ask whoever keeps the store")
            )
            raise RecordError(what, remedy, self._named) from failure
        except BaseException:  # Ctrl-C: the answer that is still to come is not one to the next question
            self.close()
            raise


def not_known(failure: RecordError) -> RecordError:
    """Return the error of a server that went away before it confirmed an entry."""
    what = f"{failure.what}, and whether the last entry is kept is not known"
    return RecordError(what, "Look at it, then give the command again if it is not there", failure.file)


def lock_number(held: str) -> int:
    """Return the number by which the server locks what has this name."""
    return int.from_bytes(hashlib.sha256(held.encode(errors="surrogateescape")).digest()[:8], signed=True)


def _speaks(line: int) -> bool:
    """Whether something has come over a connection that was asked nothing.  line : its file descriptor"""
    with selectors.DefaultSelector() as waiting:
        waiting.register(line, selectors.EVENT_READ)
        return bool(waiting.select(0))


def _words(failure: BaseException) -> str:
    found = failure.args[0] if failure.args else ""
    said = found.get("M", "") if isinstance(found, dict) else str(failure)
    return str(said) or type(failure).__name__


def _network_failures() -> tuple[type[BaseException], ...]:
    from pg8000.exceptions import Error

    return (Error, OSError, struct.error)


def _connected(address: StoreAddress, line: socket.socket) -> Any:
    """Return a connection over a socket; raises what the driver raises, OSError where nobody answers."""
    from pg8000.exceptions import DatabaseError, Error
    from pg8000.native import Connection

    try:
        return Connection(
            address.user,
            host=address.host,
            database=address.database,
            password=address.password,
            sock=line,
            ssl_context=_tls(address),
            application_name="axiscal",
            startup_params={"lock_timeout": str(_LOCK), "synchronous_commit": "on"},
        )
    except (Error, OSError, struct.error) as failure:
        line.close()
        said: BaseException | None = failure
        while said is not None and not isinstance(said, DatabaseError):
            said = said.__context__  # the server's own words, where it hung up and the driver fails at the farewell
        raise said or failure from None


def _line(address: StoreAddress) -> socket.socket:
    """Return a socket to the server; raises OSError."""
    if not address.socket:
        line = socket.create_connection((address.host, address.port), _PATIENCE)
        line.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        return line
    line = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        line.settimeout(_PATIENCE)
        line.connect(f"{address.socket}/.s.PGSQL.{address.port}")
    except BaseException:
        line.close()
        raise
    return line


def _tls(address: StoreAddress) -> ssl.SSLContext | Literal[False] | None:
    """Return the TLS of a connection: False for none, None where the server may choose."""
    if address.socket or address.sslmode == "disable":
        return False
    if address.sslmode in ("", "prefer"):
        return None
    context = ssl.create_default_context()
    if address.sslmode == "require":
        context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    elif address.sslmode == "verify-ca":
        context.check_hostname = False
    return context


def opened_database(store: str | None = None) -> Database:
    """Return a database that answers; raises RecordError, also where its driver is not installed.

    store : its address; that of AXISCAL_STORE where none is given
    """
    address = store_address(store)
    try:
        import pg8000  # noqa: F401
    except ImportError:
        remedy = "Install it: pip install 'axiscal[postgres]'"
        raise RecordError("The driver for PostgreSQL is not installed", remedy) from None
    database = Database(address)
    database.rows("SELECT 1")
    return database


def prepare(database: Database) -> bool:
    """Make a database a store; False where it is one already.  Raises RecordError."""
    if _there(database):
        refuse_newer(database)
        return False
    with database.transaction("tables"):
        for role in ROLES:
            database.rows(_ROLE.format(role=role))
        for script in (_TABLES, *(_KEPT.format(table=table) for table in ("campaigns", "events")), _RIGHTS):
            database.rows(script)
    return True


def refuse_newer(database: Database) -> None:
    """Raise RecordError for a database that is no store, or one of a newer axiscal."""
    form = database.rows("SELECT max(number) FROM axiscal.form")[0][0]
    if form is None or form > FORM:
        what = f"This store was made by a newer axiscal (form {form}; this one knows {FORM})"
        raise RecordError(what, "Install the newer version; nothing was changed", database.address.shown)


def _there(database: Database) -> bool:
    return bool(database.rows("SELECT to_regclass('axiscal.form') IS NOT NULL")[0][0])
