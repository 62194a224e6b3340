"""Each animal of the zoo is answered rightly, or by the name of its cause; all of them in `make trust PART=zoo`."""

from __future__ import annotations

import pytest

from tests.zoo.animals import Animal
from tests.zoo.curves import NOTHING_WRONG
from tests.zoo.every import EVERY
from tests.zoo.running import judged

FAILS_TODAY = {"backlash with a way of 300 mm: even"}
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


def test_names_no_cause_where_nothing_is_wrong() -> None:
    found = judged(NOTHING_WRONG)
    assert [animal.name for animal in EVERY if animal.named_in(found.said)] == []


def test_every_animal_has_a_name_of_its_own() -> None:
    names = [animal.name for animal in EVERY]
    assert len(set(names)) == len(names)
    assert {animal.name for animal in EVERY if animal.quick} >= FAILS_TODAY
