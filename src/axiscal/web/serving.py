"""The API of the page and the server that answers it."""

from __future__ import annotations

import asyncio
import os
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Annotated, Any

import uvicorn
from fastapi import Body, FastAPI, Response
from fastapi.responses import FileResponse
from pydantic import create_model

from axiscal.exceptions import InputError
from axiscal.present.answer import AnswerDocument
from axiscal.present.answer_of_campaign import cost_sentence, cost_words
from axiscal.present.guide.checking import CheckJudged, CheckToTake
from axiscal.present.guide.slips import Meant
from axiscal.present.sentences import spelt
from axiscal.web import draft, shapes
from axiscal.web.counter import Counter
from axiscal.web.desk import Desk
from axiscal.web.guard import ROOT, Guard, page_application, problem

_STEPS: dict[str, Callable[..., str]] = {
    "readings": Desk.keep,
    "jogs": Desk.jog,
    "accepts": Desk.accept,
    "skips": Desk.skip,
    "notes": Desk.note,
    "zeros": Desk.set_anew,
    "undo": Desk.undo,
    "next": Desk.go_on,
    "finish": Desk.finish,
}
"""What a page may ask of the desk; a request holds what each takes, and but for a note which state it answers."""


def application(counter: Counter, port: int, here: Path, ready: Callable[[str], None]) -> Guard:
    """Return the whole page behind its guard.  here : the folder of what begins on it; ready : takes its address"""
    api = _Api(counter, here)

    @asynccontextmanager
    async def watching(app: FastAPI) -> AsyncIterator[None]:
        watch = asyncio.create_task(counter.watch())
        ready(guard.address)
        yield
        watch.cancel()

    app = page_application(
        lambda: "page.html" if counter.open else "start.html",
        title="axiscal, the readings of one campaign",
        version="1",
        openapi_url=f"{ROOT}/openapi.json",
        lifespan=watching,
    )
    for file in ("report.pdf", "tables.zip", "setup.svg", "volume.svg", "machine.svg"):
        app.get(f"/{file}", include_in_schema=False)(getattr(api, file.replace(".", "_")))
    for name in ("start", "stage", "plan", "curve", "planned", "rows"):
        app.get(f"{ROOT}/{name}")(getattr(api, name))
    for name in ("typed", "cost", "check"):
        app.get(f"{ROOT}/{name}")(getattr(api, name))
    app.get(f"{ROOT}/state")(counter.newer)
    posted: dict[str, _Answering] = {name: api.doing(step) for name, step in _STEPS.items()}
    posted |= {"draft": api.draft, "open": api.open, "leave": counter.leave, "check": api.judge}
    for name, answering in posted.items():
        app.post(f"{ROOT}/{name}")(answering)
    guard = Guard(app, port)
    return guard


_picture = partial(Response, media_type="image/svg+xml")
_Answering = Callable[..., Awaitable[AnswerDocument | None]]
"""Makes the document that answers a request."""
_Sent = Annotated[shapes.Short, Body(embed=True)]
"""The only field of what is sent."""


