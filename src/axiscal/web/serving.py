"""The API of the page and the server that answers it: steps wait in one row, each on a thread of the server."""

from __future__ import annotations

import asyncio
import logging
import os
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from functools import partial
from inspect import signature
from pathlib import Path
from threading import Lock
from typing import Annotated, Any, TypeVar

import uvicorn
from anyio import CapacityLimiter, to_thread
from fastapi import Body, FastAPI, Response
from fastapi.responses import FileResponse
from pydantic import create_model

from axiscal.campaign.campaign import Campaign
from axiscal.document.consent import asking, nobody
from axiscal.exceptions import InputError, OvertakenError, RecordError
from axiscal.language.spoken import said
from axiscal.language.stages import Listener, listening
from axiscal.present.answer import AnswerDocument
from axiscal.present.answer_of_campaign import cost_sentence, cost_words
from axiscal.present.guide.actions import Short
from axiscal.present.guide.checking import CheckJudged, CheckToTake
from axiscal.present.guide.slips import Meant
from axiscal.present.sentences import spelt
from axiscal.web import draft, shapes
from axiscal.web.desk import STEPS, Desk, Step
from axiscal.web.guard import ROOT, Guard, page_application, problem
from axiscal_core.threads import one_thread

_NEARLY = 0.5
"""s that work which is nearly done is waited for."""
_LOOKS, _GLANCES = 0.25, 0.05
"""s between looks at the record, so that what others write is shown within a second; and at the state that is shown."""
_Result = TypeVar("_Result")


def application(api: Api, port: int, ready: Callable[[str], None]) -> Guard:
    """Return the whole page behind its guard.  ready : takes its address"""

    @asynccontextmanager
    async def watching(app: FastAPI) -> AsyncIterator[None]:
        watch = asyncio.create_task(api.watch())
        ready(guard.address)
        yield
        watch.cancel()

    app = page_application(
        lambda: "page.html" if api.desk_open else "start.html",
        title="axiscal, the readings of one campaign",
        version="1",
        openapi_url=f"{ROOT}/openapi.json",
        lifespan=watching,
    )
    for file in ("report.pdf", "tables.zip", "setup.svg", "volume.svg", "machine.svg"):
        app.get(f"/{file}", include_in_schema=False)(getattr(api, file.replace(".", "_")))
    for name in ("start", "stage", "plan", "curve", "rows", "typed", "cost", "check", "state"):
        app.get(f"{ROOT}/{name}")(getattr(api, name))
    posted: dict[str, _Answering] = {name: api.doing(step) for name, step in STEPS.items()}
    posted |= {"draft": api.draft, "open": api.open, "leave": api.leave, "check": api.judge}
    for name, answering in posted.items():
        app.post(f"{ROOT}/{name}")(answering)
    guard = Guard(app, port)
    return guard


_picture = partial(Response, media_type="image/svg+xml")
_Answering = Callable[..., Awaitable[AnswerDocument | None]]
"""Makes the document that answers a request."""
_Sent = Annotated[Short, Body(embed=True)]
"""The only field of what is sent."""


