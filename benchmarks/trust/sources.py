"""Which sources figures were measured with, as a short name."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def version(beside: Iterable[Path] = ()) -> str:
    """Return a name of all that the package says and does, and of other files: sixteen hexadecimal digits."""
    digest = hashlib.sha256()
    package = sorted(path for path in (ROOT / "src").rglob("*") if path.suffix in (".py", ".toml"))
    for path in (*package, *beside):
        digest.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]
