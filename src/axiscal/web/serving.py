"""The server: one port of this computer that nobody else can reach, until Ctrl-C."""

from __future__ import annotations

import socket
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import uvicorn

from axiscal.exceptions import InputError
from axiscal.web.api import application
from axiscal.web.counter import Counter
from axiscal.web.guard import Admission

_LOOPBACK = "127.0.0.1"


def serve_record(record: Path, port: int, language: str, ready: Callable[[str], None]) -> None:
    """Serve the page of a record until Ctrl-C.

    language : of the page; port : 0 is any that is free; ready : called with the address once the page answers
    Raises RecordError if that is no record, InputError if the port is taken.
    """
    counter = Counter.open(record, language)
    try:
        with _listening(port) as listener:
            admitted = Admission(int(listener.getsockname()[1]))
            ready(admitted.address)
            _server(counter, admitted).run(sockets=[listener])
    except KeyboardInterrupt:
        pass  # the way in which a server is ended
    finally:
        counter.close()


def _listening(port: int) -> socket.socket:
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listener.bind((_LOOPBACK, port))
        listener.listen()
    except OSError as failure:
        listener.close()
        what = f"Port {port} cannot be used: {failure.strerror}"
        raise InputError(what, "Name another one with --port, or leave it out") from failure
    return listener


def _server(counter: Counter, admitted: Admission) -> uvicorn.Server:
    config = uvicorn.Config(
        application(counter, admitted),
        http="h11",
        ws="none",
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        timeout_graceful_shutdown=1,
    )
    return _Server(config, counter)


class _Server(uvicorn.Server):
    """The server, which tells those who wait for news that it is about to end."""

    def __init__(self, config: uvicorn.Config, counter: Counter) -> None:
        super().__init__(config)
        self._counter = counter

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Take a signal to end."""
        self._counter.end()
        super().handle_exit(sig, frame)
