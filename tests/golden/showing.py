"""What a campaign gave, as texts that are kept: documents with fewer digits and points."""

import json
import math
import re
import shlex
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from tests.golden.given import Given
from tests.golden.playing import Said

MASKED = (
    (re.compile(r'("(?:axiscal|numpy|python|scipy)": )"[^"]*"'), r'\1"<version>"'),
    (re.compile(r"\b(axiscal|numpy|python|scipy) \d+\.\d+\.\d[\w.+]*"), r"\1 <version>"),
    (re.compile(r"\b[0-9a-f]{64}\b"), "<hash>"),
    (re.compile(r"\b\d(?:[.,]\d+)?e-1\d\b(?= um| µm)"), "0"),
)
"""What differs from one installation to another, hashes of it, and roundings of zero; clock and paths never do."""
LEFT_AWAY = (
    *("*.axiscal", "*.axiscal-*", "*.answers", "*.sqlite"),
    *("*.pdf", "*.svg", "data/*", "tables/*/README.txt"),
    *("axiscal_vcomp.comp", "axiscal_vcomp_core.h"),
)
"""Records and what is kept beside them; reports and pictures; the words beside tables; code that is copied."""
DIGITS = 12
MOST = 8
"""Numbers of a list that is kept whole; of a longer one so many at most. Sentences are all kept."""
THINGS = 2 * MOST
"""Things with names of a list that is kept whole: sources of a budget, tables. Of readings there are `MOST`."""
GRID = 4
"""Rows and columns of a grid, of which each row stands in a line of its own."""
ROWS = 4 * MOST
"""Rows of a table that is kept whole; of a longer one so many at most."""
_ROW = re.compile(r"(?:[A-Z]\w*[,;]\s*)?[-+.\d][-+.,;\dEe\s]*")
"""Numbers, behind the name of an axis or without it."""


def shown(campaign: Given, said: Sequence[Said], folder: Path) -> dict[str, str]:
    """Return the texts of a campaign by name: its screens, the documents it printed, the files it wrote.

    folder : where it was played
    """
    texts = {"screens.txt": "".join(_screen(number, one) for number, one in enumerate(said, start=1))}
    for number, one in enumerate(said, start=1):
        if _is_document(one.out):
            texts[_document_name(number, one)] = _document(one.out)
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name not in campaign.inputs and not any(map(path.match, LEFT_AWAY)):
            texts |= dict([_file(path, name)])
    return _once({name: _masked(text) for name, text in texts.items()})


def _once(texts: dict[str, str]) -> dict[str, str]:
    """Return texts of which each document stands once; where it is the same again stands the name of the first."""
    first: dict[str, str] = {}
    for name in sorted(texts, key=lambda each: ("/" not in each, each)):
        first.setdefault(texts[name], name)
    again = {name for name, text in texts.items() if name.endswith(".json") and first[text] != name}
    return {name: json.dumps({"as": first[text]}) + "\n" if name in again else text for name, text in texts.items()}


def _screen(number: int, said: Said) -> str:
    shown = f"see {_document_name(number, said)}\n" if _is_document(said.out) else said.out
    line = shlex.join(["axiscal", *said.command.words])
    streams = (("stdout", shown), ("stderr", said.err))
    told = "".join(f"--- {name}\n{text.rstrip()}\n" for name, text in streams if text.strip())
    return f"$ {line}\n{told}status {said.status}\n\n"


def _document_name(number: int, said: Said) -> str:
    return f"{number:02}-{said.command.words[0]}.json"


def _is_document(text: str) -> bool:
    try:
        return isinstance(json.loads(text), dict)
    except ValueError:
        return False


def _file(path: Path, name: str) -> tuple[str, str]:
    text = path.read_bytes().decode("utf-8", "backslashreplace").replace("\r\n", "\n")
    return name, _document(text) if path.suffix == ".json" else _table(text)


def _table(text: str) -> str:
    """Return a text with fewer of the rows that hold nothing but numbers, where more than ROWS follow each other."""
    kept: list[str] = []
    for numeric, group in groupby(text.splitlines(keepends=True), lambda line: bool(_ROW.fullmatch(line.strip()))):
        rows = list(group)
        every = math.ceil(len(rows) / ROWS) if numeric else 1
        kept += rows[::every] + [f"({len(rows)} rows, every {every}th)\n"] * (every > 1)
    return "".join(kept)


def _document(text: str) -> str:
    """Return a JSON document with fewer digits and points, each list of numbers in one line."""
    written = json.dumps(_less(json.loads(text)), indent=1, ensure_ascii=False)
    in_one_line = re.sub(r"\[[^][{}\"]*\]", lambda found: " ".join(found.group().split()), written)
    return f"{in_one_line}\n"


def _less(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, dict):
        return {key: _less(each) for key, each in value.items()}
    if not isinstance(value, list) or any(isinstance(each, str) for each in value):
        return value
    things = any(isinstance(each, dict) for each in value)
    most = THINGS if things and "reading" not in value[0] else MOST
    every = max(1, math.ceil(len(value) / most))
    if things:
        kept = [_less(each) for each in value[(len(value) - 1) % every :: every]]  # the last one is what was found
    elif any(isinstance(each, list) for each in value):
        return _grid(value)
    else:
        kept = [_less(each) for each in value[::every]]
    return kept if every == 1 else {"length": len(value), "every": every, "values": kept}


def _grid(rows: list[list[Any]]) -> Any:
    """Return rows of as many numbers, thinned in both directions."""
    every, across = (max(1, math.ceil(len(way) / GRID)) for way in (rows, rows[0]))
    kept = [[_less(each) for each in row[::across]] for row in rows[::every]]
    return (
        kept
        if every == across == 1
        else {"lengths": [len(rows), len(rows[0])], "every": [every, across], "values": kept}
    )


def _masked(text: str) -> str:
    for pattern, word in MASKED:
        text = pattern.sub(word, text)
    return text
