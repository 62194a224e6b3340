"""docs/result.md: every field of `result.json`, from docs/result.schema.json.  `python -m tests.docs.result` writes it.

The schema is the one description: the tests read documents by it, and a field that it does not name is refused.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from jsonschema_rs import Draft202012Validator

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE, SCHEMA = DOCS / "result.md", DOCS / "result.schema.json"
_HEAD = """\
# `result.json`

The document `axiscal-result/1`, which `--out DIR` receives and `--json` prints. `make docs` makes this page from its
JSON schema [result.schema.json](result.schema.json), by which the tests read it. Every `std` is one standard deviation.
Fields may be added; those here keep their meaning.
"""


def schema() -> dict[str, Any]:
    """Return the JSON schema; fields that are added later do not break it."""
    found: dict[str, Any] = json.loads(SCHEMA.read_text(encoding="utf-8"))
    return found


def page() -> str:
    """Return the page: a list for each kind of object, in the order of the schema."""
    whole = schema()
    return "\n".join([_HEAD, *map(_fields, (whole, *whole["$defs"].values()))])


def _fields(kind: dict[str, Any]) -> str:
    rows = [f"- `{name}`: {field['description']}" for name, field in kind["properties"].items()]
    return "\n".join([f"## {kind['description'].rstrip('.')}", *rows]) + "\n"


def faults(document: object) -> list[str]:
    """Return where a document is not as the schema says, or has a field that the schema does not name."""
    whole = schema()
    for kind in (whole, *whole["$defs"].values()):
        kind["additionalProperties"] = False
    return [f"{fault.instance_path}: {fault.message}" for fault in Draft202012Validator(whole).iter_errors(document)]


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
