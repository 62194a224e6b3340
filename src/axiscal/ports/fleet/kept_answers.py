"""What records come to, kept in the user's folder for what can be made anew, by the chain of all that each holds.

Nothing is said of where a record stands: the same campaign in a folder, a copy of it and one on a server have one name.
A file that was changed by anybody or anything else, or by other versions, holds nothing.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from axiscal.campaign.versions import versions
from axiscal.document.durable import write_whole

Answers = Mapping[str, Mapping[str, Any]]
"""By chain, what can be written as JSON."""


def kept_answers() -> Answers:
    """Return the answers of these versions; none where they cannot be read or are not as they were written."""
    with contextlib.suppress(OSError, ValueError, RecursionError):
        digest, _, text = _file().read_text(encoding="utf-8").partition("\n")
        if digest == _digest(text):
            found: Answers = json.loads(text)
            return found
    return {}


def keep_answers(answers: Answers) -> None:
    """Keep answers in the place of those before; raises OSError."""
    file, text = _file(), json.dumps(answers, sort_keys=True)
    file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    write_whole(file, f"{_digest(text)}\n{text}".encode())


def _digest(text: str) -> str:
    """Return the SHA-256 of answers and of the versions that they follow from."""
    return hashlib.sha256(f"{json.dumps(versions(), sort_keys=True)}\n{text}".encode()).hexdigest()


def _file() -> Path:
    named = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(named) if named else Path.home() / ".cache") / "axiscal" / "fleet.json"
