"""The server: one port of this computer that nobody else can reach, until Ctrl-C."""

from __future__ import annotations

import asyncio
import logging
import socket
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from axiscal.exceptions import InputError
from axiscal.web.api import application
from axiscal.web.counter import Counter
from axiscal.web.guard import Admission, Guard

_LOOPBACK = "127.0.0.1"
_ASKING, _BURST, _PATIENCE, _HEAD = 100, 100, 5.0, 16 * 1024
"""Connections that have not asked to the end; those taken in at once; seconds to ask in; bytes of a request's head."""


def serve_record(record: Path, port: int, ready: Callable[[str], None]) -> str:
    """Serve the page of a record until Ctrl-C; return a sentence on what was broken off, "" where nothing was.

    Page and answers are in the language that is spoken.
    port : 0 is any that is free; ready : called with the address once the page answers
    Raises RecordError if that is no record, InputError if the port is taken.
    """
    counter = Counter.open(record)
    try:
        with _listening(port) as listener:
            admitted = Admission(int(listener.getsockname()[1]))
            server = _server(application(counter, admitted), counter.end, lambda: ready(admitted.address))
            server.run(sockets=[listener])
    except KeyboardInterrupt:
        pass  # the way in which a server is ended
    finally:
        left = counter.close()
    return left


def _listening(port: int) -> socket.socket:
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listener.bind((_LOOPBACK, port))
        listener.listen()
    except OSError as failure:
        listener.close()
        what, remedy = "Port {port} cannot be used: {strerror}", "Name another one with --port, or leave it out"
        raise InputError(what, remedy, port=port, strerror=failure.strerror) from failure
    return listener


def _server(app: Guard, ending: Callable[[], None], ready: Callable[[], None]) -> _Server:
    config = uvicorn.Config(
        app,
        http=_Caller,
        ws="none",
        log_level="error",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        timeout_graceful_shutdown=1,
        backlog=_BURST,
        h11_max_incomplete_event_size=_HEAD,
    )
    return _Server(config, ending, ready)


class _Caller(H11Protocol):
    """A connection. One that takes too long to ask is cut, and the longest waiting one where there are too many."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Take it in."""
        super().connection_made(transport)
        self._since = self.loop.time()
        self._watch = self.loop.call_later(_PATIENCE, self._look)
        asking = [line for line in self.connections if isinstance(line, _Caller) and line._asks()]
        if len(asking) > _ASKING:
            min(asking, key=lambda line: line._since).transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Watch it no longer."""
        self._watch.cancel()
        super().connection_lost(exc)

    def on_response_complete(self) -> None:
        """Let the next request begin."""
        self._since = self.loop.time()
        super().on_response_complete()

    def _asks(self) -> bool:
        cycle = self.cycle
        return cycle is None or cycle.response_complete or cycle.more_body

    def _look(self) -> None:
        if self._asks() and self.loop.time() - self._since >= _PATIENCE:
            self.transport.abort()
        self._watch = self.loop.call_later(_PATIENCE, self._look)


class _Server(uvicorn.Server):
    """The server, which says when it answers, and tells those who wait for news that it is about to end."""

    def __init__(self, config: uvicorn.Config, ending: Callable[[], None], ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._ending, self._ready = ending, ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to answer, and say so: from here on a signal ends it as it should."""
        await super().startup(sockets)
        self._ready()

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Take a signal to end; who still waits for an answer then is sent away, which is no fault to be told of."""
        logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)
        self._ending()
        super().handle_exit(sig, frame)
