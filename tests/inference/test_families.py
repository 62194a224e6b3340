"""Curves of three kinds of smoothness are averaged over by their evidence, and the band counts all of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from axiscal.inference.evidence import Evidence
from axiscal.inference.fit import FAMILIES, fit
from axiscal.inference.scales import SPREADS, wanted
from axiscal.inference.widening import posterior
from scipy.stats import multivariate_normal

from axiscal.description.campaign import campaign_from_texts
from axiscal.error_model.model import ErrorModel
from axiscal.error_model.prior import distances, matern, matern_by_length
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.exceptions import DescriptionError
from axiscal.machine import machine_from_text
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.report.findings import findings

MACHINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "10 um", length = "200 mm", smoothness = "estimate" }
"""
CAMPAIGN = """
machine = "m"
[target]
readings = 30
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.3 um"
drift = "0"
unknowns = {}
"""
COUNT = 30


def _case(machine: str = MACHINE) -> Case:
    return Case(campaign_from_texts(CAMPAIGN, "campaign.toml", machine, "m"))


def _read(smoothness: float, seed: int) -> list[Reading]:
    """Readings of a machine whose curve is of this smoothness, at evenly spread places."""
    rng, at = np.random.default_rng(seed), np.linspace(0.01, 0.99, COUNT)
    far = np.abs(at[:, None] - at) / 0.2
    true = 10e-6 * np.linalg.cholesky(matern(far, smoothness) + 1e-9 * np.eye(COUNT)) @ rng.standard_normal(COUNT)
    values = true + rng.normal(0, 0.3e-6, COUNT)
    return [Reading("laser", (x,), (1,), float(v)) for x, v in zip(at, values, strict=True)]


@pytest.mark.long
@pytest.mark.parametrize(("smoothness", "seed"), [(2.5, 1), (0.5, 2)])
def test_shares_are_those_of_an_integral_over_a_fine_grid(smoothness: float, seed: int) -> None:
    case, readings = _case(), _read(smoothness, seed)
    observation, scales = case.observation, wanted(case.description.machine)
    assert [(scale.kind, scale.owner) for scale in scales] == [("std", "EXX"), ("length", "EXX")]
    found = fit(observation, readings, scales).families
    spline, axis = observation.errors.functions[0].basis, np.linspace(-3.2, 3.2, 29)
    rows = spline.rows(np.array([reading.pose[0] for reading in readings]))
    y = np.array([reading.value for reading in readings])
    spreads = [float(np.hypot(*SPREADS[kind])) for kind in ("std", "length")]

    def whole(family: float) -> float:
        logs = []
        for size in axis:
            for length in axis:
                prior = (10e-6 * np.exp(size)) ** 2 * matern(distances(spline) / (0.2 * np.exp(length)), family)
                covariance = rows @ prior @ rows.T + 0.3e-6**2 * np.eye(COUNT)
                likely = multivariate_normal(np.zeros(COUNT), covariance, allow_singular=True).logpdf(y)
                logs.append(likely - 0.5 * (size / spreads[0]) ** 2 - 0.5 * (length / spreads[1]) ** 2)
        return float(np.logaddexp.reduce(logs))

    twin = np.array([whole(family) for family in FAMILIES])
    shares = np.exp(twin - np.logaddexp.reduce(twin))
    assert [found[family] for family in FAMILIES] == pytest.approx(shares.tolist(), abs=0.06)


def test_the_band_is_that_of_all_kinds_about_the_likeliest() -> None:
    case, readings = _case(), _read(1.5, 5)
    scales = wanted(case.description.machine)
    found = fit(case.observation, readings, scales)
    assert sum(found.families.values()) == pytest.approx(1.0)
    assert min(found.families.values()) < 0.5 < 1 - 1e-3, "several kinds count"
    evidence = Evidence(case.observation, readings, scales).with_smoothness(found.scales.smoothness)
    own = posterior(evidence, found.possible.logs[0])
    added = found.widening.factor @ found.widening.factor.T
    alone = np.zeros_like(own.covariance)
    for logs, weight in found.possible.parts():
        each = posterior(evidence, logs)
        moved = each.mean - own.mean
        alone += weight * (each.covariance + np.outer(moved, moved))
    share = found.families[found.scales.smoothness or 0.0]
    least = share * np.diag(alone) - np.diag(own.covariance)
    assert np.all(np.diag(added) >= least - 1e-18), "the other kinds only add"


def test_what_is_learnt_is_the_prior_that_the_estimate_goes_on_with() -> None:
    case = _case()
    estimation = concluded(case, _read(0.5, 2))
    assert estimation.fit is not None
    assert estimation.fit.scales.smoothness == 0.5
    learnt = estimation.case.errors
    entry = learnt.machine.errors[0]
    expected = entry.std**2 * matern(distances(learnt.functions[0].basis) / (entry.length or 0.0), 0.5)
    np.testing.assert_allclose(learnt.functions[0].covariance, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("families", "times"), [({0.5: 0.98, 2.5: 0.02}, 1), ({0.5: 0.9, 2.5: 0.1}, 0), ({2.5: 1.0}, 0)]
)
def test_kinks_are_said_above_twenty_to_one(families: dict[float, float], times: int) -> None:
    estimation = concluded(_case(), _read(2.5, 1))
    assert estimation.fit is not None
    other = replace(estimation, fit=replace(estimation.fit, families=families))
    said = [finding.text for finding in findings(other) if "kinks" in finding.text]
    assert len(said) == times
    assert all("The curve EXX has kinks: a smoothness of 0.5 is 49 to 1" in text for text in said)


def test_the_slope_of_the_third_kind_is_that_of_differences() -> None:
    far: Array = np.linspace(0, 3, 30)
    slope = (matern(far / np.exp(1e-6), 0.5) - matern(far / np.exp(-1e-6), 0.5)) / 2e-6
    np.testing.assert_allclose(matern_by_length(far, 0.5), slope, atol=1e-9)


def test_a_stated_smoothness_is_not_averaged_over() -> None:
    case = _case(MACHINE.replace('"estimate"', "1.5"))
    assert case.variable == ()
    assert ErrorModel(case.description.machine).functions[0].basis.size == 21


def test_a_plane_has_one_smoothness() -> None:
    text = MACHINE.replace("[errors]", '[axes.Y]\ntravel = ["0 mm", "400 mm"]\n[errors]').replace(
        "w-b-X-t", "w-b-X-Y-t"
    )
    with pytest.raises(DescriptionError, match="smoothness"):
        machine_from_text(f'{text}EZXY = {{ std = "5 um", length = "150 mm", smoothness = "estimate" }}\n')
