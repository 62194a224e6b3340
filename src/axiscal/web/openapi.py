"""The API described for programs: OpenAPI 3.1, made from the documents themselves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from axiscal.web.shapes import (
    CostQuery,
    CostShape,
    DoneShape,
    KeepRequest,
    NoteRequest,
    ProblemShape,
    Shape,
    SkipRequest,
    StateShape,
    StepRequest,
    TableQuery,
    TableShape,
    TypedQuery,
    TypedShape,
    WaitQuery,
)

ROOT = "/api/1"
_REF = "#/components/schemas/{model}"
_STEPS: Mapping[str, tuple[str, type[Shape]]] = {
    "readings": ("Keep a reading of what is asked", KeepRequest),
    "skips": ("Note that the reading asked for cannot be taken", SkipRequest),
    "notes": ("Keep a sentence in the record", NoteRequest),
    "undo": ("Take back the last reading, skip or end", StepRequest),
    "next": ("Ask for one more reading although a target is reached", StepRequest),
    "finish": ("End the campaign and write its results beside the record", StepRequest),
}
_QUESTIONS: Mapping[str, tuple[str, type[Shape], type[Shape]]] = {
    "state": ("All that the page shows, at once or when it is newer than what was seen", WaitQuery, StateShape),
    "table": ("What the table of a control would reach if the campaign ended now", TableQuery, TableShape),
    "cost": ("What skipping the reading costs, or leaving its set-up", CostQuery, CostShape),
    "typed": ("What a typed text would mean for the question that is open", TypedQuery, TypedShape),
}


def description() -> dict[str, Any]:
    """Return the description of the API."""
    shapes: list[type[BaseModel]] = [
        CostShape,
        DoneShape,
        KeepRequest,
        NoteRequest,
        ProblemShape,
        SkipRequest,
        StateShape,
        StepRequest,
        TableShape,
        TypedShape,
    ]
    _, schemas = models_json_schema([(shape, "validation") for shape in shapes], ref_template=_REF)
    asked = {f"{ROOT}/{name}": {"get": _question(*each)} for name, each in _QUESTIONS.items()}
    done = {f"{ROOT}/{name}": {"post": _step(*each)} for name, each in _STEPS.items()}
    return {
        "openapi": "3.1.0",
        "info": {"title": "axiscal, the readings of one campaign", "version": "1"},
        "security": [{"token": []}, {"page": []}],
        "paths": asked | done,
        "components": {
            "schemas": schemas["$defs"],
            "securitySchemes": {
                "token": {"type": "http", "scheme": "bearer", "description": "The token that axiscal serve prints"},
                "page": {"type": "apiKey", "in": "cookie", "name": "axiscal-PORT", "description": "The page's own"},
            },
        },
    }


def _question(summary: str, query: type[Shape], answer: type[Shape]) -> dict[str, Any]:
    schema = query.model_json_schema()
    asked = [
        {"name": name, "in": "query", "required": name in schema.get("required", []), "schema": each}
        for name, each in schema.get("properties", {}).items()
    ]
    return {"summary": summary, "parameters": asked, "responses": _responses(answer, 400, 403, 422)}


def _step(summary: str, body: type[Shape]) -> dict[str, Any]:
    given = {"required": True, "content": _json(body)}
    return {"summary": summary, "requestBody": given, "responses": _responses(DoneShape, 400, 403, 409, 413, 422)}


def _responses(done: type[Shape], *refusals: int) -> dict[str, Any]:
    refused = {str(status): {"description": "Not done, and why", "content": _json(ProblemShape)} for status in refusals}
    return {"200": {"description": "Done", "content": _json(done)}, **refused}


def _json(shape: type[Shape]) -> dict[str, Any]:
    return {"application/json": {"schema": {"$ref": _REF.format(model=shape.__name__)}}}
