"""The attack table: what is put in shows in the truth, and its figures are those of the estimate."""

from __future__ import annotations

import pytest

from benchmarks.trust.attacks import ATTACKS, Outcome, attack_rows, outcome

BY_WORDS = {attack.words: attack for attack in ATTACKS}


def test_there_are_at_least_sixteen_ways_of_being_wrong() -> None:
    assert len(ATTACKS) - 1 >= 16
    assert len(BY_WORDS) == len(ATTACKS)


@pytest.mark.parametrize("scales", ["stated", "estimate"])
def test_a_drift_is_no_silent_failure(scales: str) -> None:
    found = [outcome(BY_WORDS["drift, 10 µm"], "even", scales, seed) for seed in range(3)]
    assert not any(each.silent for each in found)


def test_what_is_in_another_unit_is_refused_and_a_turned_sign_is_not_seen() -> None:
    assert outcome(BY_WORDS["values in mm, read as µm"], "even", "stated", 1).word == "refused"
    turned = outcome(BY_WORDS["sign turned"], "even", "stated", 1)
    assert turned.ratio > 5
    assert turned.inside < 0.5


def test_a_failure_is_silent_where_the_verdict_holds_and_the_truth_is_far_worse() -> None:
    assert Outcome(1.6, 0.5, "holds").silent
    assert not Outcome(1.6, 0.5, "unchecked").silent
    assert not Outcome(1.4, 0.9, "holds").silent


def test_a_row_has_a_cell_for_each_of_places_and_priors() -> None:
    row = next(row for row in attack_rows(1) if row.startswith("| nothing"))
    assert row.count("|") == 8
