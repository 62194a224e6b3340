"""Each animal of the zoo is answered rightly, or by the name of its cause; all of them in `make trust PART=zoo`."""

from __future__ import annotations

import pytest

from tests.zoo.animals import Animal
from tests.zoo.curves import NOTHING_WRONG
from tests.zoo.every import EVERY
from tests.zoo.running import judged


@pytest.mark.parametrize("animal", [pytest.param(each, id=each.name) for each in EVERY if each.quick])
def test_answers_an_animal_rightly_or_names_its_cause(animal: Animal) -> None:
    found = judged(animal)
    assert found.holds, found


def test_names_no_cause_where_nothing_is_wrong() -> None:
    found = judged(NOTHING_WRONG)
    assert [animal.name for animal in EVERY if animal.named_in(found.said)] == []


def test_every_animal_has_a_name_of_its_own() -> None:
    names = [animal.name for animal in EVERY]
    assert len(set(names)) == len(names)
