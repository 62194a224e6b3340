"""A key of a study file: a path into campaign.toml or machine.toml, such as target.rms or setups[*].noise.

In brackets stands which entries of a list: all (*), one by its number from 1, or one by its name.
"""

from __future__ import annotations

import copy
import hashlib
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from axiscal.document import meant, shown
from axiscal.exceptions import StudyError
from axiscal.language.spoken import said

_QUANTITY = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(\S.*)?")
_REMEDY = 'Write {{ between = ["0.3 um", "3 um"], scale = "log" }} or {{ of = ["0.3 um", "1 um"] }}'
_DIGITS = 6
"""Of a drawn number: more than anybody states."""

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


@dataclass(frozen=True, slots=True)
class Drawn:
    """One key whose values are drawn: between two ends of one unit, or one of some values.

    whole : only whole numbers
    """

    key: str
    low: float = 0.0
    high: float = 0.0
    unit: str = ""
    even_in_log: bool = False
    whole: bool = False
    values: tuple[Any, ...] = ()

    def value(self, seed: int, draw: int) -> Any:
        """Return the value of a draw: the same for the same seed, number and key."""
        digest = hashlib.sha256(self.key.encode()).digest()
        share = float(np.random.default_rng((seed, draw, *digest[:8])).uniform())
        if self.values:
            return self.values[int(share * len(self.values))]
        if self.even_in_log:
            number = math.exp(math.log(self.low) + share * (math.log(self.high) - math.log(self.low)))
        else:
            number = self.low + share * (self.high - self.low)
        if self.whole:
            return min(int(self.low + share * (self.high - self.low + 1)), int(self.high))
        return f"{number:.{_DIGITS}g} {self.unit}" if self.unit else float(f"{number:.{_DIGITS}g}")


def drawn_key(key: str, table: Any) -> Drawn:
    """Return how a key is drawn; raises StudyError for a table that does not say it."""
    if not isinstance(table, Mapping) or ("of" in table) == ("between" in table):
        raise StudyError("{text} does not say what to draw", _REMEDY, text=shown(table))
    if unknown := sorted(table.keys() - {"of", "between", "scale"}):
        raise StudyError('unknown key "{key}"', _REMEDY, key=unknown[0])
    if "of" in table:
        if not isinstance(table["of"], list) or not table["of"]:
            raise StudyError("{text} is no list of values", _REMEDY, text=shown(table["of"]))
        return Drawn(key, values=tuple(table["of"]))
    scale = table.get("scale", "linear")
    if scale not in ("linear", "log"):
        raise StudyError("scale = {text} is not possible here", 'Write "linear" or "log"', text=shown(scale))
    return _between(key, table["between"], scale == "log")


def _between(key: str, ends: Any, in_log: bool) -> Drawn:
    if not isinstance(ends, list) or len(ends) != 2:
        raise StudyError("{text} is no pair of ends", _REMEDY, text=shown(ends))
    (low, unit), (high, other) = (_split(end) for end in ends)
    if unit != other:
        raise StudyError("{text} are not in one unit", "Give both ends in the same unit", text=shown(ends))
    if not low < high or (in_log and low <= 0):
        what = "{text} does not increase" if not low < high else "{text} begins at nothing or below"
        remedy = "Give the lower end first, above zero" if in_log else "Give the lower end first"
        raise StudyError(what, remedy, text=shown(ends))
    whole = all(isinstance(end, int) for end in ends) and not in_log
    return Drawn(key, low, high, unit, in_log, whole)


def _split(end: Any) -> tuple[float, str]:
    if isinstance(end, int | float) and not isinstance(end, bool):
        return float(end), ""
    if isinstance(end, str) and (found := _QUANTITY.fullmatch(end)):
        return float(found[1]), (found[2] or "").strip()
    raise StudyError("{text} is neither a number nor a quantity", _REMEDY, text=shown(end))
