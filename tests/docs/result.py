"""docs/result.md and its JSON schema, from the classes of the document: `python -m tests.docs.result` writes both."""

import json
from pathlib import Path
from typing import Any

from axiscal.present.result import Result

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE, SCHEMA = DOCS / "result.md", DOCS / "result.schema.json"
_HEAD = """\
# `result.json`

The document `axiscal-result/1`, which `--out DIR` receives and `--json` prints. `make docs` makes this page and the
JSON schema [result.schema.json](result.schema.json) from its classes. Every `std` is one standard deviation.
Fields may be added; those here keep their meaning.
"""


def schema() -> dict[str, Any]:
    """Return the JSON schema; fields that are added later do not break it."""
    whole = Result.model_json_schema(mode="serialization")
    for kind in (whole, *whole["$defs"].values()):
        kind["additionalProperties"] = True
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **whole}


def page() -> str:
    """Return the page: a list for each kind of object, in the order of the document."""
    whole = schema()
    return "\n".join([_HEAD, *map(_fields, (whole, *whole["$defs"].values()))])


def _fields(kind: dict[str, Any]) -> str:
    rows = [f"- `{name}`: {field['description']}" for name, field in kind["properties"].items()]
    return "\n".join([f"## {kind['description'].rstrip('.')}", *rows]) + "\n"


def written() -> str:
    """Return the text of the schema."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    SCHEMA.write_text(written(), encoding="utf-8")
