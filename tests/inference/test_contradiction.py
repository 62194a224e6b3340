"""What explains readings: against densities written out, false alarms, and departures that were put in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from axiscal.inference.contradiction import MODEL, PRIOR, SIZES, compared
from axiscal.inference.evidence import Evidence
from axiscal.measurement.departures import departures
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.simulation import Simulator
from tests.generators.one_axis import observed

MACHINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "10 um", length = "200 mm", rest = "0.3 um" }
EXX_reversal = { std = "3 um" }
"""
_SIZE_WEIGHTS = (0.26, 0.22, 0.18, 0.13, 0.10, 0.07, 0.04)


def _axis() -> Observation:
    return observed('approach = "both"\nnoise = "0.5 um"', MACHINE)


def _read(observation: Observation, seed: int, count: int, attack: str = "") -> list[Reading]:
    """Return readings out and back at random places, one a minute, with a departure of the machine or its readings."""
    rng = np.random.default_rng((seed, 4))
    machine = Simulator(observation.errors.machine, observation.setups).drawn(seed)
    out, back = np.sort(rng.uniform(0, 1, count // 2)), np.sort(rng.uniform(0, 1, count - count // 2))[::-1]
    readings = []
    for index, x in enumerate(np.concatenate([out, back])):
        side = 1 if index < count // 2 else -1
        added = {
            "drift": 10e-6 * index / count,
            "step": 15e-6 * (x > 0.37),
            "pitch": 5e-6 * np.sin(2 * np.pi * x / 0.05),
            "bad": 8e-6 * (index == 7),
        }.get(attack, 0.0)
        value = machine.read(observation.setups[0], (float(x),), (side,), rng) + added
        readings.append(Reading("it", (float(x),), (side,), float(value), time=60.0 * index))
    return readings


def test_the_evidence_is_the_average_of_the_densities_written_out() -> None:
    observation = _axis()
    readings = _read(observation, 1, 6, "drift")
    model = Evidence(observation, readings)
    covariance, values = model.covariance(np.zeros(0)), model.values
    below = multivariate_normal(cov=covariance).logpdf(values)
    every = list(departures(observation, readings))
    total = 0.0
    for each in every:
        share = PRIOR[each.family] / sum(other.family == each.family for other in every) / MODEL
        spread = each.columns @ each.columns.T
        for size, weight in zip(0.5e-6 * SIZES, _SIZE_WEIGHTS, strict=True):
            above = multivariate_normal(cov=covariance + size**2 * spread).logpdf(values)
            total += share * weight * float(np.exp(above - below))
    assert compared(observation, readings).evalue == pytest.approx(total, rel=1e-4)


def test_readings_of_the_model_itself_hardly_ever_contradict_it() -> None:
    observation = _axis()
    fired = sum(compared(observation, _read(observation, seed, 20)).contradicted for seed in range(60))
    assert fired <= 4  # one in twenty is promised, at whatever reading one looks


@pytest.mark.parametrize(
    ("attack", "names"), [("drift", {"drift", "levelling"}), ("pitch", {"pitch"}), ("bad", {"bad"})]
)
def test_what_was_put_in_is_what_is_found(attack: str, names: set[str]) -> None:
    observation = _axis()
    found = [compared(observation, _read(observation, seed, 24, attack)) for seed in range(12)]
    assert sum(each.contradicted for each in found) >= 10
    assert sum(each.explanations[0].family in names for each in found) >= 10


def test_a_period_in_no_list_is_found_by_the_scan() -> None:
    found = compared(_axis(), _with_period(0.05))
    assert found.explanations[0].family == "pitch"
    assert found.explanations[0].place == pytest.approx(0.05, rel=0.03)
    assert found.explanations[0].size == pytest.approx(5e-6, rel=0.3)


def _with_period(pitch: float) -> list[Reading]:
    plain = _read(_axis(), 3, 30)
    return [replace(r, value=r.value + 5e-6 * float(np.sin(2 * np.pi * r.pose[0] / pitch))) for r in plain]


def test_two_readings_explain_nothing() -> None:
    found = compared(_axis(), _read(_axis(), 1, 2))
    assert (found.explanations, found.evalue, found.contradicted) == ((), 1.0, False)
