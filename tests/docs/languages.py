"""The messages of prompt, page and report, and the files of their translations: `make languages`.

A translator edits `language/translations/NAME.po`; this adds messages that are new, takes out those that are gone, and
writes `NAME.mo`, which the program reads.
"""

import ast
import re
import tomllib
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po

from axiscal import exceptions
from axiscal.campaign.ending import ENDINGS
from axiscal.exceptions import InputError
from axiscal.language.spoken import LANGUAGES
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.present.guide.question import ACTIONS

SOURCES = Path(__file__).resolve().parents[2] / "src" / "axiscal"
FOLDER = SOURCES / "language" / "translations"
WORDS = SOURCES / "language" / "words.toml", SOURCES / "document" / "gone.toml"
Message = str | tuple[str, str]
REFUSALS = {name for name, each in vars(exceptions).items() if isinstance(each, type) and issubclass(each, InputError)}
_SAYING = ("said", "counted", "later", "stage")
_NEVER = datetime(2026, 1, 1, tzinfo=UTC)
"""Files that are made anew from the same messages are the same."""
_IN_SCRIPT = re.compile(r'\bsaid\("((?:[^"\\]|\\.)*)"')
_SCRIPTS = [*(SOURCES / "web" / "static").glob("*.js")]


@cache
def messages() -> set[Message]:
    """Return every message: a text, or two of them for one and for many."""
    python = [found for file in SOURCES.rglob("*.py") for found in _said(file)]
    scripts = [
        found[1].replace('\\"', '"')
        for file in _SCRIPTS
        for found in _IN_SCRIPT.finditer(file.read_text(encoding="utf-8"))
    ]
    words = [text for file in WORDS for text in _in_tables(tomllib.loads(file.read_text(encoding="utf-8")))]
    return {*python, *scripts, *words, *_Page.texts(), *ACTIONS, *ENDINGS, *INSTRUMENTS}


def _in_tables(part: object) -> Iterator[str]:
    """Yield the texts of tables and lists."""
    if isinstance(part, str):
        yield part
    else:
        assert isinstance(part, dict | list)
        for each in part.values() if isinstance(part, dict) else part:
            yield from _in_tables(each)


def _said(file: Path) -> Iterator[Message]:
    """Yield what a file says: literals, either of two, or names that hold them in the same function or file."""
    tree = _tree(file)
    everywhere = _held(tree.body)
    for scope in (tree, *_scopes(file)):
        held = everywhere if scope is tree else everywhere | _held(_nodes(scope))
        for call in _calls(scope):
            if isinstance(call.func, ast.Name) and call.func.id in _SAYING:
                texts = [list(_texts(each, held)) for each in call.args]
                if call.func.id == "counted":
                    yield from ((one, many) for one in texts[0] for many in texts[1] if scope is not tree)
                elif texts and (scope is not tree or call.func.id in ("later", "stage")):
                    yield from texts[0]
            elif scope is not tree:
                yield from (text for each in _words(call) for text in _texts(each, held))


def _words(call: ast.Call) -> list[ast.expr]:
    """Return what a call says is wrong, and what would be right; nothing where it refuses nothing."""
    name = _name(call.func)
    if isinstance(call.func, ast.Name) and name in REFUSALS:
        return call.args[:2]
    named = [each.value for each in call.keywords if each.arg in ("what", "remedy")]
    return [call.args[at] for at in _doors().get(name, ()) if at < len(call.args)] + named * (name in _doors())


@cache
def _doors() -> dict[str, list[int]]:
    """Return the functions that refuse in the words of others, and which of their arguments these are."""
    found = {}
    for file in SOURCES.rglob("*.py"):
        for node in _scopes(file):
            if node.name != "__init__":
                parameters = [each.arg for each in node.args.args if each.arg != "self"]
                if "what" in parameters and any(_name(each.func) in (*REFUSALS, "fail") for each in _calls(node)):
                    found[node.name] = [parameters.index(each) for each in ("what", "remedy") if each in parameters]
    return found


def _name(called: ast.expr) -> str:
    return called.id if isinstance(called, ast.Name) else called.attr if isinstance(called, ast.Attribute) else ""


@cache
def _tree(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


@cache
def _scopes(file: Path) -> list[ast.FunctionDef]:
    """Return the functions of a file."""
    return [node for node in _nodes(_tree(file)) if isinstance(node, ast.FunctionDef)]


@cache
def _nodes(scope: ast.FunctionDef | ast.Module) -> list[ast.AST]:
    """Return everything in a function, or in a file."""
    return list(ast.walk(scope))


@cache
def _calls(scope: ast.FunctionDef | ast.Module) -> list[ast.Call]:
    """Return the calls in a function, or in a file."""
    return [node for node in _nodes(scope) if isinstance(node, ast.Call)]


def _assigned(nodes: Iterable[ast.AST]) -> Iterator[tuple[str, ast.expr]]:
    """Yield the names that get values, with these; what several names get at once goes to each."""
    for node in nodes:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AugAssign) else []
        )
        for target in targets:
            assert isinstance(node, ast.Assign | ast.AugAssign)
            pairs = [(each, node.value) for each in (target.elts if isinstance(target, ast.Tuple) else [target])]
            if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                pairs = list(zip(target.elts, node.value.elts, strict=False))  # a starred value holds several, no text
            yield from ((name.id, value) for name, value in pairs if isinstance(name, ast.Name))


def _held(nodes: Iterable[ast.AST]) -> dict[str, list[str]]:
    """Return the texts that names are given."""
    found: dict[str, list[str]] = {}
    for name, value in _assigned(nodes):
        found.setdefault(name, []).extend([*_texts(value, found)])
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
