"""Two folders of texts compared: file by file, number by number."""

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from itertools import zip_longest
from pathlib import Path
from typing import Any

TOLERANCE = 1e-4
"""Of two numbers relative to the larger one, or in a list of numbers to the largest of the list.

What is learnt from readings is a search that ends within its own tolerance: processors differ by up to 1e-5.
"""
FLOOR = 1e-6
"""um, urad, minutes, in documents: picometres, where a number is the rounding of what cancels."""
_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")
_ABSENT = "(nothing)"
_Found = Iterator[tuple[str, str, str]]
"""Place, and what stands there in both."""


@dataclass(frozen=True, slots=True)
class Difference:
    """Where two folders differ: the file, the place in it, and what stands in each."""

    file: str
    place: str
    first: str
    second: str

    def __str__(self) -> str:
        return f"{self.file}: {self.place}: {_short(self.first)} | {_short(self.second)}"


def differences(first: Path, second: Path) -> Iterator[Difference]:
    """Yield where two folders differ: words that are not the same, numbers beyond `TOLERANCE` and `FLOOR`."""
    for name in sorted(_files(first) | _files(second)):
        yield from _of_file(name, first / name, second / name)


def _files(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def _of_file(name: str, first: Path, second: Path) -> Iterator[Difference]:
    missing = [not path.is_file() for path in (first, second)]
    if any(missing):
        yield Difference(name, "the file", *("is missing" if gone else "is there" for gone in missing))
        return
    one, other = (path.read_bytes().decode("utf-8") for path in (first, second))
    if one != other:
        for place, left, right in _of_texts(one, other, document=name.endswith(".json")):
            yield Difference(name, place, left, right)


def _of_texts(one: str, other: str, *, document: bool) -> _Found:
    if document:
        yield from of_values(json.loads(one), json.loads(other), "$", 0.0)
        return
    lines = zip_longest(one.splitlines(), other.splitlines(), fillvalue=_ABSENT)
    for number, (left, right) in enumerate(lines, start=1):
        if not _alike(left, right):
            yield f"line {number}", left, right


def of_values(one: Any, other: Any, place: str, scale: float) -> _Found:
    """Yield where two JSON values differ.  scale : the largest number of the list they stand in"""
    if isinstance(one, dict) and isinstance(other, dict):
        for key in [*one, *(key for key in other if key not in one)]:
            yield from of_values(one.get(key, _ABSENT), other.get(key, _ABSENT), f"{place}.{key}", 0.0)
    elif isinstance(one, list) and isinstance(other, list):
        largest = max((abs(value) for value in (*one, *other) if _is_number(value)), default=0.0)
        for index, (left, right) in enumerate(zip_longest(one, other, fillvalue=_ABSENT)):
            yield from of_values(left, right, f"{place}[{index}]", largest)
    elif not _same(one, other, scale):
        yield place, json.dumps(one, ensure_ascii=False), json.dumps(other, ensure_ascii=False)


def _same(one: object, other: object, scale: float) -> bool:
    if _is_number(one) and _is_number(other):
        return _near(one, other, scale, FLOOR)  # type: ignore[arg-type]
    if isinstance(one, str) and isinstance(other, str):
        return _alike(one, other)
    return type(one) is type(other) and one == other


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _near(one: float, other: float, scale: float = 0.0, floor: float = 0.0) -> bool:
    return abs(one - other) <= max(TOLERANCE * max(abs(one), abs(other), scale), floor)


def _alike_as_printed(one: str, other: str) -> bool:
    """Return whether two printed numbers agree, or differ by one in the last of several digits.

    A number on the edge of rounding falls to either side by its last bits. Documents hold the same numbers in full.
    """
    first, second = Decimal(one), Decimal(other)
    last, other_last = first.as_tuple().exponent, second.as_tuple().exponent
    several = min(len(first.as_tuple().digits), len(second.as_tuple().digits)) > 1
    if several and last == other_last and isinstance(last, int) and abs(first - second) <= Decimal(1).scaleb(last):
        return True
    return _near(float(one), float(other))


def _alike(one: str, other: str) -> bool:
    """Return whether two texts say the same: the same words, and numbers within the tolerance."""
    if one == other:
        return True
    left, right = _NUMBER.split(one), _NUMBER.split(other)
    if len(left) != len(right) or left[::2] != right[::2]:
        return False
    return all(map(_alike_as_printed, left[1::2], right[1::2]))


def _short(text: str, width: int = 160) -> str:
    return text if len(text) <= width else f"{text[:width]}..."
