"""Cells of CSV files that people open in spreadsheets: text that would be a formula there is shielded, and read back.

A cell that is not a number and whose first character, quotes left aside, is one of `= + - @`, tab or return gets an
apostrophe in front, which spreadsheets take for "this is text"; reading takes one away. So every text comes back.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Sequence

_FORMULA = re.compile(r"'*[=+\-@\t\r]")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


def csv_text(rows: Iterable[Sequence[str]]) -> str:
    """Return a CSV file of text and of numbers as they are written."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([_shielded(cell) for cell in row] for row in rows)
    return text.getvalue()


def unshielded(cell: str) -> str:
    """Return the text that a cell stands for."""
    return cell[1:] if cell[:1] == "'" and _FORMULA.match(cell) else cell


def _shielded(cell: str) -> str:
    return f"'{cell}" if _FORMULA.match(cell) and not _NUMBER.fullmatch(cell) else cell
