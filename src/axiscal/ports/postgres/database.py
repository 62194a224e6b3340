"""A connection to a PostgreSQL server that comes back after the server has been away; the one place with its driver.

Where a store is: postgresql://USER@HOST:PORT/DATABASE, as PostgreSQL's own programs write it.
"""

from __future__ import annotations

import contextlib
import getpass
import os
import random
import selectors
import socket
import ssl
import struct
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Literal, TypeVar
from urllib.parse import parse_qs, unquote, urlsplit

from axiscal.document import shown
from axiscal.exceptions import OvertakenError, RecordError, UnreachableError
from axiscal.language.spoken import WORDS, later, said
from axiscal.numerics.remembered import Memo

_PATIENCE = 15.0
"""Seconds for an answer: a server of a shop answers in hundredths, a lost network never."""
_LOCK = 4.0
"""Seconds for which a transaction is tried again while others write."""
_NAP = 0.02
"""Longest wait before the next try, s: about the time of one transaction."""
_SENTENCES = WORDS["sql"]
"""What is said for the states of SQL that a person can do something about."""
_UNIQUE, _SECOND, _GONE = "23505", ("40001", "40P01"), ("57P01", "57P02", "57P03", "08")
"""A number that is taken; of two transactions at once this one came second; the server ends, or is not there."""
_SESSION = {
    "default_transaction_isolation": "serializable",
    "lock_timeout": f"{_LOCK:.0f}s",
    "synchronous_commit": "on",
}
"""Settings of a session; only changes of the tables themselves wait for a lock."""
_Done = TypeVar("_Done")


class _ConflictError(OvertakenError):
    """Another transaction wrote meanwhile; the same one may be tried again."""


class Database:
    """A database; every failure is a RecordError that names it."""

    def __init__(self, address: StoreAddress) -> None:
        self.address = address
        self._connection: Any = None
        self._line, self._prepared = -1, Memo()
        self._within = False

    def select(self, query: str, **values: object) -> list[list[Any]]:
        """Return what a query gives; `:name` in it stands for a value.

        Outside of a transaction a query only reads, or begins one, so it may run twice. It runs again over a new
        connection if an earlier one was dropped, as servers and routers do with idle ones.
        """
        if self._within:
            return self._asked(query, values)
        of_before = self._connection is not None
        try:
            return _while_others_come_first(lambda: self._asked(query, values))
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

    def transaction(self, deed: Callable[[], _Done]) -> _Done:
        """Do all that the deed does, or nothing, and return what it returns; again while others come first.

        Where the server goes away at the end it is not known which; that is what the error then says.
        """
        return _while_others_come_first(lambda: self._tried(deed))

    def _tried(self, deed: Callable[[], _Done]) -> _Done:
        try:
            self.select("START TRANSACTION")
            self._within = True
            done = deed()
            try:
                self.select("COMMIT")
            except UnreachableError as failure:
                raise not_known(failure) from None
            return done
        except BaseException:
            with contextlib.suppress(RecordError):
                self.select("ROLLBACK")
            raise
        finally:
            self._within = False

    def close(self) -> None:
        """Close the connection."""
        connection, self._connection = self._connection, None
        self._prepared = Memo()
        if connection is not None:
            with contextlib.suppress(*_network_failures()):
                connection.close()

    def _opened(self) -> Any:
        if self._connection is None:
            if self._within:
                remedy = "Give the command again"
                raise UnreachableError("The server went away in the middle", remedy, self.address.shown)
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
            what, remedy = "{text} has a letter that is none", "Give the campaign a name without it"
            raise RecordError(what, remedy, self.address.shown, text=shown(failure.object)) from None
        except _network_failures() as failure:
            found = failure.args[0] if failure.args else ""
            state = str(found.get("C", "")) if isinstance(found, dict) else ""
            if not state and "SSL" in _words(failure):
                self.close()
                what = "The store cannot prove who it is: {reason}"
                remedy = "Name its authority by SSL_CERT_FILE, or write ?sslmode=prefer in a network that you trust"
                raise RecordError(what, remedy, self.address.shown, reason=_words(failure)) from failure
            if not state or state.startswith(_GONE):
                self.close()
                what = "The store does not answer: {reason}"
                remedy = "Look whether server and network are there, then give the command again; what was kept is kept"
                raise UnreachableError(what, remedy, self.address.shown, reason=_words(failure)) from failure
            if state in (_UNIQUE, *_SECOND):
                what = "Another process has written to this record in the meantime"
                remedy = "Look at it with `axiscal step status`, then give the command again"
                error = OvertakenError if state == _UNIQUE else _ConflictError
                raise error(what, remedy, self.address.shown) from failure
            other = later("The store refuses it: {reason}"), later("Ask whoever keeps the store")
            words = _SENTENCES.get(state, other)
            raise RecordError(words[0], words[1], self.address.shown, reason=_words(failure)) from failure
        except BaseException:  # Ctrl-C: the answer that is still to come is not one to the next question
            self.close()
            raise


