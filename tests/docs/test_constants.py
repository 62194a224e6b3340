"""Every number that stands by itself in a module says why it is what it is, or stands with evidence in a table."""

import ast
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from tests.docs.sources import PACKAGE, trees

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "evidence" / "constants.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^- `([\w.]+)` ([^:]+): ([^;]+); (.+)$", PAGE, flags=re.MULTILINE)
NAMED = {name for name, *_ in ROWS}


def _names(target: ast.expr) -> list[str]:
    return [each.id for each in ast.walk(target) if isinstance(each, ast.Name)]


def _assigned(tree: ast.Module) -> Iterator[tuple[int, list[str], ast.expr]]:
    """Yield place, names in capitals, and value of what a module assigns."""
    for place, node in enumerate(tree.body):
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            names = _names(target)
            if names and all(name == name.upper() for name in names):
                yield place, names, node.value


def _has_numbers(value: ast.expr) -> bool:
    return any(isinstance(each, ast.Constant) and type(each.value) in {int, float} for each in ast.walk(value))


def _says_why(tree: ast.Module, place: int, lines: list[str]) -> bool:
    """Return whether a string follows, or a comment stands in the line or above it."""
    node, after = tree.body[place], tree.body[place + 1 : place + 2]
    follows = [each for each in after if isinstance(each, ast.Expr) and isinstance(each.value, ast.Constant)]
    beside = "  # " in lines[(node.end_lineno or 1) - 1] or lines[node.lineno - 2].startswith("# ")
    return bool(follows) or beside


def _silent() -> Iterator[str]:
    for file, tree in trees().items():
        lines = (PACKAGE / file).read_text(encoding="utf-8").splitlines()
        module = file.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        for place, names, value in _assigned(tree):
            known = any(f"{module}.{name}" in NAMED for name in names)
            if _has_numbers(value) and not known and not _says_why(tree, place, lines):
                yield f"{module}.{names[0]}"


def test_every_constant_says_why_or_has_its_evidence_in_the_table() -> None:
    assert list(_silent()) == []


@pytest.mark.parametrize(("name", "value"), [row[:2] for row in ROWS])
def test_the_table_has_the_values_of_the_sources(name: str, value: str) -> None:
    module, _, constant = name.rpartition(".")
    found = getattr(import_module(f"axiscal.{module}"), constant)
    assert value == "in the file" or np.isclose(float(value), found, rtol=1e-3)


@pytest.mark.parametrize(("name", "evidence"), [(row[0], row[3]) for row in ROWS])
def test_the_evidence_is_there(name: str, evidence: str) -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE))
    places = re.findall(r"`([^`]+)`", evidence)
    assert places
    assert [at for at in places if not ((ROOT / at).exists() or at.removeprefix("make ").split()[0] in targets)] == []


def test_no_constant_stands_twice_in_the_table() -> None:
    assert len(NAMED) == len(ROWS) > 30
