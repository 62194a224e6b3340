"""After a real ISO 230-2 test a table leaves at the targets what their scatter is, however the priors were come by."""

from __future__ import annotations

import pytest

from benchmarks.trust.iso_tests import FILES, LEARNING, STATED_STD, Runs, estimated_from, left_at_targets


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("learning", LEARNING)
def test_a_table_leaves_less_than_two_standard_errors_at_every_target(name: str, learning: str) -> None:
    runs = Runs.of(name)
    assert left_at_targets(runs, estimated_from(runs, learning)) < runs.limit


@pytest.mark.parametrize(
    ("name", "headline"), [("ess_target_x", 6.0e-6), ("ess_muts_x", 10.4e-6), ("ess_muts_y", 3.4e-6)]
)
def test_learnt_bands_are_no_wider_than_what_was_stated(name: str, headline: float) -> None:
    """Once 38, 74 and 31 um; the figures are those that `make trust` prints."""
    known = estimated_from(Runs.of(name), "all scales")
    assert known.accuracy.rms == pytest.approx(headline, rel=0.1)
    assert known.accuracy.rms < 1.2 * STATED_STD
    assert known.posterior is not None
    assert known.posterior.effective > 10
