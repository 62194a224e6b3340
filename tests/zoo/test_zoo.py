"""Each animal of the zoo is answered rightly, or by the name of its cause; all of them in `make trust PART=zoo`."""

from functools import cache

import pytest

from benchmarks.zoo.animals import Animal, Judged
from benchmarks.zoo.curves import AGAIN, NOTHING_WRONG, ONCE
from benchmarks.zoo.every import EVERY
from benchmarks.zoo.mills import IN_STEP, LAGGING, ONE_WAY
from benchmarks.zoo.running import judged

NAMED = {animal.name: animal for animal in EVERY}
QUICK = (
    "lead error: 20 um/m by tape",
    "backlash with a way of 300 mm: even",
    "half-read axis: 0 to 500 mm",
    "mirror over the tool point: only EXX described",
    "few readings: backlash from 2 to 12 um, 5 planned",
    "few readings: wave of 40 mm, 8 planned",
    "sign of an angle: yaw",
    "slip: unit, mm for um",
    "dial on a square: squareness",
    "slip: sign of a leg of a square",
    "slip: sign of one run",
    "zero that comes back: out and back once",
    "zero that comes back: three places again",
    "servo that lags: circles both ways round",
    "servo that lags: circles one way round",
    NOTHING_WRONG.name,
)
"""Other tests hold the beds, and what is stuck, rounded or set anew."""


@cache
def found(animal: Animal) -> Judged:
    """Return what becomes of an animal."""
    return judged(animal)


@pytest.mark.parametrize("name", QUICK)
def test_answers_an_animal_rightly_or_names_its_cause(name: str) -> None:
    assert found(NAMED[name]).holds, found(NAMED[name])


def test_names_no_cause_where_nothing_is_wrong() -> None:
    assert [animal.name for animal in EVERY if animal.named_in(found(NOTHING_WRONG).said)] == []
    assert not any(each.named_in(found(IN_STEP).said) for each in (LAGGING, ONE_WAY))
    assert not ONCE.named_in(found(AGAIN).said)


def test_every_animal_has_a_name_of_its_own() -> None:
    assert len(NAMED) == len(EVERY)
