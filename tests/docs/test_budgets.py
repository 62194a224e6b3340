"""Size, and what a reader has to hold in mind: what is there today, and what is to be reached. It can only go down."""

from __future__ import annotations

import ast
import json
import math
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.docs.sources import PACKAGE, nodes, trees

CAMPAIGN = Path(__file__).parents[1] / "golden" / "campaigns" / "mill" / "campaign.toml"


class Budget(NamedTuple):
    """today : of the last release; to_reach : what it is to become"""

    today: int
    to_reach: int

    @property
    def most(self) -> int:
        """More is a defect. Between releases there is 3 % of play, so that no first change of a stranger is red."""
        return math.ceil(1.03 * self.today)


SIZES = {
    "lines of src": Budget(63_300, 50_000),
    "files of src": Budget(335, 325),
    "mechanisms that remember": Budget(3, 1),
    "classes that change": Budget(26, 15),
    "public names of more than five functions": Budget(13, 10),
}
WALKS = {
    "next m.axiscal": {"files": Budget(48, 43), "functions": Budget(300, 250), "frames": Budget(20, 16)},
    "record asked.axiscal 1um": {"files": Budget(91, 60), "functions": Budget(636, 250), "frames": Budget(24, 16)},
    "plan campaign.toml --readings 12": {"files": Budget(106, 60)},
}
"""Of the campaign `mill`, of four set-ups, which is planned: the functions of axiscal that a command enters."""

REMEMBERING = {"cached_property", "cache", "lru_cache", "Memo"}
"""Parts that remember; whatever else does is counted one by one."""
CHANGING = {"append", "extend", "insert", "add", "update", "setdefault", "pop", "remove", "discard", "clear"}


def _lines() -> int:
    return sum(len((PACKAGE / file).read_text(encoding="utf-8").splitlines()) for file in trees())


def _of_self(node: ast.AST) -> bool:
    """Whether this is an attribute of the object, or an entry of one."""
    while isinstance(node, ast.Subscript):
        node = node.value
    return isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self"


def _changes(node: ast.AST) -> bool:
    """Whether a statement or a call changes what the object holds."""
    match node:
        case ast.Assign(targets=targets):
            parts = (getattr(target, "elts", [target]) for target in targets)
            return any(_of_self(each) for elements in parts for each in elements)
        case ast.AugAssign(target=target) | ast.AnnAssign(target=target):
            return _of_self(target)
        case ast.Call(func=ast.Attribute(value=held, attr=name)) if name in CHANGING:
            return _of_self(held)
    return False


def _changing() -> list[str]:
    """Return the classes whose objects change after they were made."""
    return [
        f"{file}: {node.name}"
        for file, node in nodes(ast.ClassDef)
        for each in node.body
        if isinstance(each, ast.FunctionDef) and each.name not in ("__init__", "__post_init__")
        if any(_changes(inner) for inner in ast.walk(each))
    ]


def _kept_by_hand() -> set[str]:
    """Return the functions that look into a dictionary of their object, and keep there what is not in it."""
    found = set[str]()
    for file, node in nodes(ast.If):
        match node:
            case ast.If(test=ast.Compare(ops=[ast.NotIn()], comparators=[held])) if _of_self(held):
                stores = (each for part in node.body for each in ast.walk(part) if isinstance(each, ast.Subscript))
                if any(ast.unparse(each.value) == ast.unparse(held) for each in stores):
                    found.add(f"{file}: {ast.unparse(held)}")
    return found - {"numerics/remembered.py: self._answers"}


def _remembering() -> list[str]:
    names = {node.id for _, node in nodes(ast.Name)}
    return sorted(names & REMEMBERING) + sorted(_kept_by_hand())


def _often() -> list[str]:
    """Return the public names that more than five functions have, methods included."""
    named = Counter(node.name for _, node in nodes(ast.FunctionDef))
    return [name for name, count in named.items() if count > 5 and not name.startswith("_")]


def test_the_house_stays_within_its_budgets() -> None:
    found = {
        "lines of src": _lines(),
        "files of src": len(trees()),
        "mechanisms that remember": len(_remembering()),
        "classes that change": len(set(_changing())),
        "public names of more than five functions": len(_often()),
    }
    assert {name: count for name, count in found.items() if count > SIZES[name].most} == {}


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a campaign, its record, and the same once a reading has been asked for."""
    folder = tmp_path_factory.mktemp("walked")
    shutil.copy(CAMPAIGN, folder)
    _walked(folder, "start campaign.toml m.axiscal")
    shutil.copy(folder / "m.axiscal", folder / "asked.axiscal")
    _walked(folder, "next asked.axiscal")
    return folder


def _walked(folder: Path, command: str) -> dict[str, int]:
    program = [sys.executable, "-m", "tests.docs.walked", str(folder), *command.split()]
    root = Path(__file__).parents[2]
    said = subprocess.run(program, check=True, capture_output=True, text=True, cwd=root).stdout
    counts: dict[str, int] = json.loads(said)
    return counts


@pytest.mark.long
@pytest.mark.parametrize("command", WALKS)
def test_a_command_walks_no_farther_than_it_did(begun: Path, tmp_path: Path, command: str) -> None:
    folder = shutil.copytree(begun, tmp_path / "campaign")
    found, budgets = _walked(folder, command), WALKS[command]
    assert {name: count for name, count in found.items() if name in budgets and count > budgets[name].most} == {}


@pytest.mark.parametrize("budgets", [SIZES, *WALKS.values()])
def test_what_is_to_be_reached_is_less_than_what_is_there(budgets: dict[str, Budget]) -> None:
    assert [name for name, budget in budgets.items() if budget.to_reach > budget.today] == []
