"""[random] of a study file: values of keys that are drawn anew for each draw."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from axiscal.document import shown
from axiscal.exceptions import StudyError

_QUANTITY = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(\S.*)?")
_REMEDY = 'Write { between = ["0.3 um", "3 um"], scale = "log" } or { of = ["0.3 um", "1 um"] }'
_DIGITS = 6
"""Of a drawn number: more than anybody states."""


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
        raise StudyError(f"{shown(table)} does not say what to draw", _REMEDY)
    if unknown := sorted(table.keys() - {"of", "between", "scale"}):
        raise StudyError(f'unknown key "{unknown[0]}"', _REMEDY)
    if "of" in table:
        if not isinstance(table["of"], list) or not table["of"]:
            raise StudyError(f"{shown(table['of'])} is no list of values", _REMEDY)
        return Drawn(key, values=tuple(table["of"]))
    scale = table.get("scale", "linear")
    if scale not in ("linear", "log"):
        raise StudyError(f"scale = {shown(scale)} is not possible here", 'Write "linear" or "log"')
    return _between(key, table["between"], scale == "log")


def _between(key: str, ends: Any, in_log: bool) -> Drawn:
    if not isinstance(ends, list) or len(ends) != 2:
        raise StudyError(f"{shown(ends)} is no pair of ends", _REMEDY)
    (low, unit), (high, other) = (_split(end) for end in ends)
    if unit != other:
        raise StudyError(f"{shown(ends)} are not in one unit", "Give both ends in the same unit")
    if not low < high or (in_log and low <= 0):
        what = f"{shown(ends)} does not increase" if not low < high else f"{shown(ends)} begins at nothing or below"
        raise StudyError(what, "Give the lower end first" + (", above zero" if in_log else ""))
    whole = all(isinstance(end, int) for end in ends) and not in_log
    return Drawn(key, low, high, unit, in_log, whole)


def _split(end: Any) -> tuple[float, str]:
    if isinstance(end, int | float) and not isinstance(end, bool):
        return float(end), ""
    if isinstance(end, str) and (found := _QUANTITY.fullmatch(end)):
        return float(found[1]), (found[2] or "").strip()
    raise StudyError(f"{shown(end)} is neither a number nor a quantity", _REMEDY)
