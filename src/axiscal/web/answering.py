"""How both pages answer: a request of the right form, files, refusals as documents, defects that hide nothing."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from functools import partial
from importlib import resources
from typing import TypeVar

from pydantic import ValidationError
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from axiscal.exceptions import AxiscalError, OvertakenError
from axiscal.language.spoken import LANGUAGES, messages
from axiscal.web.desk import SurprisingError
from axiscal.web.problems import problem
from axiscal.web.shapes import Shape

_Body = TypeVar("_Body", bound=Shape)
_KINDS = {"css": "text/css", "js": "text/javascript", "svg": "image/svg+xml", "html": "text/html"}


def static_routes(page: str, files: tuple[str, ...]) -> list[Route]:
    """Return the routes of a page, which begins with the head of all, and of the files that it loads."""
    named = {"/": page, **{f"/{name}": name for name in files}}
    return [Route(path, partial(_file, name), methods=["GET"]) for path, name in named.items()]


def words(language: str) -> Response:
    """Return the language of a page, and its messages by the English ones."""
    return JSONResponse({"language": language, "messages": messages(language)})


def language_of(request: Request) -> str:
    """Return the language of the answer: the one that a page names, English for every program that names none."""
    named = request.headers.get("accept-language", "")
    return named if named in LANGUAGES else "en"


async def answered(
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


async def _file(name: str, request: Request) -> Response:
    kind, folder = name.rpartition(".")[2], resources.files("axiscal.web").joinpath("static")
    begins = folder.joinpath("head.html").read_bytes() if kind == "html" else b""
    return Response(begins + folder.joinpath(name).read_bytes(), media_type=_KINDS[kind])


async def not_here(request: Request, failure: Exception) -> Response:
    status = failure.status_code if isinstance(failure, HTTPException) else 500
    code, said = ("method", "This cannot be done here") if status == 405 else ("missing", "There is nothing here")
    return problem(status, code, said)


async def defect(request: Request, failure: Exception) -> Response:
    kind = type(failure).__name__
    said = f"A defect in axiscal: {kind}: {failure}. What is on the disk is kept; look at the last readings"
    return problem(500, "defect", said)
