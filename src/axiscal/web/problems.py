"""A failed request as a document: a code for programs and a sentence for people."""

from __future__ import annotations

from starlette.responses import Response

from axiscal.web.shapes import ProblemShape, Shape


def document(shape: Shape, status: int = 200) -> Response:
    """Return an answer that is a document."""
    return Response(shape.model_dump_json().encode("utf-8", "replace"), status, media_type="application/json")


def problem(status: int, code: str, sentence: str, surprise: float | None = None) -> Response:
    """Return an answer that says what is wrong."""
    return document(ProblemShape(problem=code, sentence=sentence, surprise=surprise), status)
