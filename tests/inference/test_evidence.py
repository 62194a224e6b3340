"""The marginal likelihood of readings against a naive twin, its gradient, and the scales it finds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from axiscal.inference.contradiction import common_factors
from axiscal.inference.evidence import Evidence
from axiscal.inference.fit import fit
from axiscal.inference.scales import Scales, all_scales, wanted
from scipy.stats import multivariate_normal

from axiscal.error_model.model import ErrorModel
from axiscal.machine import Machine, machine_from_text
from axiscal.machine.entry import ROUGH
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import visited_by
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array

MILL = """
chain = "w-X'-b-Z-t"
[tool]
length = "100 mm"
[axes.X]
travel = ["0 mm", "400 mm"]
[axes.Z]
travel = ["-300 mm", "0 mm"]
[errors]
EXX = { std = "10 um", knots = 9, length = "120 mm", rest = "1 um" }
EZX = { std = "8 um", knots = 7 }
EBX = { std = "20 urad", knots = 5, length = "200 mm" }
EXZ = { std = "6 um", knots = 6, length = "100 mm", rest = "estimate" }
B0Z = { std = "30 urad" }
EXX_reversal = { std = "3 um" }
"""


def _setups() -> tuple[Setup, ...]:
    def setup(name: str, direction: tuple[float, float, float]) -> Setup:
        unknowns = (Unknown("zero", 1e-3),)
        return Setup(name, "indicator", direction, (0, 1), (0.2, -0.1), 1e-6, unknowns, 60, 1, 1, (0, 0), "both")

    return setup("x", (1.0, 0.0, 0.0)), setup("z", (0.0, 0.0, 1.0))


def _observation(machine: Machine) -> Observation:
    return Observation(ErrorModel(machine), _setups())


def _places(count: int, rng: np.random.Generator) -> list[Reading]:
    def place(i: int) -> Reading:
        pose = (float(rng.uniform(0, 0.4)), float(rng.uniform(-0.3, 0)))
        approach = (int(rng.choice([-1, 1])), int(rng.choice([-1, 1])))
        return Reading("xz"[i % 2], pose, approach, float(rng.normal(0, 1e-5)), 2e-6 if i % 5 == 0 else None)

    places = [place(i) for i in range(count)]
    return places + places[:3]


def _covered(observation: Observation, readings: list[Reading]) -> Array:
    """The covariance of the readings by the road the belief takes: columns for visited cells, rows times prior."""
    observation = visited_by(observation, readings)
    rows, variances = [], []
    for r in readings:
        seen = observation.rows("xz".index(r.setup), np.array([r.pose]), np.array([r.approach], dtype=float))
        rows.append(seen.rows[0])
        variances.append(seen.variances[0] if r.std is None else r.std**2)
    table = np.array(rows)
    covariance: Array = table @ observation.prior_covariance() @ table.T + np.diag(variances)
    return covariance


def test_the_likelihood_is_that_of_the_rescaled_model() -> None:
    machine, rng = machine_from_text(MILL), np.random.default_rng(3)
    observation, readings = _observation(machine), _places(14, rng)
    scales = all_scales(machine, observation.setups)
    logs = rng.normal(0, 0.4, len(scales))
    found = Scales(scales, tuple(np.exp(logs)))
    twin = Observation(ErrorModel(found.machine(machine)), found.setups(observation.setups))
    values = [reading.value for reading in readings]
    expected = multivariate_normal.logpdf(values, np.zeros(len(values)), _covered(twin, readings))
    assert Evidence(observation, readings, scales).log_density(logs)[0] == pytest.approx(expected, rel=1e-7)


def test_at_common_factors_readings_vary_as_those_of_the_rescaled_model() -> None:
    """Whatever was asked before: what is kept of the lengths belongs to these, and to one smoothness."""
    machine, rng = machine_from_text(MILL), np.random.default_rng(6)
    observation, readings = _observation(machine), _places(14, rng)
    scales = all_scales(machine, observation.setups)
    evidence = Evidence(observation, readings, scales)
    factors = common_factors(evidence)
    for logs in [*factors[::4], *factors[::-5]]:
        found = Scales(scales, tuple(np.exp(logs)))
        twin = Observation(ErrorModel(found.machine(machine)), found.setups(observation.setups))
        wanted = _covered(twin, readings)
        assert evidence.covariance(logs) == pytest.approx(wanted, rel=1e-9, abs=1e-9 * float(np.abs(wanted).max()))
    averaged = tuple(replace(entry, smoothness_averaged=True) for entry in machine.errors)
    several = Evidence(_observation(replace(machine, errors=averaged)), readings, scales)
    several.covariance(factors[0])
    rough = several.with_smoothness(ROUGH).covariance(factors[0])
    assert np.abs(rough / several.covariance(factors[0]) - 1).max() > 1e-3


def test_priors_that_are_kept_are_those_found_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """At scales that come back, in any order, with room for all of them and with none."""
    machine, rng = machine_from_text(MILL), np.random.default_rng(8)
    observation, readings = _observation(machine), _places(14, rng)
    scales = all_scales(machine, observation.setups)
    draws = rng.normal(0, 0.3, (4, len(scales)))
    kept = Evidence(observation, readings, scales)
    found = [kept.log_density(draws[index])[1] for index in (0, 1, 0, 2, 3, 1)]
    priors = [kept.prior(draws[index]) for index in (0, 1, 0, 2, 3, 1)]
    monkeypatch.setattr("axiscal.inference.evidence._REMEMBERED", 0)
    for index, slope, prior in zip((0, 1, 0, 2, 3, 1), found, priors, strict=True):
        anew = Evidence(observation, readings, scales)
        np.testing.assert_array_equal(anew.log_density(draws[index])[1], slope)
        np.testing.assert_array_equal(anew.prior(draws[index]), prior)


def test_the_gradient_is_that_of_the_likelihood() -> None:
    machine, rng = machine_from_text(MILL), np.random.default_rng(4)
    observation, readings = _observation(machine), _places(12, rng)
    scales = all_scales(machine, observation.setups)
    evidence, logs = Evidence(observation, readings, scales), rng.normal(0, 0.3, len(scales))
    steps = 1e-4 * np.eye(len(scales))
    numeric = [(evidence.log_density(logs + s)[0] - evidence.log_density(logs - s)[0]) / 2e-4 for s in steps]
    assert evidence.log_density(logs)[1] == pytest.approx(np.array(numeric), rel=1e-4, abs=1e-3)


@pytest.mark.parametrize("wrong", [1 / 3, 3.0])
def test_a_size_that_is_stated_wrong_by_three_everywhere_is_found(wrong: float) -> None:
    machine, rng = machine_from_text(MILL), np.random.default_rng(5)
    observation, readings = _observation(machine), _places(60, rng)
    true = _covered(observation, readings)
    values = wrong * np.linalg.cholesky(true) @ rng.standard_normal(len(true))
    drawn = [Reading(r.setup, r.pose, r.approach, float(v), None) for r, v in zip(readings, values, strict=True)]
    scales = tuple(s for s in all_scales(machine, observation.setups) if s.kind == "std")
    found = fit(observation, drawn, scales)
    assert found.scales.value("std", "EXX") == pytest.approx(wrong * 10e-6, rel=0.6)
    assert found.gain > 0


def test_only_the_rests_that_ask_for_it_are_learnt() -> None:
    (only,) = wanted(machine_from_text(MILL))
    assert only.owner == "EXZ"
    assert only.stated == pytest.approx(0.3e-6)


@pytest.mark.parametrize("inherited", [False, True])
def test_the_second_derivative_is_that_of_the_slope(inherited: bool) -> None:
    """Against differences of the slope, of higher order; sizes, lengths, rests and noises."""
    machine, rng = machine_from_text(MILL), np.random.default_rng(5)
    observation = _observation(machine)
    scales, prior = all_scales(machine, observation.setups), None
    if inherited:
        scales = tuple(scale for scale in scales if scale.kind in ("rest", "noise"))
        prior = np.zeros(observation.errors.size), observation.errors.prior_covariance()
    evidence = Evidence(observation, _places(40, rng), scales, prior)
    at = rng.normal(0, 0.3, len(scales))

    def slope(step: float, of: Array) -> Array:
        ends = [evidence.log_density(at + side * step * of)[1] for side in (1, -1)]
        return (ends[0] - ends[1]) / (2 * step)

    naive = -np.array([(4 * slope(5e-3, unit) - slope(1e-2, unit)) / 3 for unit in np.eye(len(at))])
    found = evidence.curvature(at)
    assert found == pytest.approx(naive, abs=3e-6 * np.abs(naive).max())
    assert found == pytest.approx(found.T)


def test_readings_that_see_no_error_leave_sizes_as_stated() -> None:
    """Nothing of this mill moves along y, where a slip of a finger may put an indicator."""
    machine, rng = machine_from_text(MILL), np.random.default_rng(6)
    blind = replace(_setups()[0], name="y", direction=(0.0, 1.0, 0.0))
    observation = Observation(ErrorModel(machine), (blind,))
    readings = [Reading("y", (x, -0.1), (1, 1), 1e-6 * rng.standard_normal()) for x in (0.1, 0.2, 0.3)]
    scales = all_scales(machine, observation.setups)
    evidence, still = Evidence(observation, readings, scales), np.array([scale.kind != "noise" for scale in scales])
    at = np.zeros(len(scales))
    assert np.all(evidence.log_density(at)[1][still] == 0)
    assert np.all(evidence.curvature(at)[still] == 0)
    found = fit(observation, readings, scales)
    assert np.array(found.scales.factors)[still] == pytest.approx(1.0)
