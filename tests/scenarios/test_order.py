"""Each run draws the order of its tests; a seed repeats it in any selection of them."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests import order

ROOT = Path("checkout")
CONFIG = SimpleNamespace(rootpath=ROOT)
ALL: list[Any] = [
    SimpleNamespace(path=ROOT / f"test_{file}.py", name=f"test_{name}", config=CONFIG)
    for file in range(20)
    for name in range(20)
]


def _ordered(monkeypatch: pytest.MonkeyPatch, seed: str, items: list[Any]) -> list[tuple[str, str]]:
    monkeypatch.setenv(order.VARIABLE, seed)
    order.pytest_collection_modifyitems(shuffled := list(items))
    return [(item.path.name, item.name) for item in shuffled]


def test_a_seed_repeats_its_order_in_any_selection(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = _ordered(monkeypatch, "11", ALL)
    some = _ordered(monkeypatch, "11", ALL[::7])
    assert some == [each for each in whole if each in some]
    assert whole != _ordered(monkeypatch, "12", ALL)


def test_a_file_stays_together_for_the_sake_of_its_fixtures(monkeypatch: pytest.MonkeyPatch) -> None:
    files = [file for file, _ in _ordered(monkeypatch, "11", ALL)]
    assert sum(one != another for one, another in pairwise(files)) == 19


def test_off_keeps_the_order_of_the_files(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _ordered(monkeypatch, "off", ALL) == [(item.path.name, item.name) for item in ALL]
