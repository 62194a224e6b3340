"""The API of the page and the server that answers it.

Between many browsers and the one desk steps wait in a row, and new states are handed to all who wait for them. One
thread owns the campaign: one piece of work after another, the last of which can be broken off.
"""

from __future__ import annotations

import asyncio
import ctypes
import logging
import socket
from collections.abc import AsyncIterator, Callable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import asynccontextmanager
from pathlib import Path
from threading import Lock, get_ident
from types import FrameType
from typing import Annotated, TypeVar

import uvicorn
from fastapi import FastAPI, Query, Response
from fastapi.responses import FileResponse
from uvicorn.protocols.http.h11_impl import H11Protocol

from axiscal.campaign.campaign import Campaign
from axiscal.exceptions import InputError
from axiscal.language.spoken import speaking, spoken_now
from axiscal.numerics.threads import one_thread
from axiscal.web import shapes
from axiscal.web.desk import Desk
from axiscal.web.guard import ROOT, Guard, document, page_application, problem

_NEARLY = 0.5
"""s that work which is nearly done is waited for."""
LOOKS = 0.25
"""s between looks at the record: what others write is shown within a second."""
_Result = TypeVar("_Result")


class BrokenOffError(Exception):
    """Work that was waiting when the record was closed."""


class Counter:
    """One record, open on its own thread, in the language that is spoken; raises RecordError if that is none.

    desk : for what changes nothing, and needs no thread; state : the newest document, that a page is shown at once
    """

    def __init__(self, record: Path) -> None:
        self._pool, self._language = ThreadPoolExecutor(1, thread_name_prefix="campaign"), spoken_now()
        self._lock, self._closing = Lock(), False
        self._at_work: int | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._ending, self._asked, self._news = False, set[Future[str]](), asyncio.Event()
        self.desk = self._submitted(lambda: Desk(Campaign.open(record), self._publish)).result()
        self.state = self.desk.state

    async def do(self, step: Callable[[Desk], str]) -> str:
        """Do a step on the campaign's thread, then what can wait, and return what was done in words."""
        asked = self._submitted(lambda: step(self.desk))
        self._asked.add(asked)
        asked.add_done_callback(self._asked.discard)
        said = await asyncio.wrap_future(asked)
        self._think()
        return said

    async def ask(self, look: Callable[[Desk], _Result]) -> _Result:
        """Return what the desk says to a question that changes nothing, after the steps that are under way."""
        return await asyncio.wrap_future(self._submitted(lambda: look(self.desk)))

    async def watch(self) -> None:
        """Look at the record again and again, for what others write."""
        self._loop = asyncio.get_running_loop()
        self._think()
        while True:
            await asyncio.sleep(LOOKS)
            await self.ask(Desk.look)

    async def newer(self, seen: int, wait: float) -> shapes.StateShape:
        """Return the state as soon as its version is another one than `seen`, or after `wait` s."""
        clock = asyncio.get_running_loop().time
        deadline = clock() + wait
        while self.state.version == seen and not self._ending and (left := deadline - clock()) > 0:
            news = self._news
            try:
                await asyncio.wait_for(news.wait(), left)
            except TimeoutError:
                break
        return self.state

    def end(self) -> None:
        """Let nobody wait any longer: the server is about to end."""
        self._ending = True
        self._publish(self.state)

    def close(self) -> str:
        """Break off what is under way, leave what waits, close the record; return what is to be said of it.

        Work is ended as the main thread is by Ctrl-C, which may come anywhere: at the next step of Python.
        """
        asked, broken_off = bool(self._asked), False
        with self._lock:
            self._closing = True
        free = self._pool.submit(int)
        while not wait([free], _NEARLY).done:  # an interruption that comes while Python clears up is lost
            with self._lock:
                if self._at_work is not None:
                    interrupted = ctypes.c_ulong(self._at_work), ctypes.py_object(KeyboardInterrupt)
                    broken_off |= ctypes.pythonapi.PyThreadState_SetAsyncExc(*interrupted) == 1
        self._pool.submit(self.desk.campaign.close).result()
        self._pool.shutdown()
        if broken_off and asked:
            return (
                "A step that a page had asked for was broken off; what had been kept of it is shown at the next start."
            )
        return "What was being computed is begun anew at the next start." if broken_off else ""

    def _submitted(self, work: Callable[[], _Result]) -> Future[_Result]:
        return self._pool.submit(self._done, work)

    def _done(self, work: Callable[[], _Result]) -> _Result:
        with self._lock:
            if self._closing:
                raise BrokenOffError
            self._at_work = get_ident()
        try:
            with one_thread(), speaking(self._language):
                return work()
        finally:
            with self._lock:
                self._at_work = None

    def _think(self) -> None:
        """Let the desk do what can wait."""
        self._submitted(lambda: self.desk.think()).add_done_callback(self._told)

    def _told(self, done: Future[None]) -> None:
        """Say on stderr what went wrong where nobody waits for an answer."""
        failure = done.exception()
        if failure is not None and not self._ending:
            logging.getLogger(__name__).error("axiscal: %s: %s", type(failure).__name__, failure)

    def _publish(self, state: shapes.StateShape) -> None:
        """Take a new state from the campaign's thread."""
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._take, state)

    def _take(self, state: shapes.StateShape) -> None:
        news, self._news, self.state = self._news, asyncio.Event(), state
        news.set()


_FILES = ("page.css", "elements.js", "page.js", "pictures.js", "words.js", "icon.svg")


