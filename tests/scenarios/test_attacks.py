"""The attack table: what is put in shows in the truth, figures are those of the estimate, and it goes on later."""

from __future__ import annotations

from benchmarks.trust.attacks import ATTACKS, outcome

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
