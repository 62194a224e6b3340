"""What explains readings: against densities written out, false alarms, and departures that were put in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from axiscal.inference.contradiction import FITS, PRIOR, SIZES, SURE, compared, watched
from axiscal.inference.evidence import Evidence
from axiscal.measurement.departures import departures
from scipy.stats import multivariate_normal

from axiscal.measurement.reading import Reading
from benchmarks.trust.causes import attacked, axis

_SIZE_WEIGHTS = (0.26, 0.22, 0.18, 0.13, 0.10, 0.07, 0.04)


def test_the_evidence_is_the_average_of_the_densities_written_out() -> None:
    observation = axis()
    readings = attacked(observation, 1, 6, "drift")
    model = Evidence(observation, readings)
    covariance, values = model.covariance(np.zeros(0)), model.values
    below = multivariate_normal(cov=covariance).logpdf(values)
    every = list(departures(observation, readings))
    whole, total = sum(PRIOR[family] for family in {each.family for each in every}), 0.0
    for each in every:
        share = PRIOR[each.family] / sum(other.family == each.family for other in every) / whole
        spread = each.columns @ each.columns.T
        for size, weight in zip(0.5e-6 * SIZES, _SIZE_WEIGHTS, strict=True):
            above = multivariate_normal(cov=covariance + size**2 * spread).logpdf(values)
            total += share * weight * float(np.exp(above - below))
    assert compared(observation, readings).evalue == pytest.approx(total, rel=1e-4)


@pytest.mark.long
def test_readings_of_the_model_itself_hardly_ever_contradict_it() -> None:
    observation = axis()
    found = [compared(observation, attacked(observation, seed, 20)) for seed in range(80, 160)]
    assert sum(each.highest >= SURE for each in found) <= 4  # one in twenty is promised, at whatever reading one looks
    assert sum(each.contrast.fires for each in found) <= 8  # one in twenty (23 of 400); more than 8 come once in 50
    assert sum(each.fits < FITS for each in found) == 0


def test_what_is_watched_while_measuring_is_what_the_verdict_takes_into_account() -> None:
    observation = axis()
    readings = attacked(observation, 3, 20, "drift")
    whole = compared(observation, readings)
    along = [watched(observation, readings[:count]) for count in range(21)]
    assert (along[-1].evalue, along[-1].highest) == (whole.evalue, whole.highest)
    assert along[-1].explanations == whole.explanations
    assert along[2] == watched(observation, ())
    assert along[2].evalue == 1.0


@pytest.mark.long
@pytest.mark.parametrize(
    ("attack", "names", "named"),
    [("drift", {"drift", "levelling"}, 10), ("jump", {"jump"}, 10), ("pitch 50", {"pitch"}, 10), ("bad", {"bad"}, 7)],
)
def test_what_was_put_in_is_what_is_found(attack: str, names: set[str], named: int) -> None:
    """A bad reading is named less often, in 36 of 48 machines: fewer than 7 of 12 come once in 18."""
    observation = axis()
    found = [compared(observation, attacked(observation, seed, 24, attack)) for seed in range(12)]
    assert sum(each.contradicted for each in found) >= 10
    assert sum(each.explanations[0].family in names for each in found) >= named


def test_a_period_in_no_list_is_found_by_the_scan() -> None:
    found = compared(axis(), _with_period(0.05))
    assert found.explanations[0].family == "pitch"
    assert found.explanations[0].place == pytest.approx(0.05, rel=0.03)
    assert found.explanations[0].size == pytest.approx(5e-6, rel=0.3)


def _with_period(pitch: float) -> list[Reading]:
    plain = attacked(axis(), 3, 30)
    return [replace(r, value=r.value + 5e-6 * float(np.sin(2 * np.pi * r.pose[0] / pitch))) for r in plain]


def test_two_readings_explain_nothing() -> None:
    found = compared(axis(), attacked(axis(), 1, 2))
    assert (found.explanations, found.evalue, found.contradicted) == ((), 1.0, False)
