"""A connection to the store is as safe as its address asks for, and no traceback shows its password."""

from __future__ import annotations

import shutil
import socket
from collections.abc import Iterator

import pytest

from axiscal.exceptions import RecordError
from axiscal.ports.postgres.database import Database, store_address
from tests.record.postgres_server import OWNER, RunningServer, running_server

NAMES = "localhost", "127.0.0.1"
"""Of the server, the one in its certificate and another."""
CHECKED, UNCHECKED = ("verify-ca", "verify-full", ""), ("prefer", "require")


@pytest.fixture(scope="module")
def safe() -> Iterator[tuple[RunningServer, int]]:
    """Yield a server that can do TLS by a certificate of its own, and its port."""
    if shutil.which("openssl") is None:
        pytest.skip("needs openssl, which Debian's postgresql brings")
    with running_server() as server:
        data = server.folder / "data"
        server.run(
            *("openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=axiscal"),
            *("-addext", f"subjectAltName=DNS:{NAMES[0]}"),
            *("-out", str(data / "server.crt"), "-keyout", str(data / "server.key")),
        )
        (data / "server.key").chmod(0o600)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = int(free.getsockname()[1])
        server.stop()
        server.start("listen_addresses=127.0.0.1", f"port={port}", "ssl=on")
        yield server, port


def by_tls(port: int, mode: str, host: str = NAMES[0]) -> bool:
    """Return whether a connection that this mode made is encrypted; raises RecordError where there is none."""
    address = f"postgresql://{OWNER}@{host}:{port}/postgres" + (f"?sslmode={mode}" if mode else "")
    database = Database(store_address(address, {}))
    try:
        return bool(database.select("SELECT ssl FROM pg_stat_ssl WHERE pid = pg_backend_pid()")[0][0])
    finally:
        database.close()


def test_a_certificate_is_checked_where_that_is_asked_for(
    safe: tuple[RunningServer, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    server, port = safe
    assert [by_tls(port, mode) for mode in ("disable", *UNCHECKED)] == [False, True, True]
    for mode in CHECKED:
        with pytest.raises(RecordError, match="CERTIFICATE_VERIFY_FAILED"):
            by_tls(port, mode)
    monkeypatch.setenv("SSL_CERT_FILE", str(server.folder / "data" / "server.crt"))
    assert all(by_tls(port, mode) for mode in CHECKED)
    assert by_tls(port, "verify-ca", NAMES[1])
    for mode in ("verify-full", ""):
        with pytest.raises(RecordError, match=r"CERTIFICATE_VERIFY_FAILED.*SSL_CERT_FILE"):
            by_tls(port, mode, NAMES[1])


def test_a_server_without_tls_is_refused_where_tls_is_asked_for(safe: tuple[RunningServer, int]) -> None:
    server, port = safe
    server.stop()
    server.start("listen_addresses=127.0.0.1", f"port={port}", "ssl=off")
    try:
        assert not by_tls(port, "prefer")
        for mode in ("require", *CHECKED):
            with pytest.raises(RecordError, match=r"refuses SSL.*sslmode=prefer"):
                by_tls(port, mode)
    finally:
        server.stop()
        server.start("listen_addresses=127.0.0.1", f"port={port}", "ssl=on")


def test_no_traceback_shows_the_password() -> None:
    address = store_address("postgresql://anna:secret@host/db", {})
    assert address.password == "secret"
    assert "secret" not in repr(address) + repr(vars(Database(address)))
