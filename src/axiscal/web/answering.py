"""How the page answers: files, documents that FastAPI describes, refusals as documents, defects that hide nothing."""

from __future__ import annotations

from functools import partial
from importlib import resources
from typing import Any

from fastapi import FastAPI, Request, Response, Security
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from fastapi.security import APIKeyCookie, HTTPBearer
from starlette.exceptions import HTTPException
from starlette.routing import Route

from axiscal.answers.answer import AnswerDocument
from axiscal.exceptions import AxiscalError, OvertakenError
from axiscal.language.spoken import messages, spoken_now
from axiscal.web.desk import SurprisingError
from axiscal.web.shapes import ProblemShape

ROOT = "/api/1"
_KINDS = {"css": "text/css", "js": "text/javascript", "svg": "image/svg+xml", "html": "text/html"}
_REFUSALS: dict[int | str, dict[str, Any]] = {
    status: {"model": ProblemShape, "description": "Not done, and why"} for status in (400, 403, 409, 413, 422)
}
"""What each refusal may answer, for the description."""
_NOTHING_HERE = {
    400: (422, "malformed", "The body is no JSON"),
    405: (405, "method", "This cannot be done here"),
}
"""Status, code and sentence of what is refused before a function is called, by the status that it has."""


def page_application(page: str, files: tuple[str, ...], **settings: Any) -> FastAPI:
    """Return the application of a page, with the files that it loads.

    settings : as of FastAPI
    Its guard asks for token or cookie; here they are only described.
    """
    token = HTTPBearer(scheme_name="token", description="The token that axiscal serve prints", auto_error=False)
    cookie = APIKeyCookie(name="axiscal-PORT", scheme_name="page", description="The page's own", auto_error=False)
    named = {"/": page, **{f"/{name}": name for name in files}}
    return FastAPI(
        routes=[
            *(Route(path, partial(_file, name), methods=["GET"]) for path, name in named.items()),
            Route("/words.json", _words, methods=["GET"]),
        ],
        exception_handlers={
            RequestValidationError: _malformed, AxiscalError: _refused, HTTPException: _not_here, Exception: _defect
        },
        responses=_REFUSALS,
        dependencies=[Security(token), Security(cookie)],
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        strict_content_type=False,
        **settings,
    )  # fmt: skip


def document(shape: AnswerDocument, status: int = 200) -> Response:
    """Return an answer that is a document."""
    return Response(shape.model_dump_json().encode("utf-8", "replace"), status, media_type="application/json")


def problem(status: int, code: str, sentence: str, surprise: float | None = None) -> Response:
    """Return an answer that says what is wrong: by a code for programs and a sentence for people."""
    return document(ProblemShape(problem=code, sentence=sentence, surprise=surprise), status)


async def _words(request: Request) -> Response:
    """Answer with the language of the page, and its messages by the English ones."""
    return JSONResponse({"language": spoken_now(), "messages": messages(spoken_now())})


async def _file(name: str, request: Request) -> Response:
    kind, folder = name.rpartition(".")[2], resources.files("axiscal.web").joinpath("static")
    return Response(folder.joinpath(name).read_bytes(), media_type=_KINDS[kind])


async def _malformed(request: Request, failure: Exception) -> Response:
    assert isinstance(failure, RequestValidationError)
    first = failure.errors()[0]
    where = ".".join(str(part) for part in first["loc"][1:])
    return problem(422, "malformed", f"{where}: {first['msg']}" if where else first["msg"])


async def _refused(request: Request, failure: Exception) -> Response:
    if isinstance(failure, SurprisingError):
        return problem(409, "surprising", str(failure), failure.surprise)
    if isinstance(failure, OvertakenError):
        return problem(409, "overtaken", str(failure))
    return problem(422, "refused", str(failure))


async def _not_here(request: Request, failure: Exception) -> Response:
    status = failure.status_code if isinstance(failure, HTTPException) else 500
    return problem(*_NOTHING_HERE.get(status, (status, "missing", "There is nothing here")))


async def _defect(request: Request, failure: Exception) -> Response:
    kind = type(failure).__name__
    said = f"A defect in axiscal: {kind}: {failure}. What is on the disk is kept; look at the last readings"
    return problem(500, "defect", said)
