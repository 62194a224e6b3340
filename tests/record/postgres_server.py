"""A real PostgreSQL server for the tests, in a folder of its own, on a socket of its own, as a user without rights.

It ends with the process that began it, and its folder with it, however that process ends.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from axiscal.ports.postgres.database import Database

_QUICK = ["-c", "fsync=off", "-c", "full_page_writes=off", "-c", "shared_buffers=16MB", "-c", "max_connections=50"]
"""A server that lives for a minute need not outlive the power."""
OWNER = "keeper"
END_SESSIONS = (
    "SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity "
    "WHERE pid <> pg_backend_pid() AND application_name = 'axiscal'"
)
_ENDING = 'cat > /dev/null; "$1" -D "$2/data" -m immediate -s stop; rm -rf "$2"'
"""What waits in a shell for the end of what is written to it: nobody can prevent that, no SIGKILL either."""


def programs() -> Path:
    """Return the folder of PostgreSQL's programs; skips where there is none."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"))
    named = shutil.which("initdb")
    if not found and named is None:
        pytest.skip("needs Debian's postgresql")
    return (found[-1] if found else Path(str(named))).parent


class RunningServer:
    """A server that runs; address : of one of its databases."""

    def __init__(self, folder: Path, bin_folder: Path, durable: bool) -> None:
        self.folder, self._bin, self._durable = folder, bin_folder, durable

    def address(self, database: str = "postgres", user: str = OWNER) -> str:
        """Return the address of a database."""
        return f"postgresql://{user}@/{database}?host={self.folder}"

    def control(self, *words: str) -> None:
        """Start or stop it."""
        self.run(str(self._bin / "pg_ctl"), "-D", str(self.folder / "data"), "-w", "-s", *words)

    def run(self, *command: str) -> None:
        """Run a command as the user that it runs as."""
        _as_nobody_much(list(command), self.folder)

    def start(self, *settings: str) -> None:
        """Start it.  settings : as in postgresql.conf, such as ssl=on"""
        usual = "listen_addresses=", f"unix_socket_directories={self.folder}"
        options = [*([] if self._durable else _QUICK), *(word for each in (*usual, *settings) for word in ("-c", each))]
        self.control("-l", str(self.folder / "log"), "-o", " ".join(options), "start")

    def stop(self, mode: str = "immediate") -> None:
        """Stop it as a pulled plug does."""
        self.control("-m", mode, "stop")


def _as_nobody_much(command: list[str], folder: Path) -> None:
    subprocess.run(command, check=True, cwd=folder, stdout=subprocess.DEVNULL, **_nobody_much())


def _nobody_much() -> dict[str, Any]:
    """Return who PostgreSQL runs as, for `subprocess`: it refuses root."""
    return {"user": "postgres", "group": "postgres", "extra_groups": []} if os.geteuid() == 0 else {}


@contextmanager
def _ended_after(folder: Path, bin_folder: Path) -> Iterator[None]:
    """End the server and its folder after the block, or with this process."""
    command, silent = ["sh", "-c", _ENDING, "sh", str(bin_folder / "pg_ctl"), str(folder)], subprocess.DEVNULL
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=silent, stderr=silent, cwd="/", start_new_session=True, **_nobody_much()
    ):
        yield


@contextmanager
def cut_off(database: Database, keeper: Database, nth: int) -> Iterator[None]:
    """Have a keeper end the sessions of all others before the so-manieth statement of a database, from 0."""
    asked, counted = database.select, iter(range(99))

    def rows(query: str, **values: object) -> list[list[object]]:
        if next(counted) == nth:
            keeper.select(END_SESSIONS)
        return asked(query, **values)

    database.select = rows  # type: ignore[method-assign]
    try:
        yield
    finally:
        del database.select


@contextmanager
def running_server(*, durable: bool = False) -> Iterator[RunningServer]:
    """Yield a server; it and its folder are gone afterwards.  durable : it waits for its disk, as it does in a shop"""
    bin_folder = programs()
    folder = Path(tempfile.mkdtemp(prefix="axiscal-pg-"))  # a socket's name has to be short
    if os.geteuid() == 0:
        shutil.chown(folder, "postgres", "postgres")
    with _ended_after(folder, bin_folder):
        make = [str(bin_folder / "initdb"), "-D", str(folder / "data"), "-U", OWNER, "-A", "trust", "-N", "-E", "UTF8"]
        _as_nobody_much([*make, "--locale=C"], folder)
        server = RunningServer(folder, bin_folder, durable)
        server.start()
        yield server
