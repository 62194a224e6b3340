"""The next position along a line and in a plane against its certificate, and the certifier's own check."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy.criterion import Root
from axiscal.estimation.knowledge import Knowledge
from axiscal.machine import Machine, machine_from_text
from axiscal.measurement.candidates import spread
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.gains.gain import Scorer
from axiscal.planning.step.best_step import best_step, certified_gain
from tests.certify.one_joint import SLACK, GainPolynomials, Problem, certified_best_gain
from tests.certify.one_joint_cases import best_position, judged, random_problem
from tests.generators.planes import bed, poses_of, probe, table, warped

CASES = 150
LIMIT = 1e-9


def problem(seed: int) -> Problem:
    """Return the random joint of this seed."""
    return random_problem(np.random.default_rng(seed))


@pytest.mark.long
def test_the_step_reaches_the_certified_gain(record_property: Callable[[str, object], None]) -> None:
    verdicts = [judged(problem(seed)) for seed in range(20_000, 20_000 + CASES)]
    record_property("certified one-joint cases", len(verdicts))
    assert max(v.deficit for v in verdicts) < LIMIT
    assert max(v.misstated for v in verdicts) < LIMIT
    assert len(verdicts) == CASES


@pytest.mark.parametrize("seed", range(8))
def test_the_certifier_needs_no_hint(seed: int) -> None:
    """From nothing it encloses the same best gain, and its own position reaches it."""
    polynomials = GainPolynomials(problem(seed))
    hinted = certified_best_gain(polynomials, best_position(problem(seed))[0])
    alone = certified_best_gain(polynomials)
    assert hinted.lower <= alone.lower * (1 + SLACK)
    assert alone.lower <= hinted.lower * (1 + SLACK)
    assert polynomials.gain(*alone.position).overlaps(alone.lower)


@pytest.mark.parametrize("seed", range(8))
def test_the_certifier_notices_a_poorer_position(seed: int) -> None:
    case = problem(seed)
    polynomials, (position, _) = GainPolynomials(case), best_position(case)
    middle = (case.knots[0] + case.knots[-1]) / 2
    poorer = position + 0.01 * (middle - position)
    best = certified_best_gain(polynomials, poorer)
    assert polynomials.gain_at(poorer) < best.lower * (1 - LIMIT)


def test_the_certifier_computes_the_gain_that_dense_algebra_gives() -> None:
    rng = np.random.default_rng(5)
    case = Problem(np.array([0.0, 1.0, 2.5, 3.0]), False, rng.normal(size=(4, 4)), np.eye(4), 0.5)
    for problem_ in (case, dataclasses.replace(case, cyclic=True, factor=np.eye(3), root=np.eye(3))):
        polynomials = GainPolynomials(problem_)
        covariance = problem_.factor @ problem_.factor.T
        for knot, row in zip(problem_.knots, np.eye(len(covariance)), strict=False):
            gain = row @ covariance @ covariance @ row / (0.5 + row @ covariance @ row)
            assert float(polynomials.gain_at(float(knot))) == pytest.approx(gain, rel=1e-12)


def _known(machine: Machine, count: int, moves: tuple[int, int] = (0, 1)) -> tuple[Knowledge, Scorer]:
    observation = Observation(ErrorModel(machine), (replace(probe(machine), moves=moves),))
    places = poses_of(machine, count, 4)
    readings = [Reading("probe", tuple(pose), (1,) * places.shape[1], 0.0) for pose in places]
    known = Knowledge.before(observation).read(readings)
    root = Root.of_gram(volume_moments(known.observation.errors, whole_travel(known.observation.errors)).gram)
    return known, Covariance.from_factor(known.observation, known.belief.factor, root).scorer()


@pytest.mark.parametrize("count", [0, 3, 9])
def test_the_step_reaches_what_is_certified(count: int) -> None:
    machine = machine_from_text(warped((7, 6)))
    known, scorer = _known(machine, count)
    root = Root.of_gram(volume_moments(known.observation.errors, whole_travel(known.observation.errors)).gram)
    step = best_step(known, root, spread(machine, known.observation.setups, 400))
    certified = certified_gain(scorer, 0, step.gain)
    assert certified.upper <= step.gain * (1 + 2e-6)
    tried = poses_of(machine, 30_000, 8)
    assert scorer.gains_at(0, tried, np.ones_like(tried)).max() <= certified.upper


def test_with_lever_arms_the_degree_grows_and_the_certificate_holds() -> None:
    """X and Z of a bed whose Y and Z turn it together: two more degrees in each coordinate."""
    machine = bed()
    _, scorer = _known(machine, 4, (1, 2))
    certified = certified_gain(scorer, 0)
    tried = poses_of(machine, 30_000, 8)
    tried[:, 0] = certified.pose[0]
    best = scorer.gains_at(0, tried, np.ones_like(tried)).max()
    assert best <= certified.upper
    assert certified.upper <= certified.lower * (1 + 2e-6)


def test_along_an_axis_that_turns_the_certificate_holds() -> None:
    machine = table()
    _, scorer = _known(machine, 1, (0, 1))
    certified = certified_gain(scorer, 0)
    tried = poses_of(machine, 30_000, 8)
    tried[:, 2:] = certified.pose[2:]
    best = scorer.gains_at(0, tried, np.ones_like(tried)).max()
    assert certified.lower * (1 - 1e-3) <= best <= certified.upper
    assert certified.upper <= certified.lower * (1 + 2e-6)
