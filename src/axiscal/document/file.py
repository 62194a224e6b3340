"""Reading a TOML text from a file, and saying what is wrong with it when it cannot be read.

Every key knows its line.
"""

from __future__ import annotations

import errno
import math
import os
import re
import stat
import tomllib
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from axiscal.document.quoting import Key, dotted, shown
from axiscal.exceptions import DescriptionError, InputError
from axiscal.language.spoken import later, put, said


def bounded_content(path: str | Path, most: int) -> bytes:
    """Return the bytes of a file or a pipe.

    Raises OSError for what is neither, cannot be read, or has more than `most` bytes; ValueError for no name of a file.
    """
    if not (stat.S_ISREG(mode := os.stat(path).st_mode) or stat.S_ISFIFO(mode)):
        raise OSError(errno.EINVAL, "it is a folder" if stat.S_ISDIR(mode) else "it is a device and no file", str(path))
    with open(path, "rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        size = f"{most // 1_000_000} MB" if most >= 1_000_000 else f"{most // 1000} kB"
        raise OSError(errno.EFBIG, f"it has more than {size}", str(path))
    return content


def number_or_none(text: str) -> float | None:
    """Return a text as a finite number, None where it is none."""
    try:
        value = float(text) if "_" not in text else math.nan
    except ValueError:
        return None
    return value if math.isfinite(value) else None


LARGEST = 250_000
"""Bytes; a description has a few thousand."""
LONGEST_LINE = 5_000
"""Characters."""

_LONG_KEY = re.compile(r"""(?<![A-Za-z0-9_-])(?:(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')[ \t]*\.[ \t]*){100}""")
_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")
_BARE_QUANTITY = re.compile(r"[=\[,]\s*[+-]?[0-9][0-9.,]*\s*[^\s0-9.,\]}_:eE+#-]")
_BARE_PARENTHESES = re.compile(r"""[^"'=]*[()][^"'=]*=""")


@dataclass(frozen=True)
class Document:
    """A parsed TOML document.

    data : the tables as dictionaries
    """

    path: Path
    text: str
    data: dict[str, Any]

    @classmethod
    def read(cls, path: str | Path) -> Document:
        """Return the document in a file; raises DescriptionError for a file that cannot be read as TOML."""
        return cls.parse(_decoded(_content(Path(path)), Path(path)), path)

    @classmethod
    def parse(cls, text: str, path: str | Path) -> Document:
        """Return the document in a text; `path` is what failures call it. Raises DescriptionError if it is not TOML."""
        path = Path(path)
        if len(text) > LARGEST:
            raise _too_large(path)
        for number, line in enumerate(text.split("\n"), 1):
            # tomllib needs time and memory by the square of the number of dots in a key.
            if line.count(".") > 100 and _LONG_KEY.search(line):
                raise DescriptionError("a key has more than 100 parts", "A description is flat", path, number)
            if len(line) > LONGEST_LINE:
                what = "the line {shown} has {count} characters, more than {most}"
                sizes, remedy = {"count": len(line), "most": LONGEST_LINE}, "Break it into shorter lines"
                raise DescriptionError(what, remedy, path, number, shown=shown(line[:40]), **sizes)
        try:
            return cls(path, text, tomllib.loads(text))
        except tomllib.TOMLDecodeError as fault:
            raise _syntax_failure(str(fault), text, path) from None
        except RecursionError:
            raise DescriptionError("the brackets are nested too deeply", "A description is flat", path) from None
        except ValueError as fault:
            raise DescriptionError("not valid TOML: {fault}", "Write a shorter number", path, fault=fault) from None

    def line(self, *keys: Key) -> int | None:
        """Return the line of a key path such as ("setups", 1, "noise"), or of the nearest table around it.

        It is the last of the fewest lines that say it; None where these have been looked for for too long.
        """
        lines = range(1, self.text.count("\n") + 2)
        for path in (keys[:end] for end in range(len(keys), 0, -1)):
            if _holds(self.data, path):
                found = bisect_left(lines, True, key=lambda count: _holds(self._said_by(count), path))
                return lines[found] if self._read[0].total() < _MOST_TRIED else None
        return None

    @cached_property
    def _read(self) -> tuple[Counter[int], dict[int, dict[str, Any]]]:
        return Counter(), {}  # characters that were read once more, and what so many lines say

    def _said_by(self, count: int) -> dict[str, Any]:
        """Return what so many lines say, of a value that goes on behind them what stands in them."""
        (tried, known), lines = self._read, self.text.split("\n")[:count]
        while lines and count not in known and tried.total() < _MOST_TRIED:
            begun = "\n".join([*lines, ""])
            tried[count] += len(begun)
            for closing in _CLOSINGS:
                with suppress(tomllib.TOMLDecodeError):
                    known[count] = tomllib.loads(begun + closing)
                    break
            lines.pop()
        return known.get(count, {})

    def fault(self, failure: InputError, *keys: Key) -> InputError:
        """Return a failure placed in this file at the line of a key path, its text beginning with the dotted path."""
        led = put("{keys}: {fault}", keys=dotted(keys), fault=failure.what)
        failure = type(failure)(led, failure.remedy) if keys else failure
        return failure.placed(self.path, self.line(*keys))

    @contextmanager
    def placed(self, *keys: Key) -> Iterator[None]:
        """Place what is raised in a block at the line of a key path, as `fault` does, unless it has its place."""
        try:
            yield
        except InputError as failure:
            raise failure if failure.file is not None else self.fault(failure, *keys) from None


def _too_large(path: Path) -> DescriptionError:
    what = "the file is larger than {most} kB"
    return DescriptionError(what, "Give a description, which has a few thousand bytes", path, most=LARGEST // 1000)


def _content(path: Path) -> bytes:
    """Return the bytes of a file; raises DescriptionError when it cannot be read or is no description by its size."""
    try:
        return bounded_content(path, LARGEST)
    except FileNotFoundError:
        raise DescriptionError("there is no such file", "Give the path of a TOML file", shown_path(path)) from None
    except (OSError, ValueError) as fault:
        if getattr(fault, "errno", None) == errno.EFBIG:
            raise _too_large(path) from None
        what, reason = "the file cannot be read: {reason}", getattr(fault, "strerror", None) or str(fault)
        raise DescriptionError(what, "Give the path of a TOML file", shown_path(path), reason=reason) from None


def _decoded(content: bytes, path: Path) -> str:
    """Return the text of a file; raises DescriptionError for anything but plain UTF-8."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        line, what = content.count(b"\n", 0, fault.start) + 1, "byte 0x{content:02x} is not UTF-8"
        remedy, byte = "Save it as plain text in UTF-8", content[fault.start]
        raise DescriptionError(what, remedy, path, line, content=byte) from None


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


_MOST_TRIED = 300_000
"""Characters that are read once more to find lines: of time. A description has a few thousand."""
_CLOSINGS = ("", "]", "]]", "]}", "}]", '"""', "'''")
"""What makes a statement whole that goes on in the next line."""


def _holds(said: Any, path: tuple[Key, ...]) -> bool:
    """Return whether there is a key path in a value."""
    for key in path:
        keys = said if isinstance(said, dict) else range(len(said)) if isinstance(said, list) else ()
        if key not in keys:
            return False
        said = said[key]
    return True
