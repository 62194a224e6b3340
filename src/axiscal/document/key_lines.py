"""In which line of a TOML text every key stands. The text is known to be valid; only positions are looked for."""

from __future__ import annotations

import re
import tomllib
from bisect import bisect_left

from axiscal.document.quoting import Key

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY_PART = re.compile(r"""[ \t]*(?:([A-Za-z0-9_-]+)|("(?:\\.|[^"\\])*")|'([^']*)')[ \t]*""")
_STRING = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*"{3,5}|' r"'''(?:[^']|'(?!''))*'{3,5}|" r'"(?:\\.|[^"\\])*"|' r"'[^']*'", re.DOTALL
)
_SCALAR = re.compile(r"[^,\]}#\n]+")

_DEEPEST = 100
"""Dots in a key; whoever writes more wants to break the reader."""

Path = tuple[Key, ...]


def line_numbers(text: str) -> dict[Path, int]:
    """Return the line (from 1) of every key path of a valid TOML text, list entries counted from 0.

    A table that is named several times has the line of its first mention.
    Raises RecursionError for a key of more than 100 parts or brackets that are nested too deeply.
    """
    return _Scanner(text).scan()


class _Scanner:
    def __init__(self, text: str) -> None:
        self._text, self._at = text, 0
        self._breaks = [found.start() for found in re.finditer("\n", text)]
        self._lines: dict[Path, int] = {}
        self._last_entry: dict[Path, int] = {}

    def scan(self) -> dict[Path, int]:
        table: Path = ()
        self._skip()
        while self._at < len(self._text):
            if self._text.startswith("[", self._at):
                table = self._header()
            else:
                self._pair(table)
            self._skip()
        return self._lines

    def _skip(self) -> None:
        found = _BLANK.match(self._text, self._at)
        self._at = found.end() if found else self._at

    def _header(self) -> Path:
        line = self._line()
        listed = self._text.startswith("[[", self._at)
        self._at += 2 if listed else 1
        path: Path = ()
        parts = self._key()
        for place, part in enumerate(parts):
            path = (*path, part)
            self._lines.setdefault(path, line)
            if listed and place == len(parts) - 1:
                self._last_entry[path] = self._last_entry.get(path, -1) + 1
            if path in self._last_entry:
                path = (*path, self._last_entry[path])
                self._lines.setdefault(path, line)
        self._at += 2 if listed else 1
        return path

    def _key(self) -> list[str]:
        parts = [self._key_part()]
        while self._text.startswith(".", self._at):
            self._at += 1
            parts.append(self._key_part())
        if len(parts) > _DEEPEST:
            raise RecursionError
        return parts

    def _key_part(self) -> str:
        found = _KEY_PART.match(self._text, self._at)
        assert found is not None  # the text is valid
        self._at = found.end()
        return str(found[1] or (_unescaped(found[2]) if found[2] else found[3]))

    def _pair(self, table: Path) -> None:
        line, path = self._line(), table
        for part in self._key():
            path = (*path, part)
            self._lines.setdefault(path, line)
        self._at += 1
        self._value(path)

    def _value(self, path: Path) -> None:
        self._skip()
        opening = self._text[self._at : self._at + 1]
        if opening == "[":
            self._entries(path)
        elif opening == "{":
            self._inline_table(path)
        else:
            found = (_STRING if opening in "\"'" else _SCALAR).match(self._text, self._at)
            assert found is not None
            self._at = found.end()

    def _entries(self, path: Path) -> None:
        self._at += 1
        self._skip()
        count = 0
        while not self._text.startswith("]", self._at):
            self._lines.setdefault((*path, count), self._line())
            self._value((*path, count))
            count += 1
            self._separator()
        self._at += 1

    def _inline_table(self, path: Path) -> None:
        self._at += 1
        self._skip()
        while not self._text.startswith("}", self._at):
            self._pair(path)
            self._separator()
        self._at += 1

    def _separator(self) -> None:
        self._skip()
        if self._text.startswith(",", self._at):
            self._at += 1
            self._skip()

    def _line(self) -> int:
        return bisect_left(self._breaks, self._at) + 1


def _unescaped(quoted: str) -> str:
    """Return the text of a quoted key."""
    return str(tomllib.loads(f"key = {quoted}")["key"]) if "\\" in quoted else quoted[1:-1]