class _Api:
    """What the routes answer; the description of the API says of each what stands here."""

    def __init__(self, counter: Counter, here: Path) -> None:
        self._counter, self._here = counter, here

    def doing(self, step: Callable[..., str]) -> _Answering:
        """Return what answers requests for a step of the desk with the state after it."""
        takes = {each.name: each for each in [*signature(step, eval_str=True).parameters.values()][1:]}
        fields: dict[str, Any] = {
            name: (each.annotation, ... if each.default is each.empty else each.default) for name, each in takes.items()
        }
        fields |= {} if step is Desk.note else {"after": (shapes.After, ...)}

        async def done(asked: AnswerDocument) -> shapes.DoneShape:
            given = dict(asked)
            after = given.pop("after", None)
            sentence = await self._counter.ask(lambda desk: desk.once(partial(step, **given), after))
            return shapes.DoneShape(sentence=spelt(sentence), state=self._counter.desk.state)

        done.__name__, done.__doc__ = step.__name__, step.__doc__
        done.__annotations__["asked"] = create_model(f"{step.__name__}_request", __base__=AnswerDocument, **fields)
        return done

    async def typed(self, text: shapes.Short) -> Meant:
        """What a typed text would mean for the question that is open."""
        desk = self._counter.desk
        return Meant.of_text(desk.campaign, desk.state.question, text)

    async def cost(self, rest: bool = False) -> shapes.SentenceShape:
        """What skipping the reading costs, or leaving its set-up."""
        words = await self._counter.ask(lambda desk: cost_words(desk.campaign, rest=rest))
        return shapes.SentenceShape(sentence=spelt(cost_sentence(words)))

    async def check(self, control: shapes.Short) -> CheckToTake:
        """Where the tables of a control are to be checked."""
        return await self._counter.ask(lambda desk: CheckToTake.of(desk.campaign, control, desk.virtual))

    async def judge(self, asked: shapes.CheckedRequest) -> CheckJudged:
        """What readings without the tables and with them say."""
        return await self._counter.ask(lambda desk: desk.judge(**dict(asked)))

    async def setup_svg(self, width: shapes.Width, version: int = 0) -> Response:
        """The machine with the instrument on it and the places that are read, as wide as the page has room."""
        drawn = await self._counter.ask(lambda desk: desk.setup_picture(width))
        return _picture(drawn) if drawn else Response(status_code=204)  # what was asked has been answered meanwhile

    async def volume_svg(self, width: shapes.Width, version: int = 0) -> Response:
        """The error of the volume, found and left, as wide as the page has room."""
        return _picture(await self._counter.ask(lambda desk: desk.volume_picture(width)))

    async def report_pdf(self) -> Response:
        """The report to sign."""
        desk = self._counter.desk
        file, folder = desk.results / "report.pdf", desk.campaign.path.absolute().parent
        if not file.is_file() or file.resolve().parent.parent != folder.resolve():
            return problem(404, "missing", "There is no report yet")
        return FileResponse(file, headers={"Content-Disposition": "attachment"})

    async def tables_zip(self, control: shapes.Short) -> Response:
        """The tables of a control as one file."""
        packed = await self._counter.ask(lambda desk: desk.tables_packed(control))
        headers = {"Content-Disposition": f'attachment; filename="{control}.zip"'}
        return Response(packed, media_type="application/zip", headers=headers)

    async def start(self) -> shapes.StartShape:
        """All that the start shows."""
        return draft.start(self._here)

    async def stage(self) -> shapes.SentenceShape:
        """What is being computed."""
        return shapes.SentenceShape(sentence=self._counter.stage)

    async def draft(self, chosen: shapes.DraftShape) -> shapes.MachineShape:
        """Keep what was chosen of a new campaign, and say what that makes of its machine."""
        return draft.keep(self._here, chosen)

    def machine_svg(
        self,
        width: shapes.Width,
        machine: shapes.Short = "",
        instrument: shapes.Short = "",
        small: bool = False,
        version: int = 0,
    ) -> Response:
        """A machine, that of the draft if none is named, with an instrument on it if one is; small : without words."""
        return _picture(draft.picture(self._here, width, machine, instrument, lengths=not small))

    async def plan(self) -> shapes.PlanShape | None:
        """The plan of the draft in words; it takes seconds."""
        return await self._counter.draw_up(partial(draft.plan, self._here))

    async def curve(self) -> shapes.CurveShape | None:
        """What other minutes than those of the plan buy; null where there is no plan, which says why."""
        with suppress(InputError):  # a newer choice stands already that nothing can be planned for
            return await self._counter.draw_up(partial(draft.curve, self._here))
        return None

    async def planned(self) -> None:
        """Make the plan of the draft in full, before it begins, unless a newer choice breaks it off."""
        await self._counter.draw_up(partial(draft.plan_in_full, self._here))

    def rows(self, instrument: shapes.Short) -> shapes.RowsShape:
        """The rows that an instrument can show on the machine of the draft."""
        return draft.shown_rows(self._here, instrument)

    async def open(self, record: _Sent) -> shapes.DoneShape:
        """Open a campaign of the start, or begin that of the draft and open it, for ""."""
        begun = self._counter.begin(partial(draft.record_of, self._here, record), breaks=record != "")
        return shapes.DoneShape(sentence=await begun, state=self._counter.desk.state)


_HEAD = 16 * 1024
"""Bytes of a request's head; any that a browser sends is smaller."""


def serve_page(record: Path | None, port: int, ready: Callable[[str], None]) -> str:
    """Serve the page of a record, or the start of one in this folder, until Ctrl-C.

    Returns a sentence on what was broken off, "" where nothing was.

    Page and answers are in the language that is spoken.
    port : 0 is any that is free; ready : called with the address once the page answers
    Raises RecordError if that is no record, InputError if the port is taken.
    """
    counter = Counter(record)
    try:
        with _listening(port) as listener:
            page = application(counter, int(listener.getsockname()[1]), Path.cwd(), ready)
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
        left = counter.close()
    return left


def _listening(port: int) -> socket.socket:
    """Return what listens on this computer alone; raises InputError where that cannot be."""
    try:
        return socket.create_server(("127.0.0.1", port))
    except OSError as failure:
        what, remedy = "Port {port} cannot be used: {reason}", "Name another one with --port"
        raise InputError(what, remedy, port=port, reason=os.strerror(failure.errno or 0)) from failure
