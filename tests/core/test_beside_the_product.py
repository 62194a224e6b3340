"""The judge: the plain core beside the product's fast forms, on cases made from golden campaigns.

The core's instruments are those that a stranger wrote. Both pose their readings by themselves; the likelihood of sizes
they have in common, and `tests.generators.dense_posterior` judges that.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.estimation.estimate import estimated
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal_core.numbers import Numbers
from axiscal_core.posing import posed
from axiscal_core.problem import Problem
from axiscal_core.unknowns import Unknowns
from tests.core.beside import READ, Beside, described
from tests.generators.dense_posterior import Dense

ROWS, POSTERIOR, PLAN = 1e-12, 1e-8, 1.002
DESCRIBED = ["mill", "one_spline", *READ]
WITH_PLANES = ["plane_map", "printer"]


@cache
def _beside(name: str) -> Beside:
    return Beside(described(name))


def _readings(name: str) -> list[Reading]:
    """Return the readings of a campaign; readings of zero at random places where none are kept."""
    beside = _beside(name)
    if name in READ:
        return beside.readings(f"{name}/{READ[name]}")
    return [reading for i, setup in enumerate(beside.description.setups) for reading in beside.drawn(12, setup, i)]


def _thetas(name: str) -> list[Array]:
    """Return the sizes as stated and others, each (k,), of the core."""
    count = len(_beside(name).product.sizes)
    return [np.zeros(count), np.random.default_rng(1).normal(size=count) * 0.4]


@pytest.mark.parametrize("name", [*DESCRIBED, *WITH_PLANES])
def test_rows_are_those_of_the_product(name: str) -> None:
    """Of every instrument that a stranger wrote: interferometer, dial, autocollimator, ball bar, tracer, tracker."""
    beside = _beside(name)
    size = beside.core.machine.size
    for index, setup in enumerate(beside.description.setups):
        places = beside.places(beside.drawn(20, setup))
        found = beside.product.observation.rows_each(index, places.poses, places.sides)
        theirs = np.stack([rows for rows, _ in found], axis=1)
        mine = beside.core.numbers(places).rows.reshape(*theirs.shape[:2], -1)
        assert np.abs(theirs[:, :, :size] - mine[:, :, :size]).max() < ROWS
        own = beside.product.observation.unknowns_of(index)
        assert np.abs(theirs[:, :, own] - mine[:, :, beside.core.own[index]]).max(initial=0.0) < ROWS


@pytest.mark.parametrize("name", WITH_PLANES)
def test_what_two_axes_do_together_is_the_same(name: str) -> None:
    """Its coefficients are others, in which the product leaves out what both curves say; its kernel is one."""
    beside = _beside(name)
    places = beside.places(beside.drawn(20, beside.description.setups[0]))
    theirs = beside.product.observation.rows_each(0, places.poses, places.sides)[0][0]
    mine = beside.core.numbers(places).rows
    before = beside.product.observation.prior_covariance()
    kernels = theirs @ before @ theirs.T, mine @ beside.core.prior.covariance @ mine.T
    assert np.abs(kernels[0] - kernels[1]).max() < ROWS * np.abs(kernels[0]).max()


@pytest.mark.parametrize("name", DESCRIBED)
def test_covariances_of_readings_are_those_of_the_product(name: str) -> None:
    """At sizes as stated and at others. A zero of 1 mm hides all else: the rest is compared alone as well."""
    beside, readings = _beside(name), _readings(name)
    both = beside.space(readings).problem, posed(beside.core, beside.own(readings))
    for theta in _thetas(name):
        for theirs, own in (tuple(map(_without_unknowns, both)), both):
            at, mine = beside.theta(theta), Dense(own).covariance(theta) * np.outer(own.noise, own.noise)
            found = Numbers(theirs).covariance(at, [curves.roots(at) for curves in theirs.curves])
            scale = np.sqrt(np.diag(mine))
            assert np.abs((found * np.outer(theirs.noise, theirs.noise) - mine) / np.outer(scale, scale)).max() < ROWS


def _without_unknowns(problem: Problem) -> Problem:
    rows = problem.rows.copy()
    rows[:, rows.shape[1] - problem.unknowns :] = 0.0
    return replace(problem, rows=rows)


@pytest.mark.parametrize("name", DESCRIBED)
def test_posteriors_are_those_of_the_product(name: str) -> None:
    """Mean and covariance at given sizes, in standard deviations, without and with causes of type B."""
    beside, readings = _beside(name), _readings(name)
    theirs, own = beside.space(readings).problem, posed(beside.core, beside.own(readings))
    own = replace(own, type_b=theirs.type_b, causes=theirs.causes, judging=theirs.judging)  # a stranger's have none
    if name == "nonlinear":  # of a station that is millimetres off, rounding alone is a millionth of a deviation
        theirs, own = (replace(each, values=each.values / 1000) for each in (theirs, own))
    for theta in _thetas(name):
        found, given = Unknowns(theirs).given(beside.theta(theta)), Unknowns(own).given(theta)
        assert found is not None
        assert given is not None
        pairs = (found.without_causes(), given.without_causes()), (found.posterior(), given.posterior())
        for one, other in pairs:
            scale = np.sqrt(np.diag(one.covariance))
            assert np.abs((other.mean - one.mean) / scale).max() < POSTERIOR
            assert np.abs((other.covariance - one.covariance) / np.outer(scale, scale)).max() < POSTERIOR


@pytest.mark.parametrize("name", ["learnt", "outlier", "rotary", "vcomp"])
def test_estimates_are_those_of_the_product(name: str) -> None:
    """Sizes averaged over, slips taken out: covariances and slips are found by each in its way."""
    beside, readings = _beside(name), _readings(name)
    known, found = beside.core.estimate(beside.own(readings)), estimated(beside.product, readings).posterior
    assert found is not None
    size = beside.core.machine.size
    gram = beside.core.volume.root[:, :size].T @ beside.core.volume.root[:, :size]
    both = found.covariance - found.shared, known.covariance
    theirs, mine = (np.sqrt(np.sum(gram * covariance[:size, :size])) for covariance in both)
    apart = (known.mean - found.mean)[:size]
    assert mine == pytest.approx(theirs, rel=1e-6)
    assert np.sqrt(apart @ gram @ apart) < 1e-6 * theirs
    assert set(known.bad) == set(found.bad)
