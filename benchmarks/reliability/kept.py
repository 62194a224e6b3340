"""What a long run has found so far, kept in build/, so that the same command goes on where it was ended."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

HOUSE = Path(__file__).resolve().parents[2]
FOLDER = HOUSE / "build" / "long-runs"


class Kept:
    """The findings of one command on one state of the sources; of another state it begins anew."""

    def __init__(self, name: str, folder: Path = FOLDER) -> None:
        self._file = folder / f"{name}-{state_of_sources()[:12]}.jsonl"
        self._found = dict[str, Any]()
        if self._file.exists():
            whole = (line for line in self._file.read_text().splitlines(keepends=True) if line.endswith("\n"))
            self._found = {said["key"]: said["found"] for said in map(json.loads, whole)}

    def get(self, key: str, find: Callable[[], Any]) -> Any:
        """Return what was found under a key, found now where it was not; it is anything that JSON can hold."""
        if key not in self._found:
            self._found[key] = json.loads(json.dumps(find()))
            self._file.parent.mkdir(parents=True, exist_ok=True)
            with self._file.open("a") as file:
                file.write(json.dumps({"key": key, "found": self._found[key]}) + "\n")
        return self._found[key]


def state_of_sources(rooms: Iterable[str] = ("src", "benchmarks/reliability")) -> str:
    """Return a hash of the sources as they are."""
    files = sorted(path for room in rooms for path in (HOUSE / room).rglob("*.py"))
    said = "".join(f"{path.relative_to(HOUSE)} {hashlib.sha256(path.read_bytes()).hexdigest()}\n" for path in files)
    return hashlib.sha256(said.encode()).hexdigest()
