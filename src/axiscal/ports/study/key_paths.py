"""A key of a study file: a path into campaign.toml or machine.toml, such as target.rms or setups[*].noise.

In brackets stands which entries of a list: all (*), one by its number from 1, or one by its name.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from axiscal.document import meant, shown
from axiscal.exceptions import StudyError
from axiscal.language.spoken import said

_PART = re.compile(r"(?P<name>[^.\[\]]+)(?:\[(?P<which>[^\]]+)\])?(?:\.|$)")
_ALL = "*"


class PathPart(NamedTuple):
    """One part of a path.  which : entries of a list, None where it is none"""

    name: str
    which: str | None


def parts_of(path: str) -> tuple[PathPart, ...]:
    """Return a path taken apart; raises StudyError for one that cannot be read."""
    found, at = list[PathPart](), 0
    while at < len(path) and (part := _PART.match(path, at)):
        found.append(PathPart(part["name"].strip(), part["which"]))
        at = part.end()
    if at < len(path) or not found or path.endswith("."):
        remedy = 'Write paths such as "target.rms", "setups[*].noise" or "errors.EXX.std"'
        raise StudyError("{text} is no path of a key", remedy, text=shown(path))
    return tuple(found)


def changed(data: Mapping[str, Any], path: str, value: Any) -> dict[str, Any]:
    """Return a document with the value of a key replaced; raises StudyError where there is no such table or entry."""
    found: dict[str, Any] = copy.deepcopy(dict(data))
    *way, last = parts_of(path)
    for table in _below([found], way, path):
        if last.which is None:
            table[last.name] = value
            continue
        entries = _value(table, last.name, path)
        for index in _indices(entries, last, path):
            entries[index] = value
    return found


def _below(tables: list[Any], way: Iterable[PathPart], path: str) -> list[Any]:
    for part in way:
        below = list[Any]()
        for table in tables:
            value = _value(table, part.name, path)
            below += [value] if part.which is None else [value[index] for index in _indices(value, part, path)]
        tables = below
    for table in tables:
        if not isinstance(table, dict):
            hint = "Say which, as in setups[*].noise" if isinstance(table, list) else "Shorten the path"
            what = '{text}: what stands before ".{part}" is no table'
            raise StudyError(what, hint, text=shown(path), part=path.rpartition(".")[2])
    return tables


def _value(table: Any, name: str, path: str) -> Any:
    if isinstance(table, dict) and name in table:
        return table[name]
    known = list(table) if isinstance(table, dict) else []
    remedy = meant(
        name, known, said("There are {known}", known=", ".join(known)) if known else said("Shorten the path")
    )
    raise StudyError('{text}: there is no "{name}"', remedy, text=shown(path), name=name)


def _indices(entries: Any, part: PathPart, path: str) -> list[int]:
    if not isinstance(entries, list):
        remedy = "Write {part} without brackets"
        raise StudyError('{text}: "{part}" is no list', remedy, text=shown(path), part=part.name)
    if part.which == _ALL:
        return list(range(len(entries)))
    which = part.which or ""
    if which.isascii() and which.isdigit() and 1 <= int(which) <= len(entries):
        return [int(which) - 1]
    names = [str(each.get("name", "")) for each in entries if isinstance(each, dict)]
    if which in names:
        return [names.index(which)]
    remedy = meant(
        which, names, said("Write [*], or one of [1] to [{count}], or its name", count=len(entries)), quoted="[{}]"
    )
    raise StudyError('{text}: there is no "{name}" in {part}', remedy, text=shown(path), name=which, part=part.name)
