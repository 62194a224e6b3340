"""Where a store is: postgresql://USER@HOST:PORT/DATABASE, as PostgreSQL's own programs write it."""

from __future__ import annotations

import getpass
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from urllib.parse import parse_qs, unquote, urlsplit

from axiscal.exceptions import RecordError
from axiscal.language.spoken import said

VARIABLE = "AXISCAL_STORE"
"""The variable of the environment that names the store."""
_FORM = "postgresql://USER@HOST/DATABASE"
_MODES = "", "disable", "prefer", "require", "verify-ca", "verify-full"
"""Of TLS, as PostgreSQL names them: none, where the server has it, always, with a certificate that is checked."""
_IN_PASSWORDS = "in a password / is %2F, ? is %3F, # is %23 and @ is %40"
_PORT, _LAST_PORT = 5432, 65535
"""PostgreSQL's own; the last there is."""


@dataclass(frozen=True, slots=True)
class StoreAddress:
    """A database on a server.

    socket : the folder of its socket on this computer, "" for one reached by the network
    sslmode : as PostgreSQL names it; "" as "prefer": TLS where the server has it
    """

    host: str
    port: int
    user: str
    password: str | None = field(repr=False)
    database: str
    socket: str = ""
    sslmode: str = ""

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
    sslmode = options.pop("sslmode", environment.get("PGSSLMODE", ""))
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