class Api:
    """What the routes answer; the description of the API says of each what stands here.

    Work is done one after another, in the language, and by the person, of who asks for it.

    record : None for none yet, raises RecordError if that is none; here : the folder of what begins on the page
    """

    def __init__(self, record: Path | None, here: Path) -> None:
        self._here, self._row, self._busy, self._drawn = here, CapacityLimiter(1), Lock(), 0
        self._stages = list[str]()
        with asking(nobody):
            self._desk = None if record is None else Desk(Campaign.open(record))

    @property
    def desk_open(self) -> bool:
        """Whether there is a record."""
        return self._desk is not None

    @property
    def desk(self) -> Desk:
        """The desk, for what changes nothing and needs no thread; raises RecordError where no record is open."""
        if self._desk is None:
            raise RecordError("No campaign is open on this page", "Begin one, or go on with one, at its start")
        return self._desk

    async def leave(self) -> None:
        """Close the record after the steps that are under way, and show the start again."""

        def closed() -> None:
            self.desk.campaign.close()
            self._desk = None

        await self._done(closed)

    async def draw_up(self, work: Callable[[], _Result]) -> _Result | None:
        """Return what a function of the draft returns, None where a newer one came before it was done."""
        self._drawn += 1
        number = self._drawn
        made = await self._done(lambda: work() if number == self._drawn else None)
        return made if number == self._drawn else None

    async def ask(self, look: Callable[[Desk], _Result]) -> _Result:
        """Return what the desk says to a step or a question, after the steps that are under way."""
        return await self._done(lambda: look(self.desk))

    async def watch(self) -> None:
        """Look at the record again and again, for what others write, and let the desk do what can wait."""
        while True:
            try:
                if self._desk is not None:
                    await self.ask(Desk.look)
            except Exception as failure:  # noqa: BLE001  (nobody waits for an answer)
                logging.getLogger(__name__).error("axiscal: %s: %s", type(failure).__name__, failure)
            await asyncio.sleep(_LOOKS)

    async def state(self, seen: shapes.Seen = 0, wait: shapes.Wait = 0.0) -> shapes.StateShape:
        """All that the page shows, as soon as its version is another one than `seen`, or after `wait` s."""
        with suppress(TimeoutError):
            async with asyncio.timeout(wait):
                while self.desk.state.version == seen:
                    await asyncio.sleep(_GLANCES)
        return self.desk.state

    def close(self) -> str:
        """Close the record; where something is still computed, return what to say of it before the process is ended."""
        if not self._busy.acquire(timeout=_NEARLY):
            return "What was being computed was broken off; what is kept is shown at the next start."
        if self._desk is not None:
            self._desk.campaign.close()
        return ""

    async def _done(self, work: Callable[[], _Result]) -> _Result:
        """Return what work returns that is done after all that was asked for before."""

        def done() -> _Result:
            with self._busy, one_thread(), listening(Listener(self._stages)):
                return work()

        return await to_thread.run_sync(done, abandon_on_cancel=True, limiter=self._row)

    def doing(self, step: Step) -> _Answering:
        """Return what answers requests for a step with the state after it; all but a note say what they answer."""
        takes = {each.name: each for each in [*signature(step, eval_str=True).parameters.values()][1:]}
        fields: dict[str, Any] = {
            name: (each.annotation, ... if each.default is each.empty else each.default) for name, each in takes.items()
        }
        fields |= {} if step is STEPS["notes"] else {"after": (shapes.After, ...)}

        async def done(asked: AnswerDocument) -> shapes.DoneShape:
            sentence = await self.ask(lambda desk: desk.once(step, **dict(asked)))
            return shapes.DoneShape(sentence=spelt(sentence), state=self.desk.state)

        done.__name__, done.__doc__ = step.__name__, step.__doc__
        done.__annotations__["asked"] = create_model(f"{step.__name__}_request", __base__=AnswerDocument, **fields)
        return done

    async def typed(self, text: Short) -> Meant:
        """What a typed text would mean for the question that is open."""
        desk = self.desk
        return Meant.of_text(desk.campaign, desk.state.question, text)

    async def cost(self, rest: bool = False) -> shapes.SentenceShape:
        """What skipping the reading costs, or leaving its set-up."""
        words = await self.ask(lambda desk: cost_words(desk.campaign, rest=rest))
        return shapes.SentenceShape(sentence=spelt(cost_sentence(words)))

    async def check(self, control: Short) -> CheckToTake:
        """Where the tables of a control are to be checked."""
        return await self.ask(lambda desk: CheckToTake.of(desk.campaign, control, desk.virtual))

    async def judge(self, asked: shapes.CheckedRequest) -> CheckJudged:
        """What readings without the tables and with them say."""
        return await self.ask(lambda desk: desk.judge(**dict(asked)))

    async def setup_svg(self, width: shapes.Width, version: int = 0) -> Response:
        """The machine with the instrument on it and the places that are read, as wide as the page has room."""
        drawn = await self.ask(lambda desk: desk.setup_picture(width))
        return _picture(drawn) if drawn else Response(status_code=204)  # what was asked has been answered meanwhile

    async def volume_svg(self, width: shapes.Width, version: int = 0) -> Response:
        """The error of the volume, found and left, as wide as the page has room."""
        return _picture(await self.ask(lambda desk: desk.volume_picture(width)))

    async def report_pdf(self) -> Response:
        """The report to sign."""
        desk = self.desk
        file, folder = desk.results / "report.pdf", desk.campaign.path.absolute().parent
        if not file.is_file() or file.resolve().parent.parent != folder.resolve():
            return problem(404, "missing", "There is no report yet")
        return FileResponse(file, headers={"Content-Disposition": "attachment"})

    async def tables_zip(self, control: Short) -> Response:
        """The tables of a control as one file."""
        packed = await self.ask(lambda desk: desk.tables_packed(control))
        headers = {"Content-Disposition": f'attachment; filename="{control}.zip"'}
        return Response(packed, media_type="application/zip", headers=headers)

    async def start(self) -> shapes.StartShape:
        """All that the start shows."""
        return draft.start(self._here)

    async def stage(self) -> shapes.SentenceShape:
        """What is being computed."""
        return shapes.SentenceShape(sentence=said(self._stages[-1]) if self._stages else "")

    async def draft(self, chosen: shapes.DraftShape) -> shapes.MachineShape:
        """Keep what was chosen of a new campaign, and say what that makes of its machine."""
        return draft.keep(self._here, chosen)

    def machine_svg(
        self,
        width: shapes.Width,
        machine: Short = "",
        instrument: Short = "",
        small: bool = False,
        version: int = 0,
    ) -> Response:
        """A machine, that of the draft if none is named, with an instrument on it if one is; small : without words."""
        return _picture(draft.picture(self._here, width, machine, instrument, lengths=not small))

    async def plan(self) -> shapes.PlanShape | None:
        """The plan of the draft in words; it takes seconds."""
        return await self.draw_up(partial(draft.plan, self._here))

    async def curve(self) -> shapes.CurveShape | None:
        """What other minutes than those of the plan buy; null where there is no plan, which says why."""
        with suppress(InputError):  # a newer choice stands already that nothing can be planned for
            return await self.draw_up(partial(draft.curve, self._here))
        return None

    def rows(self, instrument: Short) -> shapes.RowsShape:
        """The rows that an instrument can show on the machine of the draft."""
        return draft.shown_rows(self._here, instrument)

    async def open(self, record: _Sent) -> shapes.DoneShape:
        """Open a campaign of the start, or begin that of the draft and open it, for ""."""

        def opened() -> str:
            if self._desk is not None:
                what, remedy = "A campaign is open on this page already", "Load the page again"
                raise OvertakenError(what, remedy)
            file = draft.record_of(self._here, record)
            self._desk = Desk(Campaign.open(file))
            return said("{record} is open.", record=file.name)

        self._drawn += 1
        return shapes.DoneShape(sentence=await self._done(opened), state=self.desk.state)


