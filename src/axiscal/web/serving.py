"""The API of the page and the server that answers it."""

from __future__ import annotations

import asyncio
import io
import logging
import socket
import zipfile
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from pathlib import Path
from types import FrameType
from typing import Annotated

import uvicorn
from fastapi import FastAPI, Query, Request, Response
from fastapi.responses import FileResponse
from uvicorn.protocols.http.h11_impl import H11Protocol

from axiscal.answers.answer import AnswerDocument
from axiscal.exceptions import InputError, OvertakenError
from axiscal.language.spoken import said
from axiscal.record.signing import writing
from axiscal.web import after_end, draft, shapes
from axiscal.web.counter import Counter, lost_interruptions
from axiscal.web.desk import Desk
from axiscal.web.guard import DEVICES, ROOT, Addresses, Guard, document, page_application, problem
from axiscal.web.shop import LOOPBACK, Code, Device, ShopDoor, listening

_SCRIPTS = ("elements", "start", "page", "after", "pictures", "shop", "outbox", "words")
_FILES = ("page.css", "icon.svg", *(f"{name}.js" for name in _SCRIPTS))


def application(counter: Counter, port: int, here: Path, shop: ShopDoor | None = None) -> Guard:
    """Return the whole page behind its guard.  here : the folder of what begins on it"""
    addresses = Addresses()
    api = _Api(counter, here, addresses, shop)

    @asynccontextmanager
    async def watching(app: FastAPI) -> AsyncIterator[None]:
        watch = asyncio.create_task(counter.watch())
        yield
        watch.cancel()

    app = page_application(
        lambda: "page.html" if counter.open else "start.html",
        _FILES,
        title="axiscal, the readings of one campaign",
        version="1",
        openapi_url=f"{ROOT}/openapi.json",
        lifespan=watching,
    )
    app.get("/report.html", include_in_schema=False)(api.report)
    app.get("/report.pdf", include_in_schema=False)(api.pdf)
    app.get("/tables.zip", include_in_schema=False)(api.tables)
    app.get("/setup.svg", include_in_schema=False)(api.setup_picture)
    app.get("/machine.svg", include_in_schema=False)(api.machine_picture)
    app.post(f"{ROOT}/addresses", response_model=shapes.AddressShape)(api.once)
    app.get(f"{ROOT}/start", response_model=shapes.StartShape)(api.start)
    app.get(f"{ROOT}/stage", response_model=shapes.StageShape)(api.stage)
    app.get(f"{ROOT}/plan", response_model=shapes.PlanShape | None)(api.plan)
    app.get(f"{ROOT}/curve", response_model=shapes.CurveShape | None)(api.curve)
    app.get(f"{ROOT}/rows", response_model=shapes.RowsShape)(api.shown_rows)
    app.post(f"{ROOT}/draft", response_model=shapes.MachineShape)(api.choose)
    app.post(f"{ROOT}/open", response_model=shapes.DoneShape)(api.open)
    app.get(f"{ROOT}/state", response_model=shapes.StateShape)(api.state)
    app.get(f"{ROOT}/typed", response_model=shapes.TypedShape)(api.typed)
    app.get(f"{ROOT}/cost", response_model=shapes.SentenceShape)(api.cost)
    app.post(f"{ROOT}/readings", response_model=shapes.DoneShape)(api.keep)
    app.post(f"{ROOT}/jogs", response_model=shapes.DoneShape)(api.jog)
    app.post(f"{ROOT}/accepts", response_model=shapes.DoneShape)(api.accept)
    app.post(f"{ROOT}/leave", response_model=shapes.StageShape)(api.leave)
    app.get(f"{ROOT}/texts", response_model=shapes.TextsShape)(api.table_texts)
    app.post(f"{ROOT}/load", response_model=shapes.DoneShape)(api.put_into)
    app.get(f"{ROOT}/again", response_model=shapes.SentenceShape)(api.again)
    app.get(f"{ROOT}/check", response_model=shapes.CheckShape)(api.check)
    app.post(f"{ROOT}/check", response_model=shapes.CheckedShape)(api.judge)
    app.post(f"{ROOT}/skips", response_model=shapes.DoneShape)(api.skip)
    app.post(f"{ROOT}/notes", response_model=shapes.DoneShape)(api.note)
    app.post(f"{ROOT}/zeros", response_model=shapes.DoneShape)(api.set_anew)
    app.post(f"{ROOT}/undo", response_model=shapes.DoneShape)(api.undo)
    app.post(f"{ROOT}/next", response_model=shapes.DoneShape)(api.go_on)
    app.post(f"{ROOT}/finish", response_model=shapes.DoneShape)(api.finish)
    app.post(f"{ROOT}/codes", response_model=Code)(api.code)
    app.post(DEVICES, response_model=Device)(api.let_in)
    free = {"/", "/words.json", *(f"/{name}" for name in _FILES)}
    return Guard(app, port, free, addresses, None if shop is None else shop.door)


