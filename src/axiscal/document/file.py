"""Reading a TOML text from a file, and saying what is wrong with it when it cannot be read.

Every key knows its line. Where these are looked for the text is known to be valid; only positions are looked for.
"""

from __future__ import annotations

import errno
import re
import tomllib
from bisect import bisect_left
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from axiscal.document.bounded import bounded_content
from axiscal.document.quoting import Key, dotted, shown
from axiscal.exceptions import DescriptionError, InputError
from axiscal.language.spoken import later, put, said

LARGEST = 250_000
"""Bytes; a description has a few thousand."""
LONGEST_LINE = 5_000
"""Characters."""

_LONG_KEY = re.compile(r"""(?<![A-Za-z0-9_-])(?:(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')[ \t]*\.[ \t]*){100}""")
_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")
_BARE_QUANTITY = re.compile(r"[=\[,]\s*[+-]?[0-9][0-9.,]*\s*[^\s0-9.,\]}_:eE+#-]")
_BARE_PARENTHESES = re.compile(r"""[^"'=]*[()][^"'=]*=""")


@dataclass(frozen=True, slots=True)
class Document:
    """A parsed TOML document.

    data : the tables as dictionaries; lines : line (from 1) of every key path, list entries counted from 0
    """

    path: Path
    text: str
    data: dict[str, Any]
    lines: dict[tuple[Key, ...], int] = field(repr=False)

    @classmethod
    def read(cls, path: str | Path) -> Document:
        """Return the document in a file; raises DescriptionError for a file that cannot be read as TOML."""
        return cls.parse(_decoded(_content(Path(path)), Path(path)), path)

    @classmethod
    def parse(cls, text: str, path: str | Path) -> Document:
        """Return the document in a text; `path` is what failures call it. Raises DescriptionError if it is not TOML."""
        path = Path(path)
        _check_lines(text, path)
        try:
            return cls(path, text, tomllib.loads(text), line_numbers(text))
        except tomllib.TOMLDecodeError as fault:
            raise _syntax_failure(str(fault), text, path) from None
        except RecursionError:
            raise DescriptionError("the brackets are nested too deeply", "A description is flat", path) from None
        except ValueError as fault:
            raise DescriptionError("not valid TOML: {fault}", "Write a shorter number", path, fault=fault) from None

    def line(self, *keys: Key) -> int | None:
        """Return the line of a key path such as ("setups", 1, "noise"), or of the nearest table around it."""
        for end in range(len(keys), 0, -1):
            if (found := self.lines.get(keys[:end])) is not None:
                return found
        return None

    def fault(self, failure: InputError, *keys: Key) -> InputError:
        """Return a failure placed in this file at the line of a key path, its text beginning with the dotted path."""
        led = put("{keys}: {fault}", keys=dotted(keys), fault=failure.what)
        failure = type(failure)(led, failure.remedy) if keys else failure
        return failure.at(self.path, self.line(*keys))

    @contextmanager
    def placed(self, *keys: Key) -> Iterator[None]:
        """Place what is raised in a block at the line of a key path, as `fault` does."""
        try:
            yield
        except InputError as failure:
            raise self.fault(failure, *keys) from None


def _check_lines(text: str, path: Path) -> None:
    """Raise DescriptionError for a text that no person wrote: too large, or with a line that is too long."""
    if len(text) > LARGEST:
        raise _too_large(path)
    for number, line in enumerate(text.split("\n"), 1):
        # tomllib needs time and memory by the square of the number of dots in a key.
        if line.count(".") > 100 and _LONG_KEY.search(line):
            raise DescriptionError("a key has more than 100 parts", "A description is flat", path, number)
        if len(line) > LONGEST_LINE:
            what, remedy = "the line {shown} has {count} characters, more than {most}", "Break it into shorter lines"
            raise DescriptionError(
                what, remedy, path, number, shown=shown(line[:40]), count=len(line), most=LONGEST_LINE
            )


