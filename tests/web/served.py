"""`axiscal serve` as a program of its own, and requests to it word for word."""

import http.client
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from axiscal.campaign.campaign import Campaign
from tests.generators.begun import begun
from tests.generators.texts import FOUR_READINGS

PATIENCE = 150.0
"""s: for an answer on a busy computer."""


@dataclass(frozen=True)
class Answer:
    """What the server says to one request."""

    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def document(self) -> dict[str, Any]:
        """The body as a JSON document."""
        decoded: dict[str, Any] = json.loads(self.body)
        return decoded


@dataclass(frozen=True)
class Served:
    """A server that runs: its address with the token, its record or else its folder, its process, what it printed."""

    address: str
    record: Path
    process: int
    printed: str = ""

    @property
    def port(self) -> int:
        """The port it listens on."""
        return int(re.findall(r":(\d+)/", self.address)[0])

    @property
    def token(self) -> str:
        """The token that it printed."""
        return self.address.rpartition("#")[2]

    def ask(self, method: str, path: str, body: bytes | None = None, **headers: str) -> Answer:
        """Return the answer to a request with just these headers beside Host; `_` in a name stands for `-`."""
        line = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        try:
            line.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
            for name, value in ({"Host": f"127.0.0.1:{self.port}"} | headers).items():
                line.putheader(name.replace("_", "-"), value.encode())
            if body is not None:
                line.putheader("Content-Length", str(len(body)))
            line.endheaders(body)
            answer = line.getresponse()
            found = {name.lower(): value for name, value in answer.getheaders()}
            return Answer(answer.status, found, answer.read())
        finally:
            line.close()

    def call(self, path: str, /, **body: Any) -> Answer:
        """Return the answer to a program that has the token: a POST where there is a body."""
        bearer = {"Authorization": f"Bearer {self.token}"}
        if not body:
            return self.ask("GET", f"/api/1/{path}", None, **bearer)
        return self.ask("POST", f"/api/1/{path}", json.dumps(body).encode(), **bearer)

    def state(self) -> dict[str, Any]:
        """Return what the page shows."""
        return self.call("state").document


def started(folder: Path, campaign: str = FOUR_READINGS) -> Path:
    """Return the record of a campaign that has been started in a folder."""
    begun(folder, {"campaign.toml": campaign}, ("start", "campaign.toml", "mill.axiscal"))
    return folder / "mill.axiscal"


def kept(record: Path) -> list[float]:
    """Return the readings on the disk, um."""
    with Campaign.open(record, write=False) as campaign:
        return [round(reading.value * 1e6, 6) for reading in campaign.state.readings]


@contextmanager
def serving(record: Path, *options: str, program: str = "") -> Iterator[tuple[Served, subprocess.Popen[str]]]:
    """Serve a record, or the start of a folder, in English unless said, and end it with the block.

    program : Python that does it in place of the command
    """
    starts = record.is_dir()
    command = [sys.executable, *(("-c", program) if program else ("-m", "axiscal")), "serve"]
    process = subprocess.Popen(
        [*command, *([] if starts else [str(record)]), *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env={**os.environ, "AXISCAL_LANGUAGE": "en"},
        cwd=record if starts else record.parent,
    )
    assert process.stdout is not None
    try:
        addresses = [word for word in process.stdout.readline().split() if word.startswith("http://")]
        assert addresses, process.communicate(timeout=PATIENCE)
        yield Served(addresses[0], record, process.pid, process.stdout.readline()), process
    finally:
        process.kill()
        process.communicate()


@contextmanager
def served(record: Path, *options: str) -> Iterator[Served]:
    """Serve until the end of the block, by Ctrl-C with status 0."""
    with serving(record, *options) as (page, process):
        yield page
        process.send_signal(signal.SIGINT)
        _, complaint = process.communicate(timeout=PATIENCE)
        assert (process.returncode, complaint.count("\n")) == (0, 0 if record.is_dir() else 1), complaint
