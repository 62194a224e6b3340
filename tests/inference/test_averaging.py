"""The mixture over scales and departures against every term written out, and against what was put in."""

from __future__ import annotations

import numpy as np
import pytest
from axiscal.inference.averaging import Term, average, prior_sizes
from axiscal.inference.contradiction import MODEL, PRIOR, SIZES
from axiscal.inference.evidence import Evidence
from axiscal.inference.scales import Scale
from axiscal.inference.terms import evidence_of
from axiscal.measurement.departures import Departure, departures, followed
from scipy.stats import multivariate_normal

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from benchmarks.trust.causes import attacked, axis


def _few(every: list[Departure]) -> list[Departure]:
    """Return some departures of each family."""
    return [each for index, each in enumerate(every) if each.family != "step" and index % 9 == 0][:12]


def _columns(each: Departure, evidence: Evidence) -> tuple[Array, Array]:
    """Return b, and a over all errors and unknowns."""
    field, spread = (
        followed(each, evidence.functions, evidence.axes),
        np.zeros((evidence.rows.shape[1], each.columns.shape[1])),
    )
    if field.columns is not None and field.coefficients is not None:
        spread[field.columns] = field.coefficients
    return each.columns, spread


def test_mean_and_covariance_are_those_of_all_terms_written_out() -> None:
    observation = axis()
    readings = attacked(observation, 2, 10, "drift")
    evidence = Evidence(observation, readings, (Scale("noise", "it", 0.5e-6), Scale("std", "EXX", 10e-6)))
    possible = _few(list(departures(observation, readings)))
    nothing = Term(np.log([50.0, 1e-2]), 0.0, 0.0)
    terms = [Term(np.zeros(2), 0.0, 0.0), nothing, Term(np.log([2.0, 3.0]), -0.5, -1.0)]
    terms = [
        t._replace(
            model=t.model + evidence.log_likelihood(t.logs), departed=t.departed + evidence.log_likelihood(t.logs)
        )
        for t in terms
    ]
    found = average(evidence, possible, terms)

    unit, weights, means, covariances = float(np.sqrt(np.median(evidence.noise))), [], [], []
    counts = {each.family: sum(other.family == each.family for other in possible) for each in possible}
    for term in terms:
        prior, own = evidence.prior(term.logs), evidence.log_likelihood(term.logs)
        noise = evidence.covariance(term.logs) - evidence.rows @ prior @ evidence.rows.T
        alone = _posterior(prior, evidence.rows, noise, evidence.values)
        weights.append(term.model)
        means.append(alone[0])
        covariances.append(alone[1])
        of_size = prior_sizes(evidence, possible, unit)
        for index, each in enumerate(possible):
            column, spread = _columns(each, evidence)
            for size, share in zip(unit * SIZES, of_size[:, index], strict=True):
                both = np.block(
                    [
                        [prior, np.zeros((len(prior), column.shape[1]))],
                        [np.zeros((column.shape[1], len(prior))), size**2 * np.eye(column.shape[1])],
                    ]
                )
                mean, covariance = _posterior(both, np.hstack([evidence.rows, column]), noise, evidence.values)
                whole = np.hstack([np.eye(len(prior)), spread])
                likely = multivariate_normal(cov=evidence.covariance(term.logs) + size**2 * column @ column.T).logpdf(
                    evidence.values
                )
                prior_share = np.log(PRIOR[each.family] / MODEL / counts[each.family] * share)
                weights.append(term.departed - own + prior_share + float(likely))
                means.append(whole @ mean)
                covariances.append(whole @ covariance @ whole.T)
    shares = np.exp(np.array(weights) - max(weights))
    shares /= shares.sum()
    centre = np.einsum("l,lk->k", shares, np.array(means))
    moved = np.array(means) - means[0]
    about = np.einsum("l,lkn->kn", shares, np.array(covariances)) + np.einsum("l,lk,ln->kn", shares, moved, moved)
    scale = np.sqrt(np.diag(about))
    assert found.moved / scale == pytest.approx((centre - means[0]) / scale, abs=2e-3)
    added = (about - covariances[0]) / scale[:, None] / scale
    kept = (found.about_model @ found.about_model.T) / scale[:, None] / scale
    values, vectors = np.linalg.eigh(added)
    assert kept == pytest.approx((vectors * np.maximum(values, 0)) @ vectors.T, abs=3e-3)


def _posterior(prior: Array, rows: Array, noise: Array, values: Array) -> tuple[Array, Array]:
    gain = prior @ rows.T @ np.linalg.inv(rows @ prior @ rows.T + noise)
    return gain @ values, prior - gain @ rows @ prior


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_drift_that_was_put_in_is_taken_off_the_curve(seed: int) -> None:
    """The mixture moves the curve to where it would be without drift, to 0.3 of what that did: 0.06 to 0.27 in ten."""
    observation = axis()
    plain, drifted = (attacked(observation, seed, 24, attack) for attack in ("none", "drift"))
    bent = _curve(observation, drifted)[0] - _curve(observation, plain)[0]
    mean, moved = _curve(observation, drifted)
    left = mean + moved - _curve(observation, plain)[0]
    assert np.linalg.norm(left - left.mean()) < 0.3 * np.linalg.norm(bent - bent.mean())


def _curve(observation: Observation, readings: list[Reading]) -> tuple[Array, Array]:
    """Return the model's control values of EXX, and by how much the mixture moves them."""
    evidence, terms = evidence_of(observation, readings, None, None)
    found = average(evidence, list(departures(observation, readings)), terms)
    prior = evidence.prior(terms[0].logs)
    noise = evidence.covariance(terms[0].logs) - evidence.rows @ prior @ evidence.rows.T
    mean = _posterior(prior, evidence.rows, noise, evidence.values)[0]
    columns = observation.errors.names["EXX"].columns
    return mean[columns], found.moved[columns]


def test_readings_of_the_model_hardly_move_it() -> None:
    observation = axis()
    readings = attacked(observation, 5, 24)
    evidence, terms = evidence_of(observation, readings, None, None)
    found = average(evidence, list(departures(observation, readings)), terms)
    assert found.model > 0.5
    assert sum(found.rests.values()) < (1e-6) ** 2
