"""Readings within bounds, against weighted draws; readings with chips, against every way chips may have fallen."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy.stats import norm

from axiscal.errors.prior import matern52
from axiscal.estimation.inference.odd_readings import Fitted, Sites, sited, sites
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.gaussian import lower_root
from tests.generators.one_axis import observed

_CURVE = 10.0
_AT = np.array([0.0, 0.15, 0.3, 0.5, 0.5, 0.75, 0.9, 0.9])
_DRAWS = 200_000


def _root() -> Array:
    return _CURVE * lower_root(matern52(np.abs(_AT[:, None] - _AT) / 0.2) + 1e-9 * np.eye(len(_AT)))


def _by_sites(root: Array, found: Sites) -> tuple[Array, Array]:
    covariance = np.linalg.inv(np.eye(root.shape[1]) + (root.T / found.variances) @ root)
    mean = root @ covariance @ (root.T @ (found.values / found.variances))
    return mean, np.sqrt(np.diag(root @ covariance @ root.T))


@pytest.mark.parametrize("bound", [3.0, 6.0, 12.0])
def test_bounded_readings_leave_what_many_weighted_draws_leave(bound: float) -> None:
    rng, root = np.random.default_rng(5), _root()
    truth = root @ rng.standard_normal(len(_AT))
    shown = truth + rng.standard_normal(len(_AT)) + bound * rng.uniform(-1, 1, len(_AT))
    noise, steps = np.full(len(_AT), 1 + bound**2 / 3), np.full(len(_AT), 2 * bound)
    mean, std = _by_sites(root, sites(Fitted(root, noise, shown, np.arange(len(_AT))), steps, np.ones(len(_AT))))
    loose = np.linalg.inv(np.eye(len(_AT)) + (root.T / (2 * noise)) @ root)  # draws come from a wider normal
    white = rng.standard_normal((_DRAWS, len(_AT)))
    drawn = loose @ root.T @ (shown / (2 * noise)) + white @ lower_root(loose).T
    draws = drawn @ root.T
    inside = norm.cdf(shown + bound - draws) - norm.cdf(shown - bound - draws)
    weights = np.exp(0.5 * np.sum(white**2 - drawn**2, axis=1)) * np.prod(inside, axis=1)
    weights /= weights.sum()
    assert 1 / np.sum(weights**2) > 500
    exact = weights @ draws
    spread = np.sqrt(weights @ (draws - exact) ** 2)
    assert np.max(np.abs(mean - exact) / spread) < 0.15
    assert std == pytest.approx(spread, rel=0.15)  # where two intervals meet the density is not normal: 12 %


@pytest.mark.long
def test_chips_leave_what_every_way_they_may_have_fallen_leaves() -> None:
    """Where nothing decides which reading is right the exact density has two humps; the band is narrower there."""
    off, widths = zip(*(_with_one_chip(seed) for seed in range(40)), strict=True)
    assert np.max(off) < 1e-6
    assert np.median(widths) == pytest.approx(1.0, abs=1e-4)
    assert np.min(widths) > 0.55


@pytest.mark.parametrize("rank", [1, 2, 4])
def test_chips_on_readings_that_all_see_the_same_few_unknowns(rank: int) -> None:
    """As eight repeats at one place do: sites that are changed all at once overshoot there, ever further."""
    for seed in range(8):
        rng, chip = np.random.default_rng(seed), (5.0, 20.0)[seed % 2]
        root = _CURVE * rng.standard_normal((len(_AT), rank))
        fallen = (rng.random(len(_AT)) < 0.2) * chip * (1 + rng.standard_normal(len(_AT)))
        shown = root @ rng.standard_normal(rank) + rng.standard_normal(len(_AT)) + fallen
        mean, std = _with_chips(root, shown, chip)
        exact, spread = _every_way(root, shown, chip)
        assert np.max(np.abs(mean - exact) / spread) < 1e-6
        assert 0.9 < np.min(std / spread) <= np.max(std / spread) < 1.01


def test_two_chips_among_many_readings_are_found_as_if_they_were_known() -> None:
    """Of twenty campaigns of 24 readings eighteen end where one ends who knows which ones chips shifted."""
    off = []
    for seed in range(20):
        rng, chip, fallen = np.random.default_rng(seed), 20.0, np.zeros(24)
        root = _CURVE * rng.standard_normal((24, 4))
        truth = root @ rng.standard_normal(4)
        fallen[rng.choice(24, 2, replace=False)] = 1
        shown = truth + rng.standard_normal(24) + fallen * chip * (1 + rng.standard_normal(24))
        mean, _ = _with_chips(root, shown, chip)
        known, spread = _by_sites(root, Sites(shown - fallen * chip, 1 + fallen * chip**2))
        off.append(float(np.max(np.abs(mean - known)) / np.max(spread)))
    assert np.sum(np.array(off) < 1) >= 18


def _with_chips(root: Array, shown: Array, chip: float) -> tuple[Array, Array]:
    count = len(shown)
    fitted = Fitted(root, np.ones(count), shown, np.arange(count))
    return _by_sites(root, sites(fitted, np.zeros(count), np.ones(count), np.full(count, chip)))


def _with_one_chip(seed: int) -> tuple[float, float]:
    """Return the largest difference of the means in exact standard deviations, and the smallest ratio of these."""
    rng, root, chip = np.random.default_rng(seed), _root(), 20.0
    shown = root @ rng.standard_normal(len(_AT)) + rng.standard_normal(len(_AT))
    shown[rng.choice([0, 2, 4, 7])] += chip * 1.3
    mean, std = _with_chips(root, shown, chip)
    exact, spread = _every_way(root, shown, chip)
    return float(np.max(np.abs(mean - exact) / spread)), float(np.min(std / spread))


def _every_way(root: Array, shown: Array, chip: float) -> tuple[Array, Array]:
    """Return mean and standard deviation of the exact posterior, a mixture of 2⁸ normal ones."""
    prior, logs, means, variances = root @ root.T, [], [], []
    for hit in product((0.0, 1.0), repeat=len(shown)):
        fallen = np.array(hit)
        noise, off = 1 + fallen * chip**2, shown - fallen * chip
        whole = prior + np.diag(noise)
        gain = prior @ np.linalg.inv(whole)
        odds = fallen.sum() * np.log(0.02) + (1 - fallen).sum() * np.log(0.98)
        logs.append(odds - 0.5 * off @ np.linalg.solve(whole, off) - 0.5 * np.linalg.slogdet(whole)[1])
        means.append(gain @ off)
        variances.append(np.diag(prior - gain @ prior))
    share = np.exp(np.array(logs) - max(logs))
    share /= share.sum()
    mean = share @ np.array(means)
    return mean, np.sqrt(share @ (np.array(variances) + (np.array(means) - mean) ** 2))


def test_only_readings_that_are_odd_are_changed() -> None:
    observation = observed('one_sided = "+"\nnoise = "1 um"\nunknowns = {}')
    readings = [Reading("it", (x,), (1,), v) for x, v in ((0.1, 0.0), (0.12, 30e-6), (0.14, 0.0), (0.16, 0.0))]
    changed = sited(observation, [*readings, Reading("it", (0.4,), (1,), 20e-6, std=1e-6)])
    assert changed[-1].value == 20e-6
    chip, others = changed[1].std, [changed[i].std for i in (0, 2, 3)]
    assert chip is not None
    assert chip > 15e-6
    assert others == pytest.approx([1e-6] * 3, rel=0.05)
