"""Code that a campaign names runs only where its reader said yes to that very text, once, on this computer.

The yes is kept by the SHA-256 of the text in a file of the user's. Who names a campaign.toml himself says it by that.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Callable
from contextvars import ContextVar
from pathlib import Path

from axiscal.exceptions import CodeError
from axiscal.language.spoken import said, setting

RUN = "AXISCAL_RUN"
"""Variable of the environment: the SHA-256 of texts that may run, for programs without a terminal."""
Asking = Callable[[str], bool]


def nobody(_question: str) -> bool:
    """Return no: nobody is there to be asked."""
    return False


_ASKED: ContextVar[Asking | None] = ContextVar("asked", default=nobody)
_HERE = set[str]()
"""What was said yes to in this process: the folder of the user may not be written."""


def asking(person: Asking | None) -> contextlib.AbstractContextManager[None]:
    """Let a person be asked in the block; None : nothing is run there, whatever was said before."""
    return setting(_ASKED, person)


def user_folder() -> Path:
    """Return where keys and answers of this user are."""
    folder = os.environ.get("XDG_CONFIG_HOME") or os.environ.get("APPDATA")
    return (Path(folder) if folder else Path.home() / ".config") / "axiscal"


def refuse_unread(file: Path, text: bytes, *, own: bool) -> None:
    """Raise CodeError for code that nobody said yes to.  own : who reads the campaign named it himself"""
    digest, person, kept = hashlib.sha256(text).hexdigest(), _ASKED.get(), user_folder() / "code.txt"
    count = len(text.splitlines())
    if person is not None:
        if digest in _HERE or digest in os.environ.get(RUN, "").split() or digest in _lines(kept):
            return
        question = said("Run {count} lines of {file}, sha {digest}?", count=count, file=file, digest=digest)
        if own or person(question):
            _HERE.add(digest)
            with contextlib.suppress(OSError):
                kept.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
                with kept.open("a", encoding="utf-8") as lines:
                    lines.write(f"{digest} {file.name}\n")
            return
    what = (
        "{file} is code that came with this campaign, and was not run: {count} lines, sha {digest}. Read it. If it may "
        "run, give a command that estimates on a terminal, or set {variable}={digest}."
    )
    raise CodeError(said(what, file=file, count=count, digest=digest, variable=RUN))


def _lines(kept: Path) -> list[str]:
    with contextlib.suppress(OSError, UnicodeDecodeError):
        return [line.split(" ")[0] for line in kept.read_text(encoding="utf-8").splitlines()]
    return []
