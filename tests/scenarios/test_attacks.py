"""The attack table: what is put in shows in the truth, figures are those of the estimate, and it goes on later."""

from __future__ import annotations

from datetime import date
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from benchmarks.trust import attack_table
from benchmarks.trust.__main__ import renewed, stamp
from benchmarks.trust.attack_table import CELLS, FIRST, Outcomes, Trial, attack_rows, attacked, goal_lines, limits
from benchmarks.trust.attacks import ATTACKS, Outcome, outcome
from benchmarks.trust.sources import ROOT, version

BY_WORDS = {attack.words: attack for attack in ATTACKS}


def filled(machines: int, word: str = "holds", ratio: float = 1.0, rare: float = 1.0) -> Outcomes:
    """Return outcomes of so many machines in every cell."""
    return {
        Trial(number, *cell, FIRST + index): Outcome(ratio, 0.95, word, rare)
        for index in range(machines)
        for number in range(len(ATTACKS))
        for cell in CELLS
    }


def test_there_are_at_least_sixteen_ways_of_being_wrong() -> None:
    assert len(ATTACKS) - 1 >= 16
    assert len(BY_WORDS) == len(ATTACKS)


@pytest.mark.long
@pytest.mark.parametrize("scales", ["stated", "estimate"])
def test_a_drift_is_no_silent_failure(scales: str) -> None:
    found = [outcome(BY_WORDS["drift, 10 µm"], "even", scales, seed) for seed in range(3)]
    assert not any(each.silent for each in found)


@pytest.mark.long
@pytest.mark.parametrize("scales", ["stated", "estimate"])
def test_what_two_axes_do_together_is_no_silent_failure(scales: str) -> None:
    found = [outcome(BY_WORDS["two axes: twist, 20 µm"], "random", scales, seed) for seed in range(3)]
    assert not any(each.word == "holds" for each in found)
    assert np.exp(np.mean(np.log([each.ratio for each in found]))) < 1.5


@pytest.mark.long
def test_scales_that_were_learnt_hide_no_departure_that_the_stated_ones_show() -> None:
    """Rests of three times as stated explain a reversal that varies: then what is promised has grown with them."""
    varies = BY_WORDS["reversal that varies, 8 µm"]
    for seed in (20_269_001, 20_269_022, 20_269_030):
        assert outcome(varies, "planned", "stated", seed).word == "widened"
        assert outcome(varies, "planned", "estimate", seed).ratio < 1
    right = outcome(BY_WORDS["nothing"], "planned", "estimate", 20_269_001)
    assert right.word in ("holds", "unchecked")


def test_what_is_in_another_unit_is_refused_and_a_turned_sign_is_not_seen() -> None:
    assert outcome(BY_WORDS["values in mm, read as µm"], "even", "stated", 1).word == "refused"
    turned = outcome(BY_WORDS["sign turned"], "even", "stated", 1)
    assert turned.ratio > 5
    assert turned.inside < 0.5


@pytest.mark.long
def test_another_tool_is_no_error_of_five_axes_and_another_pivot_is() -> None:
    none, tool, pivot = (BY_WORDS[f"five axes: {words}"] for words in ("nothing", "tool 50 µm too long", PIVOT))
    right, longer, aside = (outcome(each, "even", "stated", 3) for each in (none, tool, pivot))
    assert right.ratio < 1.5
    assert longer.ratio < 1.5  # nobody measured it, and it is within what is promised
    assert aside.ratio < 1.5  # what the prior of the axis line holds, the estimate finds


PIVOT = "pivot of B 50 µm aside"


def test_a_failure_is_silent_where_the_verdict_holds_and_the_truth_is_far_worse() -> None:
    assert Outcome(1.6, 0.5, "holds", 1.2).silent
    assert not Outcome(1.6, 0.5, "unchecked", 1.2).silent
    assert not Outcome(1.4, 0.9, "holds", 1.2).silent


