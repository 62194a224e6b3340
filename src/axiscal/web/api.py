"""The routes: the page, its two files, and the JSON API, version 1."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from functools import partial
from importlib import resources
from typing import TypeVar

from pydantic import ValidationError
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Route

from axiscal.exceptions import AxiscalError, OvertakenError
from axiscal.guide.language import LANGUAGES, messages
from axiscal.web.counter import Counter
from axiscal.web.desk import Desk, SurprisingError
from axiscal.web.guard import Admission, Guard
from axiscal.web.openapi import ROOT, description
from axiscal.web.problems import document, problem
from axiscal.web.shapes import (
    DoneShape,
    KeepRequest,
    NoQuery,
    NoteRequest,
    Shape,
    SkipRequest,
    StepRequest,
    TableQuery,
    TypedQuery,
    WaitQuery,
)

_FILES = {
    "page.css": "text/css",
    "page.js": "text/javascript",
    "pictures.js": "text/javascript",
    "setups.js": "text/javascript",
    "volume.js": "text/javascript",
    "words.js": "text/javascript",
    "icon.svg": "image/svg+xml",
}
_Answer = Callable[[Request], Awaitable[Response]]
_Body = TypeVar("_Body", bound=Shape)


def application(counter: Counter, admitted: Admission) -> Guard:
    """Return the whole page behind its guard."""
    api = _Api(counter)
    steps = {"readings": api.keep, "skips": api.skip, "notes": api.note, "undo": api.undo, "next": api.go_on}
    steps["finish"] = api.finish
    routes = [
        Route("/", partial(_file, "page.html", "text/html"), methods=["GET"]),
        *(Route(f"/{name}", partial(_file, name, kind), methods=["GET"]) for name, kind in _FILES.items()),
        Route("/words.json", api.words, methods=["GET"]),
        Route("/report.html", api.report, methods=["GET"]),
        Route(f"{ROOT}/openapi.json", _described, methods=["GET"]),
        Route(f"{ROOT}/state", api.state, methods=["GET"]),
        Route(f"{ROOT}/typed", api.typed, methods=["GET"]),
        Route(f"{ROOT}/outlook", api.outlook, methods=["GET"]),
        Route(f"{ROOT}/table", api.table, methods=["GET"]),
        *(Route(f"{ROOT}/{name}", answer, methods=["POST"]) for name, answer in steps.items()),
    ]
    app = Starlette(
        routes=routes, exception_handlers={HTTPException: _not_here, Exception: _defect}, lifespan=_watching(counter)
    )
    app.router.redirect_slashes = False
    return Guard(app, admitted)


class _Api:
    """What the routes answer."""

    def __init__(self, counter: Counter) -> None:
        self._counter = counter

    async def state(self, request: Request) -> Response:
        async def answered(query: WaitQuery) -> Response:
            return document(await self._counter.newer(query.seen, query.wait, _language(request)))

        return await _asked(WaitQuery, dict(request.query_params), answered)

    async def typed(self, request: Request) -> Response:
        async def answered(query: TypedQuery) -> Response:
            return document(self._counter.read(query.text, _language(request)))

        return await _asked(TypedQuery, dict(request.query_params), answered)

    async def words(self, request: Request) -> Response:
        """The language of the page, and its messages by the English ones."""
        language = self._counter.language
        return JSONResponse({"language": language, "messages": messages(language)})

    async def outlook(self, request: Request) -> Response:
        return await _asked(NoQuery, dict(request.query_params), lambda _: self._looked(Desk.outlook))

    async def table(self, request: Request) -> Response:
        return await _asked(TableQuery, dict(request.query_params), self._table)

    async def _table(self, query: TableQuery) -> Response:
        return await self._looked(lambda desk: desk.table(query.control))

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
            language = _language(request)
            said = await self._counter.do(step(body), language)
            return document(DoneShape(sentence=said, state=await self._counter.newer(0, 0.0, language)))

        return await _asked(kind, await request.body(), done)


def _language(request: Request) -> str:
    """Return the language of the answer: the one that a page names, English for every program that names none."""
    named = request.headers.get("accept-language", "")
    return named if named in LANGUAGES else "en"


def _keep(request: KeepRequest, desk: Desk) -> str:
    return desk.keep(request.after, request.text, keep=request.keep, vouch=request.vouch)


async def _asked(
    kind: type[_Body], given: bytes | dict[str, str], answer: Callable[[_Body], Awaitable[Response]]
) -> Response:
    """Answer what was asked if it has the right form; turn every refusal into a document."""
    try:
        body = kind.model_validate_json(given) if isinstance(given, bytes) else kind.model_validate(given)
        return await answer(body)
    except ValidationError as failure:
        first = failure.errors(include_url=False, include_input=False, include_context=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        return problem(422, "malformed", f"{where}: {first['msg']}" if where else first["msg"])
    except SurprisingError as failure:
        return problem(409, "surprising", str(failure), failure.surprise)
    except OvertakenError as failure:
        return problem(409, "overtaken", str(failure))
    except AxiscalError as failure:
        return problem(422, "refused", str(failure))


async def _file(name: str, kind: str, request: Request) -> Response:
    return Response(resources.files("axiscal.web").joinpath("static", name).read_bytes(), media_type=kind)


async def _described(request: Request) -> Response:
    return JSONResponse(description())


async def _not_here(request: Request, failure: Exception) -> Response:
    status = failure.status_code if isinstance(failure, HTTPException) else 500
    code, said = ("method", "This cannot be done here") if status == 405 else ("missing", "There is nothing here")
    return problem(status, code, said)


async def _defect(request: Request, failure: Exception) -> Response:
    kind = type(failure).__name__
    said = f"A defect in axiscal: {kind}: {failure}. What is on the disk is kept; look at the last readings"
    return problem(500, "defect", said)


def _watching(counter: Counter) -> Callable[[Starlette], AbstractAsyncContextManager[None]]:
    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        watch = asyncio.create_task(counter.watch())
        yield
        watch.cancel()

    return lifespan
