"""Noise that was only stated, against a machine of which all of it is: the same to every reading, and not the truth."""

from __future__ import annotations

import numpy as np
import pytest
from axiscal.accuracy.damage import KAPPA
from axiscal.estimation.defence import Defence, defence
from axiscal.inference.fit import drawn

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation import defence as defence_module
from axiscal.estimation.case import Case
from axiscal.inference.reading_set import ReadingSet
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

MACHINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1 m"]
[errors]
EXX = {{ std = "10 um", length = "400 mm", rest = {rest} }}
"""
TEXT = """
machine = "m"
scales = "{scales}"
[target]
readings = 40
[[setups]]
name = "gauge"
instrument = "interferometer"
direction = "x"
approach = "+"
noise = "{noise}"
unknowns = {{}}
drift = "0 um/h"
"""
NOISE = 3e-6


def axis(rest: str = '"estimate"', scales: str = "stated", noise: str = "3 um") -> Case:
    """Return an axis whose rest is to be learnt."""
    text = TEXT.format(scales=scales, noise=noise)
    return Case(campaign_from_texts(text, "c.toml", MACHINE.format(rest=rest), "m"))


def read(*again: float, count: int = 40) -> list[Reading]:
    """Return readings at so many places that are all different, and at some once more."""
    places = [*((np.arange(count) + np.random.default_rng(4).uniform(0.2, 0.8, count)) / count).tolist(), *again]
    return [Reading("gauge", (x,), (1,), 0.0, time=60.0 * i) for i, x in enumerate(places)]


def vouched(case: Case, taken: list[Reading]) -> Defence:
    """Return what readings can vouch for, of the promise that the case makes of them."""
    promise = case.yardstick.measure(case.knowledge.read(taken).belief).rms
    return defence(case, taken, promise, case.description.machine)


def test_noise_that_might_be_the_machine_is_not_taken_for_noise() -> None:
    case, taken = axis(), read()
    found = vouched(case, taken)
    assert found.scatter is not None
    assert found.scatter.effect == pytest.approx(NOISE, rel=1e-9)
    assert found.scatter.bearable == pytest.approx(NOISE / np.sqrt(KAPPA**2 - 1), rel=1e-9)
    assert found.rests
    assert found.unchecked
    assert found.u_def >= found.scatter.bearable > found.promise


def covariance(case: Case, taken: list[Reading]) -> Array:
    """Return that of the numbers."""
    numbers = ReadingSet(case.observation, taken)
    features = numbers.features(case.errors.prior_root())
    whole: Array = features @ features.T + np.diag(numbers.noise)
    return whole


def test_readings_are_the_same_and_the_truth_is_not() -> None:
    taken, case, rough = read(), axis('"0.001 um"'), axis('"3 um"', noise="0.001 um")
    inverse = np.linalg.inv(covariance(case, taken))
    np.testing.assert_allclose(covariance(case, taken), covariance(rough, taken), rtol=1e-6)
    rng, root = np.random.default_rng(0), case.errors.prior_root()
    places, seen = (
        case.observation.rows(0, at, np.ones_like(at)).rows
        for at in (np.linspace(0.0005, 0.9995, 200)[:, None], np.array([reading.pose for reading in taken]))
    )
    drawn = root @ rng.standard_normal((root.shape[1], 4000))
    values = seen @ drawn + NOISE * rng.standard_normal((len(taken), 4000))  # of the machine, from place to place
    missed = places @ (drawn - root @ root.T @ seen.T @ inverse @ values)
    missed += NOISE * rng.standard_normal(missed.shape)
    promise = case.yardstick.measure(case.knowledge.read(taken).belief).rms
    assert np.sqrt(np.mean(missed**2)) == pytest.approx(np.hypot(promise, NOISE), rel=0.02)
    assert np.sqrt(np.mean(missed**2)) > KAPPA * promise


def test_places_that_were_read_once_more_tell() -> None:
    first = [reading.pose[0] for reading in read()[:3]]
    lacking = vouched(axis(), read(*first[:2])).scatter
    assert lacking is not None
    assert lacking.lacking == 1
    assert vouched(axis(), read(*first)).scatter is None


def test_of_very_many_readings_those_count_too_that_are_not_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the ten that are drawn here no two are of one place."""
    taken = read(*[reading.pose[0] for reading in read()[:3]])
    monkeypatch.setattr(defence_module, "_MOST", 10)
    assert len({reading.place for reading in drawn(taken, 10)}) == 10
    assert vouched(axis(), taken).scatter is None
    assert vouched(axis(), taken[:-1]).scatter is not None


def test_where_the_rest_is_stated_nothing_is_learnt_beside_the_noise() -> None:
    assert vouched(axis('"1 um"'), read()).scatter is None
    assert vouched(axis('"1 um"', scales="estimate"), read()).scatter is not None


def test_a_noise_that_is_small_beside_the_promise_is_borne() -> None:
    found = vouched(axis(noise="0.1 um"), read(count=6))
    assert found.scatter is not None
    assert not found.rests
