"""The table of docs/evidence/equations.md: each numbered equation of the paper, what computes it, and what checks it.

`python -m tests.docs.equations` writes the last two anew. Docstrings are their source: a function that computes an
equation, and a test that checks it, cite it as `B&H eq. 23` or `B&H eq. 21-23`.
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "evidence" / "equations.md"
LAST = 37
BEGIN, END = "<!-- table: made by python -m tests.docs.equations -->", "<!-- end of table -->"

_CITATION = re.compile(r"B&H eq\. (\d+(?:-\d+)?(?:, \d+(?:-\d+)?)*)")
_ROW = re.compile(r"^(\|(\d+)\|.*?\|)", re.MULTILINE)
"""The number of an equation, and what it states."""


@dataclass(frozen=True, slots=True)
class Citation:
    """Where an equation is cited: the file from the root, the name in it (Class.method), and the docstring."""

    path: str
    name: str
    says: str


def cited(docstring: str) -> set[int]:
    """Return the numbers of the equations that a docstring cites."""
    numbers: set[int] = set()
    for found in _CITATION.finditer(" ".join(docstring.split())):
        for part in found[1].split(", "):
            first, _, last = part.partition("-")
            numbers |= set(range(int(first), int(last or first) + 1))
    return numbers


@cache
def citations(folder: str, tests: bool) -> dict[int, list[Citation]]:
    """Return per equation the functions, classes and methods below a folder that cite it, in order of their names.

    tests : only functions that pytest runs
    """
    result: dict[int, list[Citation]] = {number: [] for number in range(1, LAST + 1)}
    for path in sorted((ROOT / folder).rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        for name, docstring in _docstrings(ast.parse(text if "B&H" in text else ""), ""):
            if tests and not name.startswith("test_"):
                continue
            for number in cited(docstring):
                result[number].append(Citation(path.relative_to(ROOT).as_posix(), name, docstring))
    return result


def _docstrings(node: ast.AST, prefix: str) -> Iterator[tuple[str, str]]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef | ast.ClassDef):
            yield prefix + child.name, ast.get_docstring(child) or ""
            yield from _docstrings(child, f"{prefix}{child.name}.")


def table(text: str) -> str:
    """Return the table of a page with its links made anew."""
    functions, tests = citations("src", tests=False), citations("tests", tests=True)
    rows = [
        f"{stated}{_links(functions[int(number)])}|{_links(tests[int(number)])}|"
        for stated, number in _ROW.findall(text)
    ]
    return "\n".join(["|eq.|states|computed by|checked by|", "|---|---|---|---|", *rows])


def _links(found: list[Citation]) -> str:
    return "<br>".join(f"[`{c.name}`](../../{c.path})" for c in found) or "–"


def page(text: str) -> str:
    """Return the page with its table made anew."""
    head, _, rest = text.partition(BEGIN)
    return f"{head}{BEGIN}\n{table(text)}\n{END}{rest.partition(END)[2]}"


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
