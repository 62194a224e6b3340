"""The attacks: what is put in is there, another unit is refused, and what the model holds is no silent failure."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.trust.attacks import ATTACKS, outcome

BY_WORDS = {attack.words: attack for attack in ATTACKS}
PIVOT = "pivot of B 50 µm aside"


def test_there_are_at_least_sixteen_ways_of_being_wrong() -> None:
    assert len(ATTACKS) - 1 >= 16
    assert len(BY_WORDS) == len(ATTACKS)


@pytest.mark.long
@pytest.mark.parametrize(
    ("words", "places"),
    [
        ("drift, 10 µm", "even"),
        ("two axes: twist, 20 µm", "random"),
        ("reversal that varies, 8 µm", "planned"),
        ("one bad reading, 8 µm", "even"),
    ],
)
def test_what_usually_goes_wrong_is_no_silent_failure(words: str, places: str) -> None:
    found = [outcome(BY_WORDS[words], places, "stated", seed) for seed in range(3)]
    assert np.exp(np.mean(np.log([each.ratio for each in found]))) < 1.5
    assert np.mean([each.inside for each in found]) > 0.8


def test_what_is_in_another_unit_promises_nothing() -> None:
    assert outcome(BY_WORDS["values in mm, read as µm"], "even", "stated", 1).withheld


@pytest.mark.long
@pytest.mark.parametrize("words", ["nothing", "tool 50 µm too long", PIVOT])
def test_another_tool_is_no_error_of_five_axes_and_another_pivot_is_found(words: str) -> None:
    assert outcome(BY_WORDS[f"five axes: {words}"], "even", "stated", 3).ratio < 1.5
