"""The judge: the plain core beside the product's fast forms, on cases made from golden campaigns.

The core's instruments are those that a stranger wrote. Both pose their readings by themselves; the likelihood of sizes
they have in common, and `tests.generators.dense_posterior` judges that.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.measurement.reading import Places, Reading
from axiscal.numerics import Array
from axiscal_core.numbers import Numbers
from axiscal_core.posing import posed
from axiscal_core.problem import Problem
from tests.core.beside import READ, Beside, described
from tests.generators.dense_posterior import Dense

ROWS = 1e-12
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


@pytest.mark.parametrize("name", WITH_PLANES)
def test_what_two_axes_do_together_is_the_same(name: str) -> None:
    """Its coefficients are others, in which the product leaves out what both curves say; its kernel is one."""
    beside = _beside(name)
    places = beside.places(beside.drawn(20, beside.description.setups[0]))
    theirs = beside.product.observation.numbers(Places.of_setup(0, places.poses, places.sides)).rows
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