def _too_large(path: Path) -> DescriptionError:
    what = "the file is larger than {most} kB"
    return DescriptionError(what, "Give a description, which has a few thousand bytes", path, most=LARGEST // 1000)


def _content(path: Path) -> bytes:
    """Return the bytes of a file; raises DescriptionError when it cannot be read or is no description by its size."""
    try:
        return bounded_content(path, LARGEST)
    except FileNotFoundError:
        raise DescriptionError("there is no such file", "Give the path of a TOML file", shown_path(path)) from None
    except IsADirectoryError:
        raise DescriptionError("this is a folder, not a file", "Give the path of a TOML file", path) from None
    except (OSError, ValueError) as fault:
        if getattr(fault, "errno", None) == errno.EFBIG:
            raise _too_large(path) from None
        reason = getattr(fault, "strerror", None) or str(fault)
        remedy = "Give a readable file"
        raise DescriptionError("the file cannot be read: {reason}", remedy, shown_path(path), reason=reason) from None


def _decoded(content: bytes, path: Path) -> str:
    """Return the text of a file; raises DescriptionError for anything but plain UTF-8."""
    remedy = "Save it as plain text in UTF-8"
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise DescriptionError("the file is in UTF-16", remedy, path, 1)
    if content.startswith(b"\xef\xbb\xbf"):
        remedy = "Save it as plain text in UTF-8 without a byte order mark"
        raise DescriptionError("the file begins with a byte order mark", remedy, path, 1)
    if (place := content.find(b"\0")) >= 0:
        line = content.count(b"\n", 0, place) + 1
        raise DescriptionError("the file holds a NUL byte, so it is not a text", remedy, path, line)
    try:
        return content.decode()
    except UnicodeDecodeError as fault:
        line = content.count(b"\n", 0, fault.start) + 1
        what = "byte 0x{content:02x} is not UTF-8"
        raise DescriptionError(what, remedy, path, line, content=content[fault.start]) from None


def _syntax_failure(fault: str, text: str, path: Path) -> DescriptionError:
    """Return the failure for a TOML syntax fault, with the line it stands in."""
    lines = text.split("\n")
    place = _PLACE.search(fault)
    reason = fault[: place.start()] if place else fault
    number = int(place[1]) if place and place[1] else _last_open_line(reason, lines)
    content = lines[number - 1].strip() if number <= len(lines) else ""
    what = "not valid TOML in the line {content} ({reason})"
    remedy = said(_syntax_remedy(reason, content))
    return DescriptionError(what, remedy, path, number, content=shown(content), reason=reason.lower())


def _last_open_line(reason: str, lines: list[str]) -> int:
    """Return the line to show when a text ended too early: where a single quote was left open, or its last."""
    wanted = [number for number, line in enumerate(lines, 1) if line.strip()]
    opened = [number for number in wanted if lines[number - 1].count("'") % 2]
    return opened[-1] if opened and "'" in reason else wanted[-1] if wanted else 1


def _syntax_remedy(reason: str, content: str) -> str:
    if _BARE_QUANTITY.search(content):
        return later('Quantities stand in quotes, such as length = "120 mm"')
    if _BARE_PARENTHESES.match(content):
        return later('Names with parentheses stand in quotes, such as "C(0X)Y" = { std = "30 urad" }')
    if "overwrite" in reason or "twice" in reason or "mutate" in reason:
        return later("Every key and every table is given once")
    return later('Write lines such as length = "120 mm" below headings such as [tool]')


def shown_path(path: Path) -> str:
    """Return a path that can be printed whatever was typed."""
    return shown(str(path))[1:-1]


_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY_PART = re.compile(r"""[ \t]*(?:([A-Za-z0-9_-]+)|("(?:\\.|[^"\\])*")|'([^']*)')[ \t]*""")
_STRING = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*"{3,5}|' r"'''(?:[^']|'(?!''))*'{3,5}|" r'"(?:\\.|[^"\\])*"|' r"'[^']*'", re.DOTALL
)
_SCALAR = re.compile(r"[^,\]}#\n]+")

_DEEPEST = 100
"""Dots in a key; whoever writes more wants to break the reader."""

KeyPath = tuple[Key, ...]


def line_numbers(text: str) -> dict[KeyPath, int]:
    """Return the line (from 1) of every key path of a valid TOML text, list entries counted from 0.

    A table that is named several times has the line of its first mention.
    Raises RecursionError for a key of more than 100 parts or brackets that are nested too deeply.
    """
    return _Scanner(text).scan()


class _Scanner:
    def __init__(self, text: str) -> None:
        self._text, self._at = text, 0
        self._breaks = [found.start() for found in re.finditer("\n", text)]
        self._lines: dict[KeyPath, int] = {}
        self._last_entry: dict[KeyPath, int] = {}

    def scan(self) -> dict[KeyPath, int]:
        table: KeyPath = ()
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

    def _header(self) -> KeyPath:
        line = self._line()
        listed = self._text.startswith("[[", self._at)
        self._at += 2 if listed else 1
        path: KeyPath = ()
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

    def _pair(self, table: KeyPath) -> None:
        line, path = self._line(), table
        for part in self._key():
            path = (*path, part)
            self._lines.setdefault(path, line)
        self._at += 1
        self._value(path)

    def _value(self, path: KeyPath) -> None:
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

    def _entries(self, path: KeyPath) -> None:
        self._at += 1
        self._skip()
        count = 0
        while not self._text.startswith("]", self._at):
            self._lines.setdefault((*path, count), self._line())
            self._value((*path, count))
            count += 1
            self._separator()
        self._at += 1

    def _inline_table(self, path: KeyPath) -> None:
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
