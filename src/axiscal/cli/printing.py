"""The only place that writes: results to stdout, everything else to stderr."""

from __future__ import annotations

import json
import re
import shutil
import sys
import textwrap
from collections.abc import Iterable, Mapping
from contextvars import ContextVar
from threading import current_thread, main_thread
from typing import TextIO

from axiscal.language.spoken import again, said

WIDTH = 100
"""Columns; a matter of taste."""
DOCUMENTS: ContextVar[bool] = ContextVar("documents", default=False)
"""Whether answers are JSON documents, as --json wants them, or lines for people."""
_KEPT = "\ufdd0"
"""Stands for a space at which no line is to end: a character that no text has."""
_STEERING = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Characters that a terminal obeys rather than shows, all but tab and new line, and halves of characters."""


def say(text: str) -> None:
    """Write lines to stdout."""
    _write(sys.stdout, text + "\n")


def tell(text: str) -> None:
    """Write a line about the progress to stderr."""
    _write(sys.stderr, text + "\n")


def rewrite(text: str) -> None:
    """Write a line to stderr in the place of the one that stands there, as far as there is room for it."""
    width = shutil.get_terminal_size().columns - 1
    sys.stderr.write(f"\r{text[:width].ljust(width)}\r")
    sys.stderr.flush()


def complain(text: str) -> None:
    """Write to stderr what went wrong, where, and what to do, a paragraph a line.  No line ends within a `command`."""
    for line in f"axiscal: {text}".splitlines():
        kept = re.sub("`[^`]+`", lambda command: command[0].replace(" ", _KEPT), " ".join(line.split()))
        hanging = "  " * kept.startswith("- ")
        filled = textwrap.fill(kept, WIDTH, subsequent_indent=hanging, break_long_words=False, break_on_hyphens=False)
        _write(sys.stderr, filled.replace(_KEPT, " ") + "\n")


def say_document(document: Mapping[str, object]) -> None:
    """Write one JSON document to stdout."""
    say(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False))


def say_either(schema: str, document: Mapping[str, object], lines: Iterable[str]) -> None:
    """Write an answer to stdout: as a JSON document of a schema, or as lines for people."""
    if DOCUMENTS.get():
        say_document({"schema": schema, **document})
    else:
        say("\n".join(lines))


def mind_lines(*sentences: str | None) -> list[str]:
    """Return lines of the first two sentences to be minded: nobody minds more, so what weighs most comes first."""
    return [said("Mind: {sentence}", sentence=again(each)) for each in [*filter(None, sentences)][:2]]


def tell_minds(*sentences: str | None) -> None:
    """Write these lines to stderr."""
    for line in mind_lines(*sentences):
        tell(line)


def ask(prompt: str) -> str:
    """Return the line that a person types behind a prompt."""
    return input(visible(prompt))


def agreed(question: str) -> bool:
    """Return whether a person says yes; a page in a browser asks nobody."""
    if current_thread() is not main_thread():
        return False
    tell(question)
    return ask("[y/N] ").strip().casefold() in ("y", "yes", "j", "ja")


def visible(text: str) -> str:
    """Return text that steers no terminal: such characters as JSON writes them, so that a document stays the same."""
    return _STEERING.sub(lambda found: json.dumps(found[0])[1:-1], text)


def _write(stream: TextIO, text: str) -> None:
    """Write text to a stream that may not know every character."""
    encoding = getattr(stream, "encoding", None) or "utf-8"
    stream.write(visible(text).encode(encoding, "replace").decode(encoding))
    stream.flush()
