"""Values written as TOML."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any


def toml_value(value: Any) -> str:
    """Return a value as TOML has it; strings as in JSON, which TOML's basic strings contain."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_quoted(str(key))} = {toml_value(each)}" for key, each in value.items()) + " }"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return "[" + ", ".join(toml_value(each) for each in value) + "]"
    return _quoted(value)


def _quoted(value: Any) -> str:
    """Return a text or a number; TOML takes no halves of a character as JSON escapes them, and no bare delete."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def toml_document(data: Mapping[str, Any]) -> str:
    """Return a document with a heading for each of its tables."""
    return "".join(f"{line}\n" for line in _lines(data, ()))


def _lines(data: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    for key, value in data.items():
        if not isinstance(value, Mapping) and not _tables(value):
            yield f"{_quoted(key)} = {toml_value(value)}"
    for key, value in data.items():
        heading = ".".join(_quoted(part) for part in (*path, key))
        if isinstance(value, Mapping):
            yield f"[{heading}]"
            yield from _lines(value, (*path, key))
        for each in value if _tables(value) else ():
            yield f"[[{heading}]]"
            yield from _lines(each, (*path, key))


def _tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(each, Mapping) for each in value)