def test_it_is_beyond_the_promise_where_that_leaves_less_to_one_machine_in_fifty() -> None:
    assert Outcome(1.6, 0.5, "holds", 1.2).broken
    assert not Outcome(1.6, 0.5, "holds", 2.3).broken
    assert "**100%** (16%–100%), 0% beyond |" in next(attack_rows(filled(2, ratio=1.6, rare=2.3), 2))
    assert "beyond" not in next(attack_rows(filled(2, ratio=1.6), 2))


@pytest.mark.long
def test_few_unknowns_leave_more_to_one_machine_in_fifty_than_many() -> None:
    one, many = (outcome(BY_WORDS[name], "planned", "stated", 1).rare for name in ("five axes: nothing", "nothing"))
    assert 1.0 < many < one < np.sqrt(stats.chi2.isf(0.02, 1))


@pytest.mark.long
@pytest.mark.parametrize("seed", [5004, 5021, 5077, 5094])
def test_a_step_in_a_gap_of_random_places_is_not_silent(seed: int) -> None:
    """Twice as far off as promised, all four: the readings leave a tenth of a metre and more between them."""
    found = outcome(BY_WORDS["step, 15 µm"], "random", "estimate", seed)
    assert found.ratio > 1.5
    assert found.word == "unchecked"


def test_a_row_has_a_cell_for_each_of_places_and_priors() -> None:
    rows = list(attack_rows(filled(2), 2))
    assert len(rows) == len(ATTACKS)
    assert all(row.count("|") == 8 for row in rows)
    assert "1.0, 95%, 100%, **0%** (0%–84%)" in rows[0]  # (1 - 0.025^(1/2)), of none in two


def test_the_limits_of_a_share_are_those_of_clopper_and_pearson() -> None:
    low, high = limits(3, 40)
    assert low == pytest.approx(stats.beta.ppf(0.025, 3, 38))
    assert high == pytest.approx(stats.beta.ppf(0.975, 4, 37))


def test_cells_beyond_the_goal_are_named() -> None:
    few, many = (" ".join(goal_lines(filled(3, ratio=ratio), 3)) for ratio in (1.0, 2.0))
    assert "More than that" not in few
    assert "nothing (planned, stated) 100%" in many


def test_a_table_goes_on_where_it_was_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(attack_table, "ATTACKS", ATTACKS[18:19])
    known = partial(attacked, which=(0,))
    monkeypatch.setattr(attack_table, "KEPT", tmp_path / "kept")
    tried = []

    def counted(attack: object, places: str, scales: str, seed: int) -> Outcome:
        tried.append((places, scales, seed))
        if len(tried) == 4:
            raise KeyboardInterrupt
        return Outcome(np.nan if places == "random" else 1.0, 0.95, "holds", 1.2)

    monkeypatch.setattr(attack_table, "outcome", counted)
    with pytest.raises(KeyboardInterrupt):
        known(2, 1, np.inf)
    outcomes, machines = known(2, 1, np.inf)
    assert machines == 2
    assert {each.word for each in outcomes.values()} == {"holds"}
    assert {trial.places for trial, each in outcomes.items() if np.isnan(each.ratio)} == {"random"}
    assert known(3, 1, np.inf)[1] == 3
    assert known(2, 1, np.inf)[1] == 2
    assert len(tried) == 3 * len(CELLS) + 1
    monkeypatch.setattr(attack_table, "KEPT", tmp_path / "other")
    assert known(2, 1, 0.0) == ({}, 0)


def test_a_section_says_which_sources_it_was_measured_with() -> None:
    page = "# Page\n\n## One\nold\n\n## Two\nkept\n"
    new = renewed(page, "## One\nnew\n" + stamp(version(), date(2026, 11, 20)))
    assert new == f"# Page\n\n## One\nnew\n\nMeasured on 2026-11-20 with the sources `{version()}`.\n\n## Two\nkept\n"
    beside = ROOT / "benchmarks" / "trust" / "attacks.py"
    assert len({version(), version([beside]), version([beside, beside])}) == 3
