"""What a campaign gave, written as files that two runs can share."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

from tests.scenarios.playing import Outcome, Said

MASKED = (
    "Masked, because they differ from run to run or from installation to installation: dates and times of writing "
    "(<date>), versions of programs (<version>), and the clock at readings of a person or of a program (<clock>). "
    "A library that a page carries stands as its checksum.\n"
)
_MASKS = (
    (re.compile(r"\b\d{4}-\d\d-\d\d(?:[T ]\d\d:\d\d(?::\d\d(?:\.\d+)?)?(?:Z|\+00:00)?)?"), "<date>"),
    (re.compile(r'("(?:axiscal|numpy|python|scipy)": )"[^"]*"'), r'\1"<version>"'),
    (re.compile(r"\b(axiscal|numpy|python|scipy) \d+\.\d+[\w.+]*"), r"\1 <version>"),
)


def masked(text: str) -> str:
    """Return a text without what differs from run to run, see `MASKED`."""
    for pattern, word in _MASKS:
        text = pattern.sub(word, text)
    return text


def write(outcome: Outcome, folder: Path) -> None:
    """Write the answers of a campaign in turn, and under `files` what it wrote; raises OSError."""
    texts = {f"files/{name}": text for name, text in outcome.files.items()}
    for number, said in enumerate(outcome.said, start=1):
        texts |= dict(_answer(f"{number:02}-{said.command.words[0]}", said))
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(masked(text), encoding="utf-8", newline="")


def _answer(name: str, said: Said) -> Iterator[tuple[str, str]]:
    """Yield the files of an answer: a document of its own where stdout is one."""
    document = _is_document(said.out)
    if document:
        yield f"{name}.json", said.out
    shown = f"see {name}.json\n" if document else said.out
    line = shlex.join(["axiscal", *said.command.words])
    yield f"{name}.txt", f"$ {line}\nstatus {said.status}\n--- stdout\n{shown}--- stderr\n{said.err}"


def _is_document(text: str) -> bool:
    try:
        return isinstance(json.loads(text), dict)
    except ValueError:
        return False
