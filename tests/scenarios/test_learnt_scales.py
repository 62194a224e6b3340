"""A sample of `make trust`: with priors that are wrong by three, learnt sizes make bands that hold."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.trust.kept import Keeping, Trial, one_by_one
from benchmarks.trust.virtual import covered, gross, held


@pytest.mark.long
@pytest.mark.parametrize(("wrong", "curves"), [(1 / 3, 0.8), (3.0, 0.95)])
def test_bands_hold_when_the_prior_is_wrong_by_three(wrong: float, curves: float) -> None:
    """The tool point's hold; one constant, of which fifteen readings tell little, is half of the curves."""
    found = covered("one-axis", wrong, "estimate", 25)
    assert found.tcp > 0.9
    assert found.curves > curves


@pytest.mark.long
def test_the_report_says_so_where_the_prior_is_three_times_too_small() -> None:
    assert covered("one-axis", 1 / 3, "estimate", 25).misfit > 0.7


@pytest.mark.long
def test_one_gross_error_among_thirty_readings_is_found() -> None:
    moved = gross(50e-6, 8)
    assert moved.rejected == 1.0
    assert moved.typical < 0.25
    assert moved.worst < 0.5
    assert moved.naive > 1.0  # believed, it would make bands so much wider, and still move curves out of them


@pytest.mark.long
def test_machines_that_were_tried_are_not_tried_again_and_give_the_same(tmp_path: Path) -> None:
    tried: list[Trial] = []

    def counted(trial: Trial) -> dict[str, float | None]:
        tried.append(trial)
        return held(trial)

    keeping = Keeping("virtual", (), folder=tmp_path)
    trials = [("one-axis", 1.0, "stated", seed) for seed in (2, 0, 1)]
    few = Keeping("virtual", (), seconds=0.0, folder=tmp_path).found(counted, trials)
    first, again = keeping(counted, trials[:2]), keeping(counted, trials)
    assert few == {}
    assert tried == trials
    assert again[:2] == first
    assert [each["tcp"] for each in again] == pytest.approx([held(trial)["tcp"] for trial in trials], abs=1e-6)
    found = (covered("one-axis", 1.0, "stated", 3, each) for each in (keeping, one_by_one))
    assert next(found).curves == pytest.approx(next(found).curves, abs=1e-6)
    assert gross(5e-5, 2, keeping).typical == pytest.approx(gross(5e-5, 2).typical, rel=1e-5)