_HEAD = 16 * 1024
"""Bytes of a request's head; any that a browser sends is smaller."""


def serve_page(record: Path | None, port: int, ready: Callable[[str], None]) -> str:
    """Serve the page of a record, or the start of one in this folder, until Ctrl-C.

    Returns a sentence on what was broken off, "" where nothing was.

    Page and answers are in the language that is spoken.
    port : 0 is any that is free; ready : called with the address once the page answers
    Raises RecordError if that is no record, InputError if the port is taken.
    """
    api = Api(record, Path.cwd())
    try:
        with _listening(port) as listener:
            page = application(api, int(listener.getsockname()[1]), ready)
            config = uvicorn.Config(
                page,
                http="h11",
                ws="none",
                log_level="error" if os.environ.get("AXISCAL_TRACEBACK") else "critical",  # of who still waits
                access_log=False,
                server_header=False,
                proxy_headers=False,
                timeout_graceful_shutdown=1,
                h11_max_incomplete_event_size=_HEAD,
            )
            uvicorn.Server(config).run(sockets=[listener])
    except KeyboardInterrupt:
        pass  # the way in which a server is ended
    finally:
        left = api.close()
    return left


def _listening(port: int) -> socket.socket:
    """Return what listens on this computer alone; raises InputError where that cannot be."""
    try:
        return socket.create_server(("127.0.0.1", port))
    except OSError as failure:
        what, remedy = "Port {port} cannot be used: {reason}", "Name another one with --port"
        raise InputError(what, remedy, port=port, reason=os.strerror(failure.errno or 0)) from failure
