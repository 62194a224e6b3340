"""The zoo sees a U that is too small, one of a tenth of the axis, and one without type B.

Each mutation is made where the program ends, so that it does not hang on how U is computed: U is printed smaller, only
a tenth of the axis is asked for, or the laser and the room are said to have no error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest

from tests.zoo.animals import Animal, Job
from tests.zoo.answers import Answer
from tests.zoo.axes import PERFECT
from tests.zoo.curves import WARM as EVERY_WARM
from tests.zoo.running import judged
from tests.zoo.verdict import faults

WARM = EVERY_WARM[1:2]
"""Two of three kinds of warmth would say the same."""
TENTH = ("[target]", '[target]\nvolume = { X = ["0 mm", "100 mm"] }')


def _of(job: Job) -> Sequence[Animal]:
    return [replace(animal, job=job) for animal in WARM]


def _found(animals: Sequence[Animal]) -> list[str]:
    return faults([judged(animal) for animal in animals])


@pytest.fixture(scope="module")
def as_it_is() -> list[str]:
    """What falls short before anything is changed."""
    return _found(WARM)


def _red(lines: Sequence[str]) -> bool:
    return any("inside U" in line for line in lines)


def test_a_smaller_u_is_red(as_it_is: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    printed = Answer.expanded_with_tables
    monkeypatch.setattr(Answer, "expanded_with_tables", lambda answer: 0.7 * printed(answer))
    assert as_it_is == []
    assert _red(_found(WARM))


@pytest.mark.long
def test_u_of_the_first_tenth_is_red(as_it_is: list[str]) -> None:
    job = WARM[0].job
    assert as_it_is == []
    assert _red(_found(_of(replace(job, stated=(*job.stated, TENTH)))))


@pytest.mark.long
def test_u_without_type_b_is_red(as_it_is: list[str]) -> None:
    assert as_it_is == []
    assert _red(_found(_of(PERFECT)))