def application(counter: Counter, port: int) -> Guard:
    """Return the whole page behind its guard."""
    api = _Api(counter)

    @asynccontextmanager
    async def watching(app: FastAPI) -> AsyncIterator[None]:
        watch = asyncio.create_task(counter.watch())
        yield
        watch.cancel()

    app = page_application(
        "page.html",
        _FILES,
        title="axiscal, the readings of one campaign",
        version="1",
        openapi_url=f"{ROOT}/openapi.json",
        lifespan=watching,
    )
    app.get("/report.html", include_in_schema=False)(api.report)
    app.get("/setup.svg", include_in_schema=False)(api.setup_picture)
    app.get(f"{ROOT}/state", response_model=shapes.StateShape)(api.state)
    app.get(f"{ROOT}/typed", response_model=shapes.TypedShape)(api.typed)
    app.get(f"{ROOT}/cost", response_model=shapes.CostShape)(api.cost)
    app.post(f"{ROOT}/readings", response_model=shapes.DoneShape)(api.keep)
    app.post(f"{ROOT}/skips", response_model=shapes.DoneShape)(api.skip)
    app.post(f"{ROOT}/notes", response_model=shapes.DoneShape)(api.note)
    app.post(f"{ROOT}/zeros", response_model=shapes.DoneShape)(api.set_anew)
    app.post(f"{ROOT}/undo", response_model=shapes.DoneShape)(api.undo)
    app.post(f"{ROOT}/next", response_model=shapes.DoneShape)(api.go_on)
    app.post(f"{ROOT}/finish", response_model=shapes.DoneShape)(api.finish)
    return Guard(app, port)


class _Api:
    """What the routes answer; the description of the API says of each what stands here."""

    def __init__(self, counter: Counter) -> None:
        self._counter = counter

    async def state(self, query: Annotated[shapes.WaitQuery, Query()]) -> Response:
        """All that the page shows, at once or when it is newer than what was seen."""
        return document(await self._counter.newer(query.seen, query.wait))

    async def typed(self, query: Annotated[shapes.TypedQuery, Query()]) -> Response:
        """What a typed text would mean for the question that is open."""
        return document(self._counter.desk.read(query.text))

    async def cost(self, query: Annotated[shapes.CostQuery, Query()]) -> Response:
        """What skipping the reading costs, or leaving its set-up."""
        return document(await self._counter.ask(lambda desk: desk.cost(rest=query.rest)))

    async def setup_picture(self, query: Annotated[shapes.PictureQuery, Query()]) -> Response:
        """The machine with the instrument on it and the places that are read, as wide as the page has room."""
        drawn = await self._counter.ask(lambda desk: desk.setup_picture(query.width))
        if not drawn:
            return Response(status_code=204)  # what was asked has been answered in the meantime
        return Response(drawn, media_type="image/svg+xml")

    async def keep(self, asked: shapes.KeepRequest) -> Response:
        """Keep a reading of what is asked."""
        how = {"keep": asked.keep, "vouch": asked.vouch, "anew": asked.anew}
        return await self._done(lambda desk: desk.keep(asked.after, asked.text, **how))

    async def skip(self, asked: shapes.SkipRequest) -> Response:
        """Note that the reading asked for cannot be taken."""
        return await self._done(lambda desk: desk.skip(asked.after, asked.reason, rest=asked.rest))

    async def note(self, asked: shapes.NoteRequest) -> Response:
        """Keep a sentence in the record."""
        return await self._done(lambda desk: desk.note(asked.text))

    async def set_anew(self, asked: shapes.AnewRequest) -> Response:
        """Note that a zero was set anew, bumped or mounted again."""
        return await self._done(lambda desk: desk.set_anew(asked.after, asked=asked.asked))

    async def undo(self, asked: shapes.StepRequest) -> Response:
        """Take back the last reading, skip or end."""
        return await self._done(lambda desk: desk.undo(asked.after))

    async def go_on(self, asked: shapes.StepRequest) -> Response:
        """Ask for one more reading although a target is reached."""
        return await self._done(lambda desk: desk.go_on(asked.after))

    async def finish(self, asked: shapes.StepRequest) -> Response:
        """End the campaign and write its results beside the record."""
        return await self._done(lambda desk: desk.finish(asked.after))

    async def report(self) -> Response:
        """The report, which allows its own scripts by their hashes and asks for nothing."""
        desk = self._counter.desk
        file, folder = desk.results / "report.html", desk.campaign.path.absolute().parent
        if not file.is_file() or file.resolve().parent.parent != folder.resolve():
            return problem(404, "missing", "There is no report yet")
        return FileResponse(file, media_type="text/html", headers={"Content-Security-Policy": "frame-ancestors 'none'"})

    async def _done(self, step: Callable[[Desk], str]) -> Response:
        said = await self._counter.do(step)
        return document(shapes.DoneShape(sentence=said, state=await self._counter.newer(0, 0.0)))


_LOOPBACK = "127.0.0.1"
_ASKING, _BURST, _PATIENCE, _HEAD = 100, 100, 5.0, 16 * 1024
"""Connections that have not asked to the end; those taken in at once; seconds to ask in; bytes of a request's head."""


def serve_record(record: Path, port: int, ready: Callable[[str], None]) -> str:
    """Serve the page of a record until Ctrl-C; return a sentence on what was broken off, "" where nothing was.

    Page and answers are in the language that is spoken.
    port : 0 is any that is free; ready : called with the address once the page answers
    Raises RecordError if that is no record, InputError if the port is taken.
    """
    counter = Counter(record)
    try:
        with _listening(port) as listener:
            page = application(counter, int(listener.getsockname()[1]))
            config = uvicorn.Config(
                page,
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
            server = _Server(config, counter.end, lambda: ready(page.address))
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
