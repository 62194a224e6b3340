"""The files that a campaign wrote, as texts that can be compared."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from axiscal.record.payload import encode
from axiscal.record.store import Record
from tests.scenarios.scenario import Scenario

LIBRARY = 100_000
"""Characters from which on a script of a page is a library, told by its checksum."""
_DATA = re.compile(r'(<script type="application/json" id="(\w+)">)(.*?)(</script>)', re.DOTALL)
_SCRIPT = re.compile(r"<script>(.*?)</script>", re.DOTALL)


def gathered(folder: Path, scenario: Scenario) -> dict[str, str]:
    """Return what was written into the folder, by name; a record as its events, a page and its figures apart."""
    clock = any(command.looks_at_the_clock for command in scenario.commands)
    found: dict[str, str] = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name not in scenario.inputs:
            found |= dict(_texts(path, name, clock))
    return found


def _texts(path: Path, name: str, clock: bool) -> Iterator[tuple[str, str]]:
    if path.suffix == ".axiscal":
        yield f"{name}.json", json.dumps(_events(path, clock), indent=1, ensure_ascii=False)
    elif path.suffix == ".html":
        yield from _page(path.read_text(encoding="utf-8"), name)
    elif not re.fullmatch(r"\.axiscal-(wal|shm)", path.suffix):
        yield name, path.read_bytes().decode("utf-8", "backslashreplace")


def _events(path: Path, clock: bool) -> list[Any]:
    """Return the events of a record without the time of writing; `clock`: without that of the readings as well."""
    with Record.open(path, write=False) as record:
        rows = [encode(stored.event) for stored in record.events()]
    events = [(kind, json.loads(payload)) for kind, payload in rows]
    for _, payload in events:
        if clock and payload.get("time") is not None:
            payload["time"] = "<clock>"
    return events


def _page(text: str, name: str) -> Iterator[tuple[str, str]]:
    for _, label, data, _ in _DATA.findall(text):
        yield f"{name}.{label}.json", data
    yield name, _SCRIPT.sub(_library, _DATA.sub(r"\1\4", text))


def _library(match: re.Match[str]) -> str:
    script = match.group(1)
    if len(script) < LIBRARY:
        return match.group(0)
    return f"<script of {len(script)} characters, sha256 {hashlib.sha256(script.encode()).hexdigest()}>"
