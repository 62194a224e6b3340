"""The routes of the form that makes a first description."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from starlette.applications import Starlette
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from axiscal.language.spoken import speaking
from axiscal.web.answering import answered, defect, not_here, static_routes, words
from axiscal.web.first_desk import FirstDesk
from axiscal.web.first_shapes import FirstRequest, SourceQuery
from axiscal.web.guard import Admission, Guard
from axiscal.web.openapi import ROOT
from axiscal.web.problems import document
from axiscal.web.shapes import Shape

_FILES = ("page.css", "first.css", "elements.js", "first.js", "words.js", "icon.svg")
_Body = TypeVar("_Body", bound=Shape)


def first_application(desk: FirstDesk, admitted: Admission, language: str, done: Callable[[], None]) -> Guard:
    """Return the form behind its guard; done : called when the files are written and the page has been told."""
    api = _FirstApi(desk, language, done)
    routes = [
        *static_routes("first.html", _FILES),
        Route("/words.json", api.words, methods=["GET"]),
        Route(f"{ROOT}/first", api.form, methods=["GET"]),
        Route(f"{ROOT}/first/machine", api.machine, methods=["GET"]),
        Route(f"{ROOT}/first/preview", api.preview, methods=["POST"]),
        Route(f"{ROOT}/first/files", api.write, methods=["POST"]),
    ]
    app = Starlette(routes=routes, exception_handlers={HTTPException: not_here, Exception: defect})
    app.router.redirect_slashes = False
    return Guard(app, admitted)


class _FirstApi:
    """What the routes answer."""

    def __init__(self, desk: FirstDesk, language: str, done: Callable[[], None]) -> None:
        self._desk, self._language, self._done = desk, language, done

    async def words(self, request: Request) -> Response:
        return words(self._language)

    async def form(self, request: Request) -> Response:
        with speaking(self._language):
            return document(self._desk.form())

    async def machine(self, request: Request) -> Response:
        given = dict(request.query_params)
        return await self._answer(SourceQuery, given, lambda query: self._desk.machine(query.source))

    async def preview(self, request: Request) -> Response:
        return await self._answer(FirstRequest, await request.body(), self._desk.preview)

    async def write(self, request: Request) -> Response:
        answer = await self._answer(FirstRequest, await request.body(), self._desk.write)
        if self._desk.written:
            answer.background = BackgroundTask(self._done)
        return answer

    async def _answer(
        self, kind: type[_Body], given: bytes | dict[str, str], step: Callable[[_Body], Shape]
    ) -> Response:
        async def found(body: _Body) -> Response:
            with speaking(self._language):
                return document(await run_in_threadpool(step, body))

        return await answered(kind, given, found)