class _Api:
    """What the routes answer; the description of the API says of each what stands here."""

    def __init__(self, counter: Counter, here: Path, addresses: Addresses, shop: ShopDoor | None) -> None:
        self._counter, self._here, self._addresses, self._shop = counter, here, addresses, shop

    async def once(self, asked: shapes.AddressRequest) -> Response:
        """Return an address that answers one request within a minute, for a picture, a download or the report."""
        return document(shapes.AddressShape(address=self._addresses.once(asked.path)))

    async def code(self, asked: shapes.CodeRequest, request: Request) -> Response:
        """Return a code that lets a device of a person in; only the page of this computer may ask."""
        if request.url.scheme != "http":
            return problem(403, "forbidden", "Codes are shown at the computer alone")
        return document(self._open_shop().code(asked.person))

    async def let_in(self, asked: shapes.DeviceRequest) -> Response:
        """Return the bearer of a device that comes with a code, which does so once."""
        return document(self._open_shop().let_in(asked.code))

    def _open_shop(self) -> ShopDoor:
        if self._shop is None:
            raise InputError(said("No device can come in"), said("End axiscal serve, and start axiscal serve --shop"))
        return self._shop

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
        return await self._done(asked.step, asked.after, lambda desk: desk.keep(asked.text, asked.cause))

    async def jog(self, asked: shapes.JogRequest) -> Response:
        """Keep what the display shows at the test of its sign."""
        return await self._done(asked.step, asked.after, lambda desk: desk.jog(asked.text, anyway=asked.anyway))

    async def skip(self, asked: shapes.SkipRequest) -> Response:
        """Note that the reading asked for cannot be taken."""
        return await self._done(asked.step, asked.after, lambda desk: desk.skip(asked.reason, rest=asked.rest))

    async def note(self, asked: shapes.NoteRequest) -> Response:
        """Keep a sentence in the record."""
        return await self._done(asked.step, None, lambda desk: desk.note(asked.text))

    async def set_anew(self, asked: shapes.AnewRequest) -> Response:
        """Note that a zero was set anew, bumped or mounted again."""
        return await self._done(asked.step, asked.after, lambda desk: desk.set_anew(asked.answer))

    async def undo(self, asked: shapes.StepRequest) -> Response:
        """Take back the last reading, skip or end."""
        return await self._done(asked.step, asked.after, lambda desk: desk.undo())

    async def go_on(self, asked: shapes.StepRequest) -> Response:
        """Ask for one more reading although a target is reached."""
        return await self._done(asked.step, asked.after, lambda desk: desk.go_on())

    async def finish(self, asked: shapes.StepRequest) -> Response:
        """End the campaign and write its results beside the record."""
        return await self._done(asked.step, asked.after, lambda desk: desk.finish())

    async def report(self) -> Response:
        """The report, which allows its own scripts by their hashes and asks for nothing."""
        return self._result("report.html", {"Content-Security-Policy": "frame-ancestors 'none'"})

    async def pdf(self) -> Response:
        """The report to sign."""
        return self._result("report.pdf", {"Content-Disposition": "attachment"})

    async def tables(self, query: Annotated[shapes.TablesQuery, Query()]) -> Response:
        """The tables of a control as one file."""
        made, packed = await self._counter.ask(lambda desk: after_end.table_texts(desk, query.control)), io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, text in made.files.items():
                archive.writestr(f"{made.control}/{name}", text)
        headers = {"Content-Disposition": f'attachment; filename="{made.control}.zip"'}
        return Response(packed.getvalue(), media_type="application/zip", headers=headers)

    async def table_texts(self, query: Annotated[shapes.TablesQuery, Query()]) -> Response:
        """The tables of a control as texts to copy."""
        return document(await self._counter.ask(lambda desk: after_end.table_texts(desk, query.control)))

    async def put_into(self, asked: shapes.LoadRequest) -> Response:
        """Put the tables into a printer."""
        return await self._done("", None, lambda desk: after_end.put_into(desk, asked.control, asked.printer))

    async def again(self) -> Response:
        """When the machine is to be measured again."""
        record = self._counter.desk.campaign.path
        sentence = await asyncio.to_thread(after_end.measure_again, record, draft.record_files(self._here))
        return document(shapes.SentenceShape(sentence=sentence))

    async def check(self, query: Annotated[shapes.TablesQuery, Query()]) -> Response:
        """Where the tables of a control are to be checked."""
        return document(await self._counter.ask(lambda desk: after_end.check(desk, query.control)))

    async def judge(self, asked: shapes.CheckedRequest) -> Response:
        """What readings without the tables and with them say."""
        return document(await self._counter.ask(lambda desk: after_end.judge(desk, asked)))

    async def accept(self, asked: shapes.StepRequest) -> Response:
        """Put right the mistake that readings name."""
        return await self._done(asked.step, asked.after, lambda desk: desk.accept())

    async def leave(self) -> Response:
        """Close the record, and show the start again."""
        await self._counter.leave()
        return document(shapes.StageShape(stage=""))

    def _result(self, name: str, headers: Mapping[str, str]) -> Response:
        desk = self._counter.desk
        file, folder = desk.results / name, desk.campaign.path.absolute().parent
        if not file.is_file() or file.resolve().parent.parent != folder.resolve():
            return problem(404, "missing", "There is no report yet")
        return FileResponse(file, headers=headers)

    async def _done(self, own: str, after: int | None, step: Callable[[Desk], str]) -> Response:
        with writing(step=own):
            sentence = await self._counter.do(lambda desk: desk.once(step, after))
        return document(shapes.DoneShape(sentence=sentence, state=await self._counter.newer(0, 0.0)))

    async def start(self) -> Response:
        """All that the start shows."""
        return document(draft.start(self._here))

    async def stage(self) -> Response:
        """What is being computed."""
        return document(shapes.StageShape(stage=self._counter.stage))

    async def choose(self, chosen: shapes.DraftShape) -> Response:
        """Keep what was chosen of a new campaign, and say what that makes of its machine."""
        return document(draft.keep(self._here, chosen))

    async def machine_picture(self, query: Annotated[shapes.MachineQuery, Query()]) -> Response:
        """A machine, with an instrument on it if one is named."""
        drawn = await asyncio.to_thread(draft.picture, self._here, query)
        return Response(drawn, media_type="image/svg+xml")

    async def plan(self) -> Response:
        """The plan of the draft in words; it takes seconds."""
        return await self._drawn_up(draft.plan)

    async def curve(self) -> Response:
        """What other minutes than those of the plan buy; it takes seconds."""
        return await self._drawn_up(draft.curve)

    async def shown_rows(self, query: Annotated[shapes.RowsQuery, Query()]) -> Response:
        """The rows that an instrument can show on the machine of the draft."""
        return document(await asyncio.to_thread(draft.shown_rows, self._here, query.instrument))

    async def _drawn_up(self, made: Callable[[Path], AnswerDocument]) -> Response:
        """Return what is made of the draft, null where a newer choice has broken it off."""
        try:
            return document(await self._counter.draw_up(lambda: made(self._here)))
        except OvertakenError:
            return Response("null", media_type="application/json")

    async def open(self, asked: shapes.OpenRequest) -> Response:
        """Open a campaign of the start, or begin that of the draft and open it."""
        sentence = await self._counter.begin(lambda: draft.record_of(self._here, asked.record))
        return document(shapes.DoneShape(sentence=sentence, state=await self._counter.newer(0, 0.0)))


