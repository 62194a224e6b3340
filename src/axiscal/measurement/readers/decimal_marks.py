"""Numbers as each country writes them: `1.5` and `1,5`; `1'080.5`, `1,080.5` and `1.080,5` with marks of thousands.

A column has one decimal mark, by its own numbers, else by those of the other columns. `1.080` may be 1080 where the
decimal mark is a comma, or where no number of the file decides: it is refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_SWAPPED = str.maketrans(",.", ".,")
_BETWEEN = " '\N{RIGHT SINGLE QUOTATION MARK}\N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}\N{THIN SPACE}"
"""What stands between thousands and is no decimal mark."""
_GROUPED = re.compile(rf"[+-]?[1-9]\d{{0,2}}([.,{_BETWEEN}])\d{{3}}(?:\1\d{{3}})*(?:(?!\1)([.,])\d*)?", re.ASCII)
_EITHER = re.compile(r"[+-]?[1-9]\d{0,2}([.,])\d{3}", re.ASCII)
"""A number whose only mark may be that of thousands, or the decimal one."""
_DECIMAL = re.compile(r"[+-]?\d*([.,])\d*(?:[eE][+-]?\d+)?", re.ASCII)


def plain(text: str, mark: str) -> str:
    """Return a number with a decimal point and without marks of thousands; another text nearly as it is.

    mark : the decimal one of its column
    """
    text = text.replace("\N{MINUS SIGN}", "-")
    found = _GROUPED.fullmatch(text)
    if found and found[1] != mark and not _EITHER.fullmatch(text):
        text = text.replace(found[1], "")
    return text.translate(_SWAPPED) if mark == "," else text


def doubtful(text: str, mark: str) -> bool:
    """Return whether nothing says if the mark of a number is that of thousands."""
    return (found := _EITHER.fullmatch(text.replace("\N{MINUS SIGN}", "-"))) is not None and found[1] != mark


def marks_of(columns: Sequence[Sequence[str]], separator: str) -> list[str]:
    """Return the decimal mark of each column by its cells, "" where no number decides.

    In a file with one mark only, a point between bare commas and a comma between semicolons or tabs are decimal ones.
    """
    points, commas = (any(mark in cell for column in columns for cell in column) for mark in ".,")
    if separator == "," and not commas:
        return ["."] * len(columns)
    if separator != "," and not points:
        return [","] * len(columns)
    own = [list(filter(None, map(_decimal, column))) for column in columns]
    every = {mark for marks in own for mark in marks}
    alone = every.pop() if len(every) == 1 else ""
    return [next(iter(marks), alone) for marks in own]


def _decimal(text: str) -> str:
    """Return the decimal mark that a number shows, "" where it shows none."""
    text = text.replace("\N{MINUS SIGN}", "-")
    if _EITHER.fullmatch(text):
        return ""
    if grouped := _GROUPED.fullmatch(text):
        return grouped[2] or {".": ",", ",": "."}.get(grouped[1], "")
    found = _DECIMAL.fullmatch(text)
    return found[1] if found else ""


def half_digit(number: str) -> float:
    """Return half of the last digit of a number with a decimal point."""
    head, *power = re.split("[eE]", number.lstrip("+-"))
    return float("e".join([re.sub(r"\d", "0", head) + ("5" if "." in head else ".5"), *power]))
