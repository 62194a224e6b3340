"""What is gone: commands, options, keys of files, sources, controls, files, and what to use instead of each."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib import resources
from typing import Any, Literal

from axiscal.document.file import Document
from axiscal.document.quoting import Key
from axiscal.language.spoken import said

GoneKind = Literal["commands", "options", "keys", "sources", "controls", "files", "readings"]


@cache
def gone() -> Mapping[GoneKind, Mapping[str, str]]:
    """Return what is gone by its name, each with the sentence that says what to use instead."""
    text = resources.files("axiscal.document").joinpath("gone.toml").read_text(encoding="utf-8")
    found: Mapping[GoneKind, Mapping[str, str]] = tomllib.loads(text)  # type: ignore[assignment]
    return found


def instead_of(kind: GoneKind, name: str) -> str:
    """Return what to use instead of what is gone, in the language that is spoken; "" for what is not gone."""
    sentence = gone()[kind].get(name)
    return "" if sentence is None else said(sentence)


def key_name(keys: tuple[Key, ...]) -> str:
    """Return the name of a key path in the table of what is gone: without numbers of lists."""
    return ".".join(key for key in keys if isinstance(key, str))


def without_gone(document: Document) -> Document:
    """Return the document without keys that are gone; a record of before may carry them."""
    return replace(document, data=_kept(document.data, ()))


def _kept(value: Any, keys: tuple[str, ...]) -> Any:
    if isinstance(value, list):
        return [_kept(each, keys) for each in value]
    if not isinstance(value, dict):
        return value
    return {k: _kept(v, (*keys, k)) for k, v in value.items() if key_name((*keys, k)) not in gone()["keys"]}
