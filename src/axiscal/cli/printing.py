"""The only place that writes: results to stdout, everything else to stderr."""

from __future__ import annotations

import json
import sys
import textwrap
from collections.abc import Mapping
from typing import TextIO

WIDTH = 100
"""Columns; a matter of taste."""


def say(text: str) -> None:
    """Write lines to stdout."""
    _write(sys.stdout, text + "\n")


def tell(text: str) -> None:
    """Write a line about the progress to stderr."""
    _write(sys.stderr, text + "\n")


def complain(text: str) -> None:
    """Write one paragraph to stderr: what went wrong, where, and what to do."""
    one_line = " ".join(text.split())
    _write(
        sys.stderr, textwrap.fill(f"axiscal: {one_line}", WIDTH, break_long_words=False, break_on_hyphens=False) + "\n"
    )


def say_document(document: Mapping[str, object]) -> None:
    """Write one JSON document to stdout."""
    say(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False))


def _write(stream: TextIO, text: str) -> None:
    """Write text to a stream that may not know every character."""
    encoding = getattr(stream, "encoding", None) or "utf-8"
    stream.write(text.encode(encoding, "replace").decode(encoding))
    stream.flush()
