"""What a set of animals comes to: every rule is broken once."""

from __future__ import annotations

import pytest

from tests.zoo.animals import Animal, Interval, Judged, Slope
from tests.zoo.axes import LASER
from tests.zoo.curves import FOREIGN
from tests.zoo.verdict import faults


def found(
    kind: str = "a", inside: float | None = 0.95, kept: float | None = None, *, named: bool = False, asked: bool = False
) -> Judged:
    animal = Animal(f"{kind}: one", LASER.job, FOREIGN[0].animal("even").meet, asked=asked)
    interval = None if inside is None else Interval(1.0, 1.0, inside)
    return Judged(animal, 0, interval, None if kept is None else Slope(kept, 1.0, 0.0), named)


@pytest.mark.parametrize(
    ("animals", "says"),
    [
        ([found()], []),
        ([found(inside=0.84)], ["a: 84% inside U", "all kinds: 84% inside U in the mean"]),
        ([found(inside=0.90), found("b", 0.90)], ["all kinds: 90% inside U in the mean"]),
        ([found(kept=0.94)], ["a: one, machine 0: 94% of the slope kept"]),
        ([found(inside=None)], ["a: one, machine 0: no U, and the cause is not named"]),
        ([found(asked=True)], ["a: one, machine 0: no question names the cause"]),
        ([found(inside=0.1, kept=0.1, named=True, asked=True)], []),
    ],
)
def test_says_what_falls_short(animals: list[Judged], says: list[str]) -> None:
    assert faults(animals) == says
