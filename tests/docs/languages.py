"""The messages of prompt, page and report, and the files of their translations: `make languages`.

A translator edits `language/translations/NAME.po`; this adds messages that are new, takes out those that are gone, and
writes `NAME.mo`, which the program reads.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po

from axiscal import exceptions
from axiscal.campaign.ended_words import ENDINGS
from axiscal.exceptions import InputError
from axiscal.language.spoken import LANGUAGES
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.present.guide.answers import ACTIONS

SOURCES = Path(__file__).resolve().parents[2] / "src" / "axiscal"
FOLDER = SOURCES / "language" / "translations"
Message = str | tuple[str, str]
REFUSALS = {name for name, each in vars(exceptions).items() if isinstance(each, type) and issubclass(each, InputError)}
MET = (
    *("campaign/", "record/", "document/", "units.py", "present/", "web/"),
    *("cli/arguments.py", "cli/compensation_active.py", "cli/opened.py", "cli/outputs.py"),
    *("cli/placed_log.py", "cli/plan.py", "cli/record.py", "cli/run_loop.py"),
    *("measurement/readers/csv_", "measurement/readers/text.py"),
)
"""Where refusals are raised that a person meets at the machine: these are translated, all others are in English."""
_SAYING = ("said", "counted", "later", "stage")
_NEVER = datetime(2026, 1, 1, tzinfo=UTC)
"""Files that are made anew from the same messages are the same."""
_IN_SCRIPT = re.compile(r'\b(?:said|rich)\("((?:[^"\\]|\\.)*)"')
_TEMPLATES = [*(SOURCES / "web" / "static").glob("*.js"), *(SOURCES / "present" / "templates").iterdir()]


@cache
def messages() -> set[Message]:
    """Return every message: a text, or two of them for one and for many."""
    python = [found for file in SOURCES.rglob("*.py") for found in _said(file)]
    scripts = [
        found[1].replace('\\"', '"')
        for file in _TEMPLATES
        for found in _IN_SCRIPT.finditer(file.read_text(encoding="utf-8"))
    ]
    return {*python, *scripts, *_Page.texts(), *ACTIONS, *ENDINGS, *INSTRUMENTS}


def _said(file: Path) -> Iterator[Message]:
    """Yield what a file says: literals, either of two, or names that hold them in the same function or file."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    everywhere = _held(node for node in tree.body if isinstance(node, ast.Assign))
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    for scope in (tree, *functions):
        own = _held(node for node in ast.walk(scope) if isinstance(node, ast.Assign)) if scope is not tree else {}
        for node in ast.walk(scope):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _SAYING:
                texts = [list(_texts(each, everywhere | own)) for each in node.args]
                if node.func.id == "counted":
                    yield from ((one, many) for one in texts[0] for many in texts[1] if scope is not tree)
                elif texts and (scope is not tree or node.func.id in ("later", "stage")):
                    yield from texts[0]
            elif scope is not tree and isinstance(node, ast.Call) and _name(node.func) in REFUSALS and _met(file):
                yield from (text for each in node.args[:2] for text in _texts(each, everywhere | own))


def refusals() -> Iterator[tuple[str, bool]]:
    """Yield each refusal by its file and line, and whether it is said in other languages."""
    for file in sorted(SOURCES.rglob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for scope in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
            held = _held(node for node in ast.walk(scope) if isinstance(node, ast.Assign))
            for node in ast.walk(scope):
                if isinstance(node, ast.Call) and _name(node.func) in REFUSALS:
                    whole = all(list(_texts(each, held)) or _is_said(each) for each in node.args[:2])
                    yield f"{file.relative_to(SOURCES)}:{node.lineno}", whole and _met(file)


def _is_said(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and _name(node.func) in _SAYING


def _name(called: ast.expr) -> str:
    return called.id if isinstance(called, ast.Name) else ""


def _met(file: Path) -> bool:
    """Return whether refusals of a file are met at the machine, and so are translated."""
    return file.relative_to(SOURCES).as_posix().startswith(MET)


def _held(nodes: Iterable[ast.Assign]) -> dict[str, list[str]]:
    """Return the texts that names are given."""
    found: dict[str, list[str]] = {}
    for node in nodes:
        for target in node.targets:
            pairs = [(target, node.value)]
            if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                pairs = list(zip(target.elts, node.value.elts, strict=False))  # a starred value holds several, no text
            for name, value in pairs:
                if isinstance(name, ast.Name) and isinstance(value, ast.Constant) and isinstance(value.value, str):
                    found.setdefault(name.id, []).append(value.value)
    return found


def _texts(node: ast.expr, held: dict[str, list[str]]) -> Iterator[str]:
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.IfExp):
        yield from (text for branch in (node.body, node.orelse) for text in _texts(branch, held))
    elif isinstance(node, ast.Name):
        yield from held.get(node.id, ())


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
    about |= {"header_comment": f"# {LANGUAGES.get(language, language)}, for prompt, page and report."}
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
