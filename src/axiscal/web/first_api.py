"""The routes of the form that makes a first description."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from fastapi import Query, Response
from starlette.background import BackgroundTask

from axiscal.language.spoken import speaking
from axiscal.web.answering import ROOT, document, page_application
from axiscal.web.first_desk import FirstDesk, FirstRequest, SourceQuery
from axiscal.web.guard import Admission, Guard
from axiscal.web.shapes import Shape

_FILES = ("page.css", "first.css", "elements.js", "first.js", "words.js", "icon.svg")


def first_application(desk: FirstDesk, admitted: Admission, language: str, done: Callable[[], None]) -> Guard:
    """Return the form behind its guard; done : called when the files are written and the page has been told."""
    api = _FirstApi(desk, language, done)
    app = page_application("first.html", _FILES, language, openapi_url=None)
    app.get(f"{ROOT}/first")(api.form)
    app.get(f"{ROOT}/first/machine")(api.machine)
    app.post(f"{ROOT}/first/preview")(api.preview)
    app.post(f"{ROOT}/first/files")(api.write)
    return Guard(app, admitted)


class _FirstApi:
    """What the routes answer, each on a thread of its own."""

    def __init__(self, desk: FirstDesk, language: str, done: Callable[[], None]) -> None:
        self._desk, self._language, self._done = desk, language, done

    def form(self) -> Response:
        return self._answer(self._desk.form)

    def machine(self, query: Annotated[SourceQuery, Query()]) -> Response:
        return self._answer(lambda: self._desk.machine(query.source))

    def preview(self, asked: FirstRequest) -> Response:
        return self._answer(lambda: self._desk.preview(asked))

    def write(self, asked: FirstRequest) -> Response:
        answer = self._answer(lambda: self._desk.write(asked))
        answer.background = BackgroundTask(self._done)
        return answer

    def _answer(self, step: Callable[[], Shape]) -> Response:
        with speaking(self._language):
            return document(step())
