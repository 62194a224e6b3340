"""The routes of a campaign: the page, its files, and the JSON API, version 1."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from functools import partial
from typing import TypeVar

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Route

from axiscal.language.spoken import LANGUAGES
from axiscal.web.answering import answered, defect, language_of, not_here, static_routes, words
from axiscal.web.counter import Counter
from axiscal.web.desk import Desk
from axiscal.web.guard import Admission, Guard
from axiscal.web.openapi import ROOT, description
from axiscal.web.problems import document, problem
from axiscal.web.shapes import (
    CostQuery,
    DoneShape,
    KeepRequest,
    NoteRequest,
    PictureQuery,
    Shape,
    SkipRequest,
    StepRequest,
    TableQuery,
    TypedQuery,
    WaitQuery,
)

_FILES = ("page.css", "elements.js", "page.js", "pictures.js", "words.js", "icon.svg")
_Answer = Callable[[Request], Awaitable[Response]]
_Body = TypeVar("_Body", bound=Shape)


def application(counter: Counter, admitted: Admission) -> Guard:
    """Return the whole page behind its guard."""
    api = _Api(counter)
    steps = {"readings": api.keep, "skips": api.skip, "notes": api.note, "undo": api.undo, "next": api.go_on}
    steps["finish"] = api.finish
    routes = [
        *static_routes("page.html", _FILES),
        Route("/words.json", api.words, methods=["GET"]),
        Route("/report.html", api.report, methods=["GET"]),
        Route("/setup.svg", api.setup_picture, methods=["GET"]),
        Route(f"{ROOT}/openapi.json", _described, methods=["GET"]),
        Route(f"{ROOT}/state", api.state, methods=["GET"]),
        Route(f"{ROOT}/typed", api.typed, methods=["GET"]),
        Route(f"{ROOT}/table", api.table, methods=["GET"]),
        Route(f"{ROOT}/cost", api.cost, methods=["GET"]),
        *(Route(f"{ROOT}/{name}", answer, methods=["POST"]) for name, answer in steps.items()),
    ]
    app = Starlette(
        routes=routes, exception_handlers={HTTPException: not_here, Exception: defect}, lifespan=_watching(counter)
    )
    app.router.redirect_slashes = False
    return Guard(app, admitted)


class _Api:
    """What the routes answer."""

    def __init__(self, counter: Counter) -> None:
        self._counter = counter

    async def state(self, request: Request) -> Response:
        async def found(query: WaitQuery) -> Response:
            return document(await self._counter.newer(query.seen, query.wait, language_of(request)))

        return await answered(WaitQuery, dict(request.query_params), found)

    async def typed(self, request: Request) -> Response:
        async def found(query: TypedQuery) -> Response:
            return document(self._counter.read(query.text, language_of(request)))

        return await answered(TypedQuery, dict(request.query_params), found)

    async def words(self, request: Request) -> Response:
        return words(self._counter.language)

    async def table(self, request: Request) -> Response:
        return await answered(TableQuery, dict(request.query_params), self._table)

    async def _table(self, query: TableQuery) -> Response:
        return await self._looked(lambda desk: desk.table(query.control))

    async def cost(self, request: Request) -> Response:
        async def found(query: CostQuery) -> Response:
            language = language_of(request)
            return await self._looked(lambda desk: desk.cost(rest=query.rest, language=language))

        return await answered(CostQuery, dict(request.query_params), found)

    async def setup_picture(self, request: Request) -> Response:
        """The machine with the instrument on it and the places that are read, as wide as the page has room."""
        return await answered(PictureQuery, dict(request.query_params), self._pictured)

    async def _pictured(self, query: PictureQuery) -> Response:
        language = query.language if query.language in LANGUAGES else "en"
        drawn = await self._counter.ask(lambda desk: desk.setup_picture(query.width), language)
        if not drawn:
            return Response(status_code=204)  # what was asked has been answered in the meantime
        return Response(drawn, media_type="image/svg+xml")

    async def _looked(self, look: Callable[[Desk], Shape]) -> Response:
        return document(await self._counter.ask(look))

    async def keep(self, request: Request) -> Response:
        return await self._step(KeepRequest, request, lambda r: partial(_keep, r))

    async def skip(self, request: Request) -> Response:
        return await self._step(SkipRequest, request, lambda r: lambda desk: desk.skip(r.after, r.reason, rest=r.rest))

    async def note(self, request: Request) -> Response:
        return await self._step(NoteRequest, request, lambda r: lambda desk: desk.note(r.text))

    async def undo(self, request: Request) -> Response:
        return await self._step(StepRequest, request, lambda r: lambda desk: desk.undo(r.after))

    async def go_on(self, request: Request) -> Response:
        return await self._step(StepRequest, request, lambda r: lambda desk: desk.go_on(r.after))

    async def finish(self, request: Request) -> Response:
        return await self._step(StepRequest, request, lambda r: lambda desk: desk.finish(r.after))

    async def report(self, request: Request) -> Response:
        """The report, which allows its own scripts by their hashes and asks for nothing."""
        file = self._counter.report
        if not file.is_file() or file.resolve().parent.parent != self._counter.folder.resolve():
            return problem(404, "missing", "There is no report yet")
        return FileResponse(file, media_type="text/html", headers={"Content-Security-Policy": "frame-ancestors 'none'"})

    async def _step(
        self, kind: type[_Body], request: Request, step: Callable[[_Body], Callable[[Desk], str]]
    ) -> Response:
        async def done(body: _Body) -> Response:
            language = language_of(request)
            said = await self._counter.do(step(body), language)
            return document(DoneShape(sentence=said, state=await self._counter.newer(0, 0.0, language)))

        return await answered(kind, await request.body(), done)


def _keep(request: KeepRequest, desk: Desk) -> str:
    return desk.keep(request.after, request.text, keep=request.keep, vouch=request.vouch)


async def _described(request: Request) -> Response:
    return JSONResponse(description())


def _watching(counter: Counter) -> Callable[[Starlette], AbstractAsyncContextManager[None]]:
    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        watch = asyncio.create_task(counter.watch())
        yield
        watch.cancel()

    return lifespan
