"""The attack table: what is put in shows in the truth, figures are those of the estimate, and it goes on later."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest

from benchmarks.trust import attack_table
from benchmarks.trust.attack_table import attacked
from benchmarks.trust.attacks import ATTACKS, Outcome, outcome
from benchmarks.trust.benches import PLACES

BY_WORDS = {attack.words: attack for attack in ATTACKS}


def test_there_are_at_least_sixteen_ways_of_being_wrong() -> None:
    assert len(ATTACKS) - 1 >= 16
    assert len(BY_WORDS) == len(ATTACKS)


def test_what_is_in_another_unit_is_refused_and_a_turned_sign_is_not_seen() -> None:
    assert outcome(BY_WORDS["values in mm, read as µm"], "even", "estimate", 1).withheld
    turned = outcome(BY_WORDS["sign turned"], "even", "estimate", 1)
    assert turned.ratio > 5
    assert turned.inside < 0.5


def test_what_no_reading_shows_counts_where_lengths_are_attacked() -> None:
    """A strain that the instrument makes is an error of the estimate, and U is the larger for what it may be."""
    plain, counted, longer = (BY_WORDS[words] for words in ("nothing", "lengths: nothing", "lengths: 20 µm/m"))
    bare, known, off = (outcome(each, "even", "estimate", 3) for each in (plain, counted, longer))
    assert known.ratio < bare.ratio
    assert off.ratio > known.ratio


def test_a_table_goes_on_where_it_was_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(attack_table, "ATTACKS", ATTACKS[18:19])
    known = partial(attacked, which=(0,))
    monkeypatch.setattr(attack_table, "KEPT", tmp_path / "kept")
    tried = []

    def counted(attack: object, places: str, scales: str, seed: int) -> Outcome:
        tried.append((places, scales, seed))
        if len(tried) == 2:
            raise KeyboardInterrupt
        return Outcome(np.nan if places == "random" else 1.0, 0.95, withheld=places == "random")

    monkeypatch.setattr(attack_table, "outcome", counted)
    with pytest.raises(KeyboardInterrupt):
        known(2, 1, np.inf)
    outcomes, machines = known(2, 1, np.inf)
    assert machines == 2
    assert {trial.places for trial, each in outcomes.items() if each.withheld} == {"random"}
    assert {trial.places for trial, each in outcomes.items() if np.isnan(each.ratio)} == {"random"}
    assert known(3, 1, np.inf)[1] == 3
    assert known(2, 1, np.inf)[1] == 2
    assert len(tried) == 3 * len(PLACES) + 1
    monkeypatch.setattr(attack_table, "KEPT", tmp_path / "other")
    assert known(2, 1, 0.0) == ({}, 0)
