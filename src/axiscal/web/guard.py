"""The guard before the page: only its own address, only who has the token, only our own page, nothing large.

A page from elsewhere that is open in the same browser can reach the port. Three things stop it: its Host if it has
renamed itself (rebinding), its Origin, and the token, which each request carries in its head. A browser would send a
cookie to every port of this computer; what a page keeps for itself, other ports cannot read.
"""

from __future__ import annotations

import hmac
import json
import secrets
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

from fastapi import Depends, FastAPI, Request, Response, Security
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from fastapi.security import HTTPBearer
from starlette.datastructures import MutableHeaders
from starlette.exceptions import HTTPException
from starlette.requests import HTTPConnection
from starlette.routing import Route
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from axiscal.document.ports import culprit
from axiscal.exceptions import AxiscalError, OvertakenError
from axiscal.language.spoken import messages, spoken_now
from axiscal.present.guide.slips import SurprisingError
from axiscal.present.sentences import spelt
from axiscal.web.shapes import ProblemShape

ROOT = "/api/1"
LARGEST = 64 * 1024
"""Bytes of a request's body; what a person types is far smaller."""
_KINDS = {".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml", ".html": "text/html"}
_STATIC = Path(str(resources.files("axiscal.web"))) / "static"
FREE = {"/", "/words.json", *(f"/{file.name}" for file in _STATIC.iterdir() if file.suffix != ".html")}
"""Paths of what everybody may see: the page and the files that it loads."""
_REFUSALS: dict[int | str, dict[str, Any]] = {
    status: {"model": ProblemShape, "description": "Not done, and why"} for status in (400, 403, 409, 413, 422)
}
"""What each refusal may answer, for the description."""
_NOTHING_HERE = {
    400: (422, "malformed", "The body is no JSON"),
    405: (405, "method", "This cannot be done here"),
}
"""Status, code and sentence of what is refused before a function is called, by the status that it has."""


def page_application(page: Callable[[], str], **settings: Any) -> FastAPI:
    """Return the application of a page, with the files that it loads.

    page : says which file it is now; settings : as of FastAPI
    Its guard asks for the token; here it is only described.
    """
    token = HTTPBearer(scheme_name="token", description="The token that axiscal serve prints", auto_error=False)

    async def shown(request: Request) -> Response:
        file = _STATIC / (request.url.path.lstrip("/") or page())
        return Response(file.read_bytes(), media_type=_KINDS[file.suffix])

    return FastAPI(
        routes=[Route(path, _words if path == "/words.json" else shown, methods=["GET"]) for path in FREE],
        exception_handlers=dict.fromkeys((RequestValidationError, AxiscalError, HTTPException, Exception), _not_done),
        default_response_class=PageDocument,
        responses=_REFUSALS,
        dependencies=[Security(token), Depends(_refuse_unknown)],
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        strict_content_type=False,
        **settings,
    )


class PageDocument(JSONResponse):
    """A document; signs that no text holds, which a person can send, become question marks."""

    def render(self, content: Any) -> bytes:
        """Return the document as UTF-8."""
        return json.dumps(content, ensure_ascii=False, allow_nan=False).encode("utf-8", "replace")


def problem(status: int, code: str, sentence: str) -> Response:
    """Return an answer that says what is wrong: by a code for programs and a sentence for people."""
    return PageDocument({"problem": code, "sentence": sentence}, status)


async def _words(request: Request) -> Response:
    """Answer with the language of the page, and its messages by the English ones."""
    return JSONResponse({"language": spoken_now(), "messages": messages(spoken_now())})


async def _refuse_unknown(request: Request) -> None:
    """Raise RequestValidationError for a query that the path does not take."""
    taken = {each.alias for each in request.scope["route"].dependant.query_params}
    if unknown := set(request.query_params) - taken:
        raise RequestValidationError([{"loc": ("query", min(unknown)), "msg": "Extra inputs are not permitted"}])


async def _not_done(request: Request, failure: Exception) -> Response:
    """Answer with what is wrong."""
    match failure:
        case RequestValidationError():
            first = failure.errors()[0]
            where = ".".join(str(part) for part in first["loc"][1:])
            return problem(422, "malformed", f"{where}: {first['msg']}" if where else first["msg"])
        case SurprisingError():
            return problem(409, "surprising", spelt(str(failure)))
        case OvertakenError():
            return problem(409, "overtaken", str(failure))
        case AxiscalError():
            return problem(422, "refused", str(failure))
        case HTTPException(status_code=status):
            return problem(*_NOTHING_HERE.get(status, (status, "missing", "There is nothing here")))
    what = f"A defect in {culprit(failure)}: {type(failure).__name__}: {failure}"
    return problem(500, "defect", f"{what}. What is on the disk is kept; look at the last readings")


_TOKEN_BYTES = 32  # 256 bits; from 128 on nobody guesses
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}


class Guard:
    """Lets a request through to `app`, or refuses it with its reason; sets the headers of every answer.

    port : we listen on; address : to open, with a token that is new at every start
    The token stands behind the #, which a browser sends to nobody.
    """

    def __init__(self, app: ASGIApp, port: int) -> None:
        self._app = app
        self._token, self._hosts = secrets.token_urlsafe(_TOKEN_BYTES), (f"127.0.0.1:{port}", f"localhost:{port}")
        self.address = f"http://{self._hosts[0]}/#{self._token}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def answered(message: Message) -> None:
            if message["type"] == "http.response.start":
                answer = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    answer[name] = value
                answer.setdefault("Content-Security-Policy", _POLICY)
            await send(message)

        fault = self._fault(HTTPConnection(scope))
        if fault is not None:
            await fault(scope, receive, answered)
            return
        await self._app(scope, receive, answered)

    def _fault(self, asked: HTTPConnection) -> Response | None:
        """Return what is wrong with a request, None for what may come in."""
        headers = asked.headers
        if headers.getlist("host") not in ([host] for host in self._hosts):
            return problem(400, "host", f"This page answers under http://{self._hosts[0]} only")
        if headers.get("origin") not in (None, *(f"http://{host}" for host in self._hosts)):
            return problem(403, "forbidden", "This request comes from another page")
        if int(headers.get("content-length", 0)) > LARGEST or "transfer-encoding" in headers:
            return problem(413, "large", f"A request may have {LARGEST} bytes, and says how many it has")
        scheme, _, token = headers.get("authorization", "").partition(" ")
        ours = hmac.compare_digest(token.encode("utf-8", "replace"), self._token.encode())
        free = asked.scope["method"] in ("GET", "HEAD") and asked.scope["path"] in FREE
        if (scheme.lower() == "bearer" and ours) or free:
            return None
        return problem(403, "forbidden", "Open the address that axiscal serve has printed: it holds the token")
