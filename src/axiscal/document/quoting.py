"""How values and keys of a document are shown to the person who wrote them.

Values written as TOML.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from axiscal.exceptions import UnitError
from axiscal.language.spoken import said
from axiscal.units import EXAMPLES, Dimension, nearest, shortened


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


Key = str | int


def quantity_text(value: object, dimension: Dimension | None = None) -> str:
    """Return the text of a quantity; raises UnitError for anything that is not text, a bare number above all."""
    if isinstance(value, str):
        return value
    remedy = 'Write a number with its unit in quotes, such as "{example}"'
    bare = isinstance(value, int | float) and not isinstance(value, bool)
    what = "{text} has no unit (missing unit)" if bare else "{text} is not a quantity"
    raise UnitError(what, remedy, text=shown(value), example=EXAMPLES[dimension or "length"])


def meant(word: str, known: Iterable[str], otherwise: str = "", quoted: str = '"{}"') -> str:
    """Return the remedy for a word that is not known: the one that is near, else `otherwise`, else all of them."""
    words = list(known)
    near = nearest(word, words)
    if near:
        return said("Perhaps {word} is meant", word=quoted.format(near))
    return otherwise or (said("Known are {words}", words=", ".join(words)) if words else said("Take it out"))


def shown(value: object) -> str:
    """Return a value of a document as its writer would recognise it, shortened to one line."""
    return shortened(_written(value, 3))


def dotted(keys: tuple[Key, ...]) -> str:
    """Return a key path as people write it: setups[2].noise, list entries counted from 1."""
    text = ""
    for key in keys:
        text += f"[{key + 1}]" if isinstance(key, int) else f".{key}" if text else key
    return shortened(text, 120)


def _written(value: object, depth: int) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = …" for key in list(value)[:6]) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_written(entry, depth - 1) if depth else "…" for entry in value[:6]) + "]"
    if isinstance(value, int) and abs(value) > 10**18:
        return "an integer of more than 18 digits"
    return str(value)
