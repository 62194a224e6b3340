"""One PostgreSQL server for all tests of the record, with a store in it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from axiscal.ports.postgres.database import Database, store_address
from axiscal.ports.postgres.tables import prepare
from tests.record.postgres_server import RunningServer, running_server


@pytest.fixture(scope="session")
def server() -> Iterator[RunningServer]:
    """Yield the server; its database postgres is a store."""
    with running_server() as found:
        database = Database(store_address(found.address()))
        assert prepare(database)
        for role in ("reader", "measurer"):
            database.select(f"CREATE ROLE {role} LOGIN IN ROLE axiscal_{role}")
        database.select("CREATE ROLE stranger LOGIN")
        database.close()
        yield found


@pytest.fixture
def address(server: RunningServer) -> str:
    """Return the address of the store as its keeper."""
    return server.address()


@pytest.fixture
def database(address: str) -> Iterator[Database]:
    """Yield the store, open."""
    opened = Database(store_address(address))
    yield opened
    opened.close()