def _while_others_come_first(deed: Callable[[], _Done]) -> _Done:
    """Return what a deed returns, tried again for a while after each conflict: one of those who meet always ends."""
    until = time.monotonic() + _LOCK
    while True:
        try:
            return deed()
        except _ConflictError:
            if time.monotonic() > until:
                raise
            time.sleep(random.uniform(0, _NAP))


def not_known(failure: RecordError) -> RecordError:
    """Return the error of a server that went away before it confirmed an entry."""
    what = "{fault}, and whether the last entry is kept is not known"
    remedy = "Look at it, then give the command again if it is not there"
    return RecordError(what, remedy, failure.file, fault=failure.what)


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
            startup_params=_SESSION,
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
    """Return the TLS of a connection: False for none, None where the server may choose; verified unless said."""
    if address.socket or address.sslmode == "disable":
        return False
    if address.sslmode == "prefer":
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
    database.select("SELECT 1")
    return database


VARIABLE = "AXISCAL_STORE"
"""The variable of the environment that names the store."""
_FORM = "postgresql://USER@HOST/DATABASE"
_VERIFIED = "verify-full"
_MODES = "disable", "prefer", "require", "verify-ca", _VERIFIED
"""Of TLS, as PostgreSQL names them: none, where the server has it, always, with a certificate that is checked."""
_IN_PASSWORDS = "in a password / is %2F, ? is %3F, # is %23 and @ is %40"
_PORT, _LAST_PORT = 5432, 65535
"""PostgreSQL's own; the last there is."""


@dataclass(frozen=True, slots=True)
class StoreAddress:
    """A database on a server.

    socket : the folder of its socket on this computer, "" for one reached by the network
    sslmode : as PostgreSQL names it
    """

    host: str
    port: int
    user: str
    password: str | None = field(repr=False)
    database: str
    socket: str = ""
    sslmode: str = _VERIFIED

    @property
    def shown(self) -> str:
        """The address without its password."""
        host = self.socket or f"{self.host}:{self.port}"
        return f"postgresql://{self.user}@{host}/{self.database}"


def store_address(text: str | None, environment: Mapping[str, str] = os.environ) -> StoreAddress:
    """Return the address that is given, or the one in the environment; raises RecordError."""
    text = text or environment.get(VARIABLE, "")
    if not text:
        remedy = "Put its address into {variable}, or give --store: {form}"
        raise RecordError("No store is named", remedy, variable=VARIABLE, form=_FORM)
    what = "{text} is no address of a store"
    no_address = RecordError(what, "Write it as {form}; {how}", text=_hidden(text), form=_FORM, how=said(_IN_PASSWORDS))
    try:
        parts = urlsplit(text)
        asked = parse_qs(parts.query, strict_parsing=bool(parts.query))
        options = {name: values[-1] for name, values in asked.items()}
        port = int(options.pop("port", "") or parts.port or environment.get("PGPORT") or _PORT)
    except ValueError:  # whose words may hold a part of the password
        raise no_address from None
    if parts.scheme not in ("postgresql", "postgres") or not parts.path.strip("/") or not 0 < port <= _LAST_PORT:
        raise no_address
    if "@" in f"{parts.path}{parts.query}{parts.fragment}":  # the password was cut in two
        raise no_address
    sslmode = options.pop("sslmode", "") or environment.get("PGSSLMODE") or _VERIFIED
    host = unquote(options.pop("host", parts.hostname or environment.get("PGHOST", "localhost")))
    if options or sslmode not in _MODES:
        wrong = next(iter(options), f"sslmode={sslmode}")
        remedy = "Use host, port and sslmode alone"
        raise RecordError('"{wrong}" in the address of the store is not known', remedy, wrong=wrong)
    user = unquote(parts.username or environment.get("PGUSER", "") or getpass.getuser())
    password = unquote(parts.password) if parts.password is not None else environment.get("PGPASSWORD")
    socket = host if host.startswith("/") else ""
    return StoreAddress(host, port, user, password, unquote(parts.path.strip("/")), socket, sslmode)


def _hidden(text: str) -> str:
    """Return an address as it may be shown: what is before its last @ and in its options may be a password."""
    scheme, found, rest = text.partition("://")
    if not found:
        return "What is given"
    _, at, after = rest.rpartition("@")
    return f"{scheme}://{'...@' if at else ''}{after.partition('?')[0]}"
