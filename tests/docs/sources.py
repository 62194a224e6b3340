"""The files of the package as syntax trees, read once."""

import ast
from collections import defaultdict
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import TypeVar, cast

import axiscal

PACKAGE = Path(axiscal.__path__[0])
Node = TypeVar("Node", bound=ast.AST)


@cache
def trees() -> dict[str, ast.Module]:
    """Return the syntax tree of each file by its path in the package."""
    paths = sorted(PACKAGE.rglob("*.py"))
    return {path.relative_to(PACKAGE).as_posix(): ast.parse(path.read_text(encoding="utf-8")) for path in paths}


@cache
def _by_kind() -> dict[type[ast.AST], list[tuple[str, ast.AST]]]:
    found = defaultdict[type[ast.AST], list[tuple[str, ast.AST]]](list)
    for file, tree in trees().items():
        for node in ast.walk(tree):
            found[type(node)].append((file, node))
    return found


def nodes(kind: type[Node]) -> Iterable[tuple[str, Node]]:
    """Return all nodes of a class with their files."""
    return cast("Iterable[tuple[str, Node]]", _by_kind()[kind])
