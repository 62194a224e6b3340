"""What a set of animals comes to: every rule is broken once."""

from __future__ import annotations

import numpy as np
import pytest

from tests.zoo.animals import Animal, Interval, Judged, Slope
from tests.zoo.axes import LASER, even
from tests.zoo.curves import FOREIGN
from tests.zoo.oracle import right
from tests.zoo.right import CONDITIONS, machine
from tests.zoo.verdict import faults


def found(
    kind: str = "a", inside: float | None = 0.95, kept: float | None = None, *, named: bool = False, asked: bool = False
) -> Judged:
    animal = Animal(f"{kind}: one", LASER.job, FOREIGN[0].animal("even").meet, asked=asked)
    interval = None if inside is None else Interval(1.0, 1.0, inside, 2.0)
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


def test_an_interval_is_scored_by_its_width_and_by_what_lies_outside() -> None:
    # Ten values, one of which lies 3 beyond ± 2: 2 · 2 + 2 / 0.05 · 3 / 10.
    how = Interval.about(np.array([-5.0] + 9 * [1.0]), 2.0)
    assert how.inside == 0.9
    assert how.score == pytest.approx(4 + 40 * 0.3)


@pytest.mark.parametrize("condition", CONDITIONS)
def test_the_oracles_u_holds_95_percent(condition: str) -> None:
    shares = [machine(condition, "random", seed).oracle().inside for seed in range(60)]
    assert np.mean(shares) == pytest.approx(0.95, abs=0.03)


def test_nobody_knows_a_machine_better_than_its_oracle_with_fewer_readings() -> None:
    few = right(0, lambda _: even(8, 1), 0.0).oracle()
    assert right(0, lambda _: even(16, 1), 0.0).oracle().half < few.half
