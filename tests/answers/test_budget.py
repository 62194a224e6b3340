"""The budget of the uncertainty: its squares add up, and each source is what it is without the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.answers.budget import budget
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading_rows import seen
from tests.generators.campaigns import drawn, mixed
from tests.generators.laser_axis import CAMPAIGN, MACHINE, read
from tests.generators.laser_axis import machine as laser_machine


def test_sizes_that_are_learnt_are_a_source_of_their_own() -> None:
    case = mixed()
    case = Case(replace(case.description, target=replace(case.description.target, aligned=False)))
    known = concluded(case, drawn(case, 40))
    shares = {source.kind: source.rms for source in budget(known)}
    assert shares["sizes"] > 0.03 * known.accuracy.rms
    total = np.sqrt(sum(source.rms**2 for source in budget(known)))
    assert total == pytest.approx(known.accuracy.rms, rel=1e-9)
    assert max(shares.values()) <= known.accuracy.rms


def test_noise_and_unknowns_are_those_of_josephs_form() -> None:
    """The same shares by the gain K of all readings at once: C = (I - KH) P (I - KH)ᵀ + K R Kᵀ."""
    text = CAMPAIGN.replace('drift = "0 um/h"', 'drift = "3 um/h"\ntemperature = "23 degC"\ntemperature_std = "1 K"\n'
                            'expansion = "11.7 um/m/K"')  # fmt: skip
    alone = f'usual = "off"\nsure = "exactly"\n{text}'
    case = Case(campaign_from_texts(alone, "c.toml", MACHINE, "m"))
    known = concluded(case, read(laser_machine(3), 30))
    observation = known.knowledge.observation
    numbers = seen(observation, known.readings)
    prior, noise = observation.prior_covariance(), np.diag(numbers.variances)
    gain = prior @ numbers.rows.T @ np.linalg.inv(numbers.rows @ prior @ numbers.rows.T + noise)
    kept = np.eye(len(prior)) - gain @ numbers.rows
    tool = np.zeros((len(case.yardstick.root.matrix), len(prior)))
    tool[:, : case.errors.size] = case.yardstick.root.matrix
    assert known.posterior is not None
    disagreeing = replace(known.posterior.agreement, count=30, c2=4.0)
    wide = replace(known, posterior=replace(known.posterior, agreement=disagreeing))
    assert wide.widening == 4.0
    found = {source.kind: source.rms / 2 for source in budget(wide)}
    assert found["instrument"] == pytest.approx(float(np.linalg.norm(tool @ gain @ np.sqrt(noise))), rel=1e-5)
    column = case.errors.size + [u.name for u in observation.unknowns].index("growth")
    grown = np.linalg.norm(tool @ kept[:, column]) * np.sqrt(prior[column, column])
    assert found["temperature"] == pytest.approx(float(grown), rel=1e-4)
    assert found["drift"] > 0
