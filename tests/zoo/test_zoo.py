"""Each animal of the zoo is answered rightly, or by the name of its cause."""

from __future__ import annotations

import pytest

from tests.zoo.animals import Animal
from tests.zoo.every import EVERY
from tests.zoo.running import judged

FAILS_TODAY = {
    "lead error: 5 um/m by laser",
    "lead error: 20 um/m by laser",
    "lead error: 100 um/m by laser",
    "lead error: 20 um/m by dial on a scale",
    "lead error: 20 um/m by tape",
}
"""Quick animals that the program answers wrongly: each has to leave this list when it is answered rightly."""


def _quick() -> list[object]:
    wrong = pytest.mark.xfail(strict=True, reason="answered wrongly so far")
    return [
        pytest.param(animal, id=animal.name, marks=[wrong] if animal.name in FAILS_TODAY else [])
        for animal in EVERY
        if animal.quick
    ]


@pytest.mark.parametrize("animal", _quick())
def test_answers_an_animal_rightly_or_names_its_cause(animal: Animal) -> None:
    found = judged(animal)
    assert found.holds, found
