"""The line about the progress: of how many readings, and whether that is all that ends the campaign."""

from __future__ import annotations

import pytest

from axiscal.campaign.milestones import Milestone
from axiscal.cli.progress import progress_line
from axiscal.description.target import Target
from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.measurement.reading import Reading

KNOWN = Accuracy(2e-6, 4e-6, 2e-6, 4e-6)


def target(readings: int | None = None, rms: float | None = None, budget: float | None = None) -> Target:
    """Return a target without volume."""
    return Target(rms, None, readings, budget, (), "volume")


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (target(120), "reading 3 of 120: RMS 2 um"),
        (target(120, 1e-6), "reading 3 of at most 120: RMS 2 um (target 1 um)"),
        (target(120, budget=600.0), "reading 3 of at most 120: RMS 2 um"),
        (target(rms=1e-6), "reading 3: RMS 2 um (target 1 um)"),
    ],
)
def test_of_how_many(asked: Target, said: str) -> None:
    reading = Reading("laser", (0.0,), (0,), 0.0, number=3)
    assert progress_line(Milestone(3, reading, KNOWN, 60.0), asked).startswith(said)


def test_how_many_were_taken_is_no_number_of_a_reading() -> None:
    reading = Reading("laser", (0.0,), (0,), 0.0, number=5)
    said = progress_line(Milestone(3, reading, KNOWN, 60.0), target(120))
    assert said.startswith("reading 5, 3 taken of 120: RMS 2 um")


def test_a_line_with_all_that_may_be_wanted_fits_a_terminal() -> None:
    reading = Reading("laser", (0.0,), (0,), 0.0, number=53)
    known = Accuracy(4.861e-6, 6.742e-6, 4.861e-6, 6.742e-6)
    assert len(progress_line(Milestone(53, reading, known, 1674.0), target(120, 5e-6))) < 80
