"""A sample of `make certify PART=coverage`: the printed 95 % holds the truth of virtual machines 95 times in 100."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.machine import builtin_names
from tests.certify.coverage import CLAIMED, MACHINES, SLACK, Covered, Trial

SIGMAS = 4.5
"""False alarms: one in 10⁵ for a single band; the seeds are fixed, so none comes and goes."""
SAMPLES = {
    "one-axis": (15, 150),
    "paper-three-stacked": (15, 400),
    "printer-gantry": (12, 150),
    "three-axis-mill": (12, 150),
    "portal-mill": (12, 100),
    "router": (12, 100),
    "lathe": (12, 150),
    "dmu60": (10, 100),
}
"""Readings and virtual machines."""
MANY = sorted(set(SAMPLES) - {"one-axis"})
"""Those whose plans take seconds each."""


@pytest.fixture(scope="module", params=["one-axis", *(pytest.param(name, marks=pytest.mark.long) for name in MANY)])
def trial(request: pytest.FixtureRequest) -> tuple[Trial, list[Covered]]:
    """Return each built-in machine with its coverage."""
    readings, machines = SAMPLES[request.param]
    trial = Trial(request.param, readings)
    return trial, trial.judged(machines, first=10_000)


def beyond(covered: list[Covered]) -> list[str]:
    """Return the errors whose coverage is further from the claim than chance explains."""
    return [c.name for c in covered if abs(c.mean - CLAIMED) > SLACK + SIGMAS * c.std]


def test_every_band_holds_as_often_as_it_says(trial: tuple[Trial, list[Covered]]) -> None:
    assert beyond(trial[1]) == []


def test_all_bands_together_hold_as_often_as_they_say(trial: tuple[Trial, list[Covered]]) -> None:
    together = np.mean([covered.shares for covered in trial[1][:-1]], axis=0)
    assert abs(together.mean() - CLAIMED) < SLACK + SIGMAS * together.std(ddof=1) / np.sqrt(len(together))


@pytest.mark.long
def test_a_band_that_is_too_narrow_is_noticed() -> None:
    trial = Trial("one-axis")
    trial.stds = [(positions, 0.6 * std) for positions, std in trial.stds]
    assert "EXX" in beyond(trial.judged(400))


@pytest.mark.long
def test_the_gain_matrix_is_the_estimate_of_a_campaign() -> None:
    trial = Trial("three-axis-mill", readings=12)
    machine = trial.drawn(3)
    values = trial.values(machine, 3)
    readings = [replace(visit, value=float(value)) for visit, value in zip(trial.visits, values, strict=True)]
    estimation = estimated(Case(trial.description), readings)
    std = np.linalg.norm(estimation.knowledge.belief.factor, axis=1)
    assert np.abs((estimation.knowledge.belief.mean - trial.gain @ values) / std).max() < 1e-8


def test_every_built_in_machine_takes_part() -> None:
    assert set(MACHINES) == set(SAMPLES) == set(builtin_names())