_ASKING, _BURST, _PATIENCE, _HEAD = 100, 100, 5.0, 16 * 1024
"""Connections that have not asked to the end; those taken in at once; seconds to ask in; bytes of a request's head."""


@lost_interruptions()
def serve_page(record: Path | None, port: int, ready: Callable[[str], None], shop: ShopDoor | None = None) -> str:
    """Serve the page of a record, or the start of one in this folder, until Ctrl-C.

    Returns a sentence on what was broken off, "" where nothing was.

    Page and answers are in the language that is spoken.
    port : 0 is any that is free; ready : called with the address once the page answers; shop : lets devices in
    Raises RecordError if that is no record, InputError if the port is taken.
    """
    counter = Counter(record)
    try:
        with listening(LOOPBACK, port) as listener:
            page = application(counter, int(listener.getsockname()[1]), Path.cwd(), shop)
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
            server = _Server(config, counter.end, lambda: ready(page.address), shop)
            server.run(sockets=[listener])
    except KeyboardInterrupt:
        pass  # the way in which a server is ended
    finally:
        left = counter.close()
    return left


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

    def __init__(
        self, config: uvicorn.Config, ending: Callable[[], None], ready: Callable[[], None], shop: ShopDoor | None
    ) -> None:
        super().__init__(config)
        self._ending, self._ready, self._shop = ending, ready, shop

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to answer, and say so: from here on a signal ends it as it should."""
        await super().startup(sockets)
        if self._shop is not None:
            self.servers.append(await self._listening_to(self._shop))
        self._ready()

    async def _listening_to(self, shop: ShopDoor) -> asyncio.Server:
        """Return what takes in the devices of the shop, which has to greet in time, too."""
        loop = asyncio.get_running_loop()
        return await loop.create_server(
            lambda: _Caller(self.config, self.server_state, self.lifespan.state, loop),
            sock=shop.listener,
            ssl=shop.context,
            ssl_handshake_timeout=_PATIENCE,
            backlog=_BURST,
        )

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Take a signal to end; who still waits for an answer then is sent away, which is no fault to be told of."""
        logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)
        self._ending()
        super().handle_exit(sig, frame)
