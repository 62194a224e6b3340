"""The messages of prompt and page, and the files of their translations: `make languages`.

A translator edits `guide/languages/NAME.po`; this adds messages that are new, takes out those that are gone, and writes
`NAME.mo`, which the program reads.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from datetime import UTC, datetime
from html.parser import HTMLParser
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po

from axiscal.guide.answers import ACTIONS
from axiscal.guide.endings import ENDINGS
from axiscal.guide.language import LANGUAGES
from axiscal.measurement.instrument import INSTRUMENTS

SOURCES = Path(__file__).resolve().parents[2] / "src" / "axiscal"
FOLDER = SOURCES / "guide" / "languages"
Message = str | tuple[str, str]
_NEVER = datetime(2026, 1, 1, tzinfo=UTC)
"""Files that are made anew from the same messages are the same."""
_IN_SCRIPT = re.compile(r'\bsaid\("((?:[^"\\]|\\.)*)"')


def messages() -> set[Message]:
    """Return every message: a text, or two of them for one and for many."""
    python = [
        found for room in ("guide", "cli", "web") for file in (SOURCES / room).glob("*.py") for found in _said(file)
    ]
    scripts = [
        found[1].replace('\\"', '"')
        for file in (SOURCES / "web" / "static").glob("*.js")
        for found in _IN_SCRIPT.finditer(file.read_text(encoding="utf-8"))
    ]
    return {*python, *scripts, *_Page.texts(), *ACTIONS, *ENDINGS, *INSTRUMENTS}


def _said(file: Path) -> Iterator[Message]:
    """Yield what a file says: a literal, or a name that holds one in the same file."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    held = {
        target.id: node.value.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("said", "counted"):
            texts = [
                each.value if isinstance(each, ast.Constant) else held.get(getattr(each, "id", ""))
                for each in node.args
            ]
            if node.func.id == "counted":
                yield str(texts[0]), str(texts[1])
            elif isinstance(texts[0], str):
                yield texts[0]


class _Page(HTMLParser):
    """The texts that stand in the page itself."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self._inside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take the names that are read aloud."""
        self._inside.append(tag)
        self.found += [value for name, value in attrs if name == "aria-label" and value]

    def handle_data(self, data: str) -> None:
        """Take what is shown."""
        if data.strip() and self._inside[-1] != "title":
            self.found.append(data.strip())

    @classmethod
    def texts(cls) -> list[str]:
        """Return all of them but the page's name, the dashes before there are figures, and the unit of nothing."""
        page = cls()
        for file in sorted((SOURCES / "web" / "static").glob("*.html")):
            page.feed(file.read_text(encoding="utf-8"))
        return [text for text in page.found if text not in ("axiscal", "–")]


def translated(language: str) -> Catalog:
    """Return the translations of a language as its file has them."""
    with (FOLDER / f"{language}.po").open("rb") as file:
        return read_po(file, locale=language)


def catalogue(language: str) -> Catalog:
    """Return the translations of a language, brought up to the messages there are."""
    path = FOLDER / f"{language}.po"
    old = translated(language) if path.is_file() else Catalog(locale=language)
    about = {
        "project": "axiscal",
        "last_translator": "the axiscal authors",
        "language_team": "",
        "msgid_bugs_address": "",
    }
    about |= {"header_comment": f"# {LANGUAGES.get(language, language)}, for prompt and page."}
    new = Catalog(locale=language, creation_date=_NEVER, revision_date=_NEVER, fuzzy=False, **about)
    for message in sorted(messages(), key=str):
        known = old.get(message if isinstance(message, str) else message[0])
        new.add(message, known.string if known is not None else None)
    return new


def main() -> None:
    """Write the files of every language but English anew."""
    FOLDER.mkdir(exist_ok=True)
    for language in LANGUAGES:
        if language != "en":
            found = catalogue(language)
            with (FOLDER / f"{language}.po").open("wb") as file:
                write_po(file, found, width=110)
            with (FOLDER / f"{language}.mo").open("wb") as file:
                write_mo(file, found)


if __name__ == "__main__":
    main()
